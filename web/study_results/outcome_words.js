// @ts-check
/** What came of runs, in words and numbers: figures, goals, and what was uncertain. */

import {SCHEMA} from '../api/schema_document.js';
import {Schema} from '../fields/schema.js';
import {FIGURES} from '../figures/figure.js';
import {threeDigits} from '../figures/columns.js';

/** @typedef {import('../api/requests/studies.js').Outcome} Outcome */
/** @typedef {import('../api/requests/studies.js').Study} Study */
/** @typedef {import('../fields/schema.js').Field} Field */

/** Those by which gains are judged. */
export const STUDIED = FIGURES.filter(({studied}) => studied);

/** @type {Map<string, Field>} quantities that can be uncertain, by name */
export const QUANTITIES = new Map(uncertain());

/** @returns {[string, Field][]} */
function uncertain() {
  const schema = new Schema(SCHEMA);
  const section = schema.sections().find(({path}) => path[0] === 'uncertainty');
  if (!section) return [];
  return schema.contents(section, {}).flatMap((item) => (
    'options' in item ? [/** @type {[string, Field]} */ ([item.path[1], item])] : []
  ));
}

/**
 * @param {Outcome} outcome
 * @returns {string} why there are no numbers, or ''
 */
export function failureOf({diverged_at: time, refused}) {
  if (refused) return `refused: ${refused}`;
  return time === null ? '' : `left its bounds at ${threeDigits(time)} s`;
}

/**
 * @param {import('../goals/words.js').Goal} goal
 * @param {number|null|undefined} ratio value over bound
 * @returns {string} class of a cell: a hard goal is kept or missed, a soft one neither
 */
export function classOf({priority}, ratio) {
  if (priority !== 'hard') return '';
  return typeof ratio === 'number' && ratio <= 1 ? 'is-kept' : 'is-missed';
}

/**
 * @param {import('../api/api.js').Api} api
 * @param {Study} study
 * @param {{accent: string}} colors
 * @returns {string} of its lane
 */
export function colorOf(api, {lane}, {accent}) {
  return api.lanes.find(({name}) => name === lane)?.color ?? accent;
}
