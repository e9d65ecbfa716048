// @ts-check
/** What can be bounded: its name, its unit on the screen, and whether it has joints. */

import {unitAt, unitOfAll} from '../api/arm.js';
import {FIGURES} from '../figures/figure.js';
import {inDigits} from '../figures/columns.js';
import {withUnit} from '../fields/quantity.js';

/**
 * @typedef {object} Goal a response's or a figure's
 * @property {'response'|'figure'} kind
 * @property {string} [channel]
 * @property {string} [figure]
 * @property {number} bound
 * @property {number} joint 0 for every one
 * @property {'hard'|'soft'} priority
 * @property {number} [start]
 * @property {number} [end]
 */
/**
 * @typedef {{id: string, kind: 'response'|'figure', name: string, title: string, unit: string,
 *   factor: number, joints: boolean}} Bounded `factor`: from the unit of the document to the one shown
 */

const DIGITS = 3;
/** Beyond these it is said in words; ours. */
const MOST_DIGITS = 7;

/** @type {Bounded[]} */
const CHANNELS = [
  ['e', 'error |e|', 'rad', 1, true],
  ['de', 'velocity error |de|', 'rad/s', 1, true],
  ['tau', 'torque |τ|', 'N·m', 1, true],
  ['S', 'sliding variable |S|', 'rad/s', 1, true],
  ['flange_error', 'flange error', 'mm', 1000, false],
].map(([name, title, unit, factor, joints]) => /** @type {Bounded} */ ({
  id: `response.${name}`, kind: 'response', name, title, unit: joints ? unitOfAll(unit) : unit, factor, joints,
}));

/** Everything that can be bounded, in the order in which it is offered. */
export const BOUNDED = [
  ...CHANNELS,
  ...FIGURES.filter(({source, better}) => source === 'run' && better === 'less').map((figure) => (
    /** @type {Bounded} */ ({
      id: `figure.${figure.name}`, kind: 'figure', name: figure.name, title: figure.title,
      unit: figure.shown_unit, factor: figure.factor, joints: figure.per_joint,
    })
  )),
];

/**
 * @param {string} figure
 * @returns {Bounded|undefined} nothing where less is not better
 */
export function boundedFigure(figure) { return BOUNDED.find(({id}) => id === `figure.${figure}`); }

/**
 * @param {Goal} goal
 * @returns {Bounded}
 */
export function boundedBy(goal) {
  const id = `${goal.kind}.${goal.kind === 'response' ? goal.channel : goal.figure}`;
  const found = BOUNDED.find((one) => one.id === id);
  if (!found) throw new Error(`nothing is called ${id}`);
  return found;
}

/**
 * @param {Goal} goal
 * @param {number} horizon in [s]
 * @returns {string} such as `error |e| of joint 2 ≤ 0.005 rad, from 1 s`
 */
export function goalWords(goal, horizon) {
  const {title, unit, factor} = boundedBy(goal);
  const joint = goal.joint ? ` of joint ${goal.joint}` : '';
  const own = goal.joint ? unitAt(unit, goal.joint) : unit;
  return `${title}${joint} ≤ ${withUnit(goal.bound * factor, own)}${span(goal, horizon)}`;
}

/**
 * @param {Goal} goal
 * @param {number} horizon
 */
function span(goal, horizon) {
  if (goal.kind === 'figure') return '';
  const {start = 0, end = horizon} = goal;
  if (end < horizon) return `, ${withUnit(start, 's')} to ${withUnit(end, 's')}`;
  return start > 0 ? `, from ${withUnit(start, 's')}` : '';
}

/**
 * @param {number|null|undefined} ratio value over bound, or a score
 * @returns {string} three digits, or as many as tell a missed bound from one that is just met
 */
export function ratioText(ratio) {
  const missed = typeof ratio === 'number' && ratio > 1;
  for (let digits = DIGITS; digits <= MOST_DIGITS; digits += 1) {
    const text = inDigits(ratio, digits);
    if (!missed || text !== inDigits(1, digits)) return text;
  }
  return '> 1';
}
