// @ts-check
/** Which column is which: a select for time and for each joint, units that no header says. */

import {element, freshId} from '../dom/element.js';
import {showDialog} from '../dom/dialog.js';
import {withScrollCue} from '../dom/scroll_cue.js';

/** @typedef {import('../api/requests/logs.js').LogReport} LogReport */
/** @typedef {import('../api/requests/logs.js').Said} Said */
/** @typedef {{name: string, value: string}} Option */

const ANGLES = [['', 'as the header says, else rad'], ['rad', 'rad'], ['deg', 'degrees']];
const TIMES = [['', 'as the header says'], ...['s', 'ms', 'us', 'ns'].map((unit) => [unit, unit])];

/**
 * @param {string} name of the file
 * @param {LogReport} report
 * @param {Said} said what was said of it so far
 * @param {(said: Said) => void} read
 */
export function askForColumns(name, {columns, sources, joints, mapping}, said, read) {
  const known = columns.map((column) => [column, column]);
  /** @type {[string, HTMLSelectElement][]} */ const chosen = [];
  const columnOf = (/** @type {string} */ key, /** @type {string} */ label, /** @type {string} */ none) => {
    const select = selectOf(label, [['', none], ...known], said.mapping?.[key] ?? mapping[key] ?? '');
    chosen.push([key, select]);
    return select;
  };
  const source = sources.length ? selectOf('Source', sources.map((one) => [one, one]), said.source ?? '') : null;
  const angles = selectOf('Unit of angles', ANGLES, said.angles ?? '');
  const time = selectOf('Unit of time', TIMES, said.time ?? '');
  const table = columns.length ? withScrollCue(element('div', {
    class: 'own-data-columns', tabindex: 0, role: 'region', 'aria-label': 'Columns of the joints',
  }, element('table', {class: 'own-data-table'},
    element('thead', {}, element('tr', {}, ...['joint', 'angle', 'torque'].map((text) => (
      element('th', {scope: 'col'}, text))))),
    element('tbody', {}, ...joints.map((joint, index) => element('tr', {},
      element('th', {scope: 'row'}, joint),
      element('td', {}, columnOf(`${index + 1}`, `Angle of ${joint}`, 'choose…')),
      element('td', {}, columnOf(`${index + 1}.torque`, `Torque of ${joint}`, 'none')))))))) : null;
  const form = element('form', {class: 'dialog-form own-data', on: {submit: (event) => {
    event.preventDefault();
    dialog.close();
    read({
      mapping: {...said.mapping, ...changed(chosen, mapping)},
      source: source?.value || said.source, angles: angles.value, time: time.value,
    });
  }}},
  source && question('Several have all angles. Which one counts?', source),
  columns.length ? question('Time', columnOf('time', 'Time', 'choose…')) : null, table,
  question('Angles without a unit are', angles), question('Time without a unit is', time),
  element('div', {class: 'dialog-buttons'},
    element('button', {class: 'button', type: 'button', on: {click: () => dialog.close()}}, 'Cancel'),
    element('button', {class: 'button primary', type: 'submit'}, 'Read')));
  const dialog = showDialog(`Columns of ${name}`, form);
  dialog.classList.add('is-wide');
  (chosen.find(([, select]) => !select.value)?.[1] ?? source ?? angles).focus();
}

/**
 * What headers say needs no word; a mapping would win over it.
 *
 * @param {[string, HTMLSelectElement][]} chosen
 * @param {{[what: string]: string}} mapping
 */
function changed(chosen, mapping) {
  return Object.fromEntries(chosen.map(([key, {value}]) => [key, value])
    .filter(([key, value]) => value && value !== mapping[key]));
}

/**
 * @param {string} label
 * @param {string[][]} options value and text of each
 * @param {string} value
 * @returns {HTMLSelectElement}
 */
function selectOf(label, options, value) {
  const select = element('select', {class: 'text-box', 'aria-label': label},
    ...options.map(([one, text]) => element('option', {value: one}, text)));
  select.value = value || options[0][0];
  return select;
}

/**
 * @param {string} text
 * @param {HTMLSelectElement} select
 */
function question(text, select) {
  const id = freshId('own-data');
  select.id = id;
  return element('div', {class: 'question'}, element('label', {for: id}, text), select);
}
