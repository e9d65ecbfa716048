// @ts-check
/** Which numbers a study can turn: the gains of a lane that act, and numbers of the experiment. */

import {fieldPath} from '../fields/field_path.js';
import {valueAt} from '../fields/merge_patch.js';
import {fitting} from '../fields/quantity.js';

/** @typedef {import('../fields/merge_patch.js').Document} Document */
/** @typedef {import('../fields/schema.js').Field} Field */
/** @typedef {import('../fields/schema.js').Schema} Schema */
/** @typedef {{id: string, group: string, field: Field, value: number|number[]}} Tunable `id`: as a sweep names it */

/** From a tenth of its value to ten times; as the server has it. */
const WIDTH = 10;
const ELSEWHERE = new Set(['uncertainty']);

/**
 * Gains that have an effect under the lane's present choices.
 *
 * @param {Schema} schema
 * @param {Document} experiment
 * @param {string} lane
 * @returns {Tunable[]}
 */
export function gainsOf(schema, experiment, lane) {
  const gains = experiment.lanes?.[lane];
  if (!gains) return [];
  return schema.laneFields(gains.law, lane)
    .filter((field) => isNumber(field) && acts(field, gains))
    .map((field) => {
      const id = field.path[2];
      return {id, group: `Gains of ${lane}`, field, value: gains[id]};
    });
}

/**
 * @param {Schema} schema
 * @param {Document} experiment
 * @returns {Tunable[]} numbers outside of the lanes
 */
export function numbersOf(schema, experiment) {
  return schema.sections().filter(({path}) => !ELSEWHERE.has(path[0]))
    .flatMap((section) => within(schema, section, section.title, experiment));
}

/**
 * @param {Schema} schema
 * @param {import('../fields/schema.js').Section} section
 * @param {string} group
 * @param {Document} experiment
 * @returns {Tunable[]}
 */
function within(schema, section, group, experiment) {
  const value = valueAt(experiment, section.path);
  if (!value) return [];
  return schema.contents(section, value).flatMap((item) => {
    if ('node' in item) return within(schema, item, `${group}: ${item.title}`, experiment);
    const now = valueAt(experiment, item.path);
    const known = [now].flat().every((one) => typeof one === 'number');
    return isNumber(item) && known ? [{id: fieldPath(item.path), group, field: item, value: now}] : [];
  });
}

/** @param {Field} field */
function isNumber({kind, odd, integer, minimum, maximum}) {
  const bounded = Number.isFinite(minimum) && Number.isFinite(maximum);
  return (kind === 'number' || kind === 'joints') && bounded && !odd && !integer;
}

/**
 * @param {Field} field
 * @param {Document} gains
 */
function acts({needs, weight}, gains) {
  const chosen = Object.entries(needs).every(([key, options]) => options.includes(gains[key]));
  return chosen && (!weight || [gains[weight.name]].flat().some((share) => share !== 0));
}

/** @param {Tunable} tunable */
export function presentOf({value}) { return Math.max(...[value].flat().map(Math.abs)); }

/**
 * @param {Tunable} tunable
 * @returns {[number, number]} from a tenth of the present value to ten times, within the bounds
 */
export function usualRange(tunable) {
  const {field} = tunable;
  const present = presentOf(tunable);
  if (present === 0) return [field.minimum, field.maximum];
  const exact = {...field, integer: false, odd: false};
  return [fitting(present / WIDTH, exact), fitting(present * WIDTH, exact)];
}

/** @param {number} low @param {number} high */
export function spansDecade(low, high) { return low > 0 && high >= WIDTH * low; }
