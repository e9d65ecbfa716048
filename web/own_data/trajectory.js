// @ts-check
/** A log as the desired motion: how close the spline comes, what exceeds limits, one edit. */

import {logTrajectory} from '../api/requests/logs.js';
import {JOINT_NAMES, unitAt} from '../api/arm.js';
import {figureNumber} from '../figures/columns.js';
import {figureOf} from '../figures/figure.js';
import {element} from '../dom/element.js';
import {showDialog} from '../dom/dialog.js';
import {tellWithUndo} from '../dom/undo_notice.js';
import {written} from '../fields/quantity.js';
import {useButton} from './use_button.js';
import {listOf, waitFor} from './waiting.js';

/** @typedef {import('../api/requests/logs.js').Log} Log */
/** @typedef {import('../api/requests/logs.js').LogTrajectory} LogTrajectory */

const MILLI = 1000;
const ERROR = figureOf('max_error');

/**
 * @param {import('../api/api.js').Api} api
 * @param {import('../api/undo.js').History} history
 * @param {import('../dom/notices.js').Tell} tell
 * @param {Log} log
 */
export async function showTrajectory(api, history, tell, {number, name}) {
  let found;
  try {
    found = await waitFor('Smoothing the motion', `${name}: the spline with as many waypoints as it takes.`,
      () => logTrajectory(number));
  } catch (error) {
    tell(`${name} can’t be followed: ${/** @type {Error} */ (error).message}`, {error: true});
  }
  if (!found) return;
  const {patch, spacing, waypoints, duration, limits, remarks} = found;
  const {horizon} = api.experiment.simulation;
  const beyond = duration > horizon
    ? [`it lasts ${written(Number(duration.toPrecision(4)))} s, and the horizon of Response ends at ${horizon} s`] : [];
  const alert = element('p', {class: 'dialog-alert', role: 'alert'});
  const use = useButton('Follow this motion', alert, async () => {
    await history.change(patch, `trajectory from ${name}`);
    // It begins at t = 0 and has an end, which is long over in a session that has run for a while.
    api.reset();
    dialog.close();
    tellWithUndo(tell, history, `The desired motion is ${name} now, from t = 0 on.`);
  });
  const dialog = showDialog(`${name} as trajectory`, element('div', {class: 'dialog-text own-data'},
    element('p', {}, `${waypoints} waypoints, ${written(Number((spacing * MILLI).toPrecision(4)))} ms apart. What the `
      + 'smooth motion leaves of the rows:'),
    residuals(found),
    limits.length ? element('div', {class: 'own-data-over'}, listOf(limits, 'Beyond the arm’s limits')) : null,
    listOf([...remarks, ...beyond], 'To know'), alert,
    element('div', {class: 'dialog-buttons'}, use)));
  use.focus();
}

/** @param {LogTrajectory} found */
function residuals({rms, greatest}) {
  const cell = (/** @type {number} */ value, /** @type {number} */ at) => (
    element('td', {class: 'own-data-number'}, `${figureNumber(ERROR, value)} ${unitAt(ERROR.shown_unit, at + 1)}`)
  );
  return element('table', {class: 'own-data-table'},
    element('thead', {}, element('tr', {}, ...['joint', 'effective', 'greatest'].map((text) => (
      element('th', {scope: 'col'}, text))))),
    element('tbody', {}, ...JOINT_NAMES.map((name, at) => element('tr', {},
      element('th', {scope: 'row'}, name), cell(rms[at], at), cell(greatest[at], at)))));
}
