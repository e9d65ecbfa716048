// @ts-check
/** What a log says of the arm: each number with its interval, what is left of the torque, one edit. */

import {identifyLog} from '../api/requests/logs.js';
import {JOINTS} from '../api/arm.js';
import {ask, showDialog} from '../dom/dialog.js';
import {element} from '../dom/element.js';
import {inDigits} from '../figures/columns.js';
import {tellWithUndo} from '../dom/undo_notice.js';
import {withScrollCue} from '../dom/scroll_cue.js';
import {residualFigure} from './residual_figure.js';
import {useButton} from './use_button.js';
import {listOf, waitFor} from './waiting.js';

/** @typedef {import('../api/requests/logs.js').Log} Log */
/** @typedef {import('../api/requests/logs.js').Estimate} Estimate */

const DIGITS = 3;
const HEADS = ['', 'now', 'fitted', '95 % interval', 'unit'];

/**
 * @param {import('../api/undo.js').History} history
 * @param {import('../dom/notices.js').Tell} tell
 * @param {Log} log
 */
export function showIdentification(history, tell, log) {
  if (log.holds.includes('torques')) {
    fit(history, tell, log, null);
    return;
  }
  const questions = [{
    name: 'constants', label: 'Torque at the joint per ampere, gear included, in N·m/A', required: true,
    hint: `One number for all joints, or ${JOINTS.length} with blanks between them.`,
  }];
  ask('The log has currents', questions, 'Fit', async ({constants: text}) => {
    const constants = text.trim().split(/[\s;]+/).map((word) => Number(word.replace(',', '.')));
    if (![1, JOINTS.length].includes(constants.length) || constants.some((value) => !Number.isFinite(value) || !value)) {
      throw new Error(`One number or ${JOINTS.length}, none of them 0, got ${text}.`);
    }
    queueMicrotask(() => { fit(history, tell, log, constants); });
  });
}

/**
 * @param {import('../api/undo.js').History} history
 * @param {import('../dom/notices.js').Tell} tell
 * @param {Log} log
 * @param {number[]|null} constants
 */
async function fit(history, tell, {number, name}, constants) {
  let found;
  try {
    found = await waitFor('Fitting', `${name}: friction, payload, rotor inertia and constant torques, joint by joint.`,
      () => identifyLog(number, constants));
  } catch (error) {
    tell(`${name} tells nothing of the arm: ${/** @type {Error} */ (error).message}`, {error: true});
  }
  if (!found) return;
  const alert = element('p', {class: 'dialog-alert', role: 'alert'});
  const {patch} = found;
  const use = useButton('Use these', alert, async () => {
    await history.change(patch, `friction and payload from ${name}`);
    dialog.close();
    tellWithUndo(tell, history, `The arm has the friction, payload, rotor inertia and constant torques of ${name} now.`);
  });
  use.disabled = !Object.keys(patch).length;
  const figure = residualFigure(found);
  const dialog = showDialog(`What ${name} says of the arm`, element('div', {class: 'dialog-text own-data'},
    withScrollCue(element('div', {
      class: 'own-data-estimates', tabindex: 0, role: 'region', 'aria-label': 'Fitted values',
    }, table(found.estimates))),
    listOf(found.remarks, 'To know'),
    element('p', {class: 'own-data-legend'},
      `Torque below ${inDigits(found.bandwidth, DIGITS)} Hz: `,
      element('span', {class: 'own-data-measured', 'aria-hidden': 'true'}), 'measured, ',
      element('span', {class: 'own-data-left', 'aria-hidden': 'true'}), 'what the fit leaves'),
    figure.element, alert,
    element('div', {class: 'dialog-buttons'}, use)));
  dialog.classList.add('is-wide');
  // At its top: the button is below what it is about.
  dialog.querySelector('button')?.focus();
}

/** @param {Estimate[]} estimates */
function table(estimates) {
  return element('table', {class: 'own-data-table'},
    element('thead', {}, element('tr', {}, ...HEADS.map((text) => element('th', {scope: 'col'}, text)))),
    element('tbody', {}, ...estimates.flatMap(rows)));
}

/** @param {Estimate} estimate */
function rows({path, title, unit, present, value, low, high, told, reason}) {
  const number = (/** @type {string} */ text) => element('td', {class: 'own-data-number'}, text);
  const between = low === null || high === null ? '–' : `${inDigits(low, DIGITS)} to ${inDigits(high, DIGITS)}`;
  const row = element('tr', {'data-told': told, 'data-path': path}, element('th', {scope: 'row'}, title),
    number(inDigits(present, DIGITS)), number(inDigits(value, DIGITS)), number(between),
    element('td', {}, unit));
  if (!reason) return [row];
  row.classList.add('is-explained');
  return [row, element('tr', {class: 'own-data-reason'}, element('td', {colspan: HEADS.length}, reason))];
}
