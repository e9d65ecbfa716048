// @ts-check
/** What a pointer over a panel means as a goal: round values in the unit of the goal. */

import {written} from '../fields/quantity.js';
import {boundedIn} from './bounds.js';

/** @typedef {import('../goals/words.js').Goal} Goal */
/** @typedef {import('../response/views.js').ResponsePanel} ResponsePanel */
/** @typedef {import('./panel_scale.js').PanelScale} PanelScale */
/** @typedef {{x: number, y: number}} Point in pixels of the stage */
/** @typedef {{bound: number}|{start: number}|{end: number|null}} GoalChange `end` null: open */

const DIGITS = 3;
/** A double has more digits than a person wrote. */
const ALL_DIGITS = 12;
const MOST_DECIMALS = 9;
/** Fewer pixels across than this are a click, not a drag; ours. */
export const SLOP = 5;
/** Closer to the beginning or the end of the response than this, in pixels, is that end; ours. */
const SNAP = 5;
const SUBSCRIPTS = '₀₁₂₃₄₅₆';

/**
 * @param {number} value in the unit of the document
 * @param {number} [scale] to the unit in which it is round
 * @returns {number} of three digits there
 */
export function roundBound(value, scale = 1) {
  const shown = Number((value * scale).toPrecision(DIGITS));
  return Number((shown / scale).toPrecision(ALL_DIGITS));
}

/**
 * @param {PanelScale} scale
 * @param {ResponsePanel} panel
 * @param {number} y
 * @returns {number} the bound there, in the unit of the document; never 0
 */
export function boundAt(scale, panel, y) {
  const shown = Math.max(Math.abs(scale.value(y)), scale.valuePerPixel / 2);
  return roundBound(shown / panel.scale, panel.scale);
}

/**
 * @param {PanelScale} scale
 * @param {number} x
 * @param {number} horizon in [s]
 * @returns {number} in [s], as round as a pixel is wide; 0 or the horizon where it is near that
 */
export function instantAt(scale, x, horizon) {
  if (x < scale.x(0) + SNAP) return 0;
  if (x > scale.x(horizon) - SNAP) return horizon;
  return rounded(scale.time(x), scale.timePerPixel);
}

/**
 * @param {number} time in [s]
 * @param {number} step in [s]
 * @returns {number} in decimals that are at least as fine as the step
 */
function rounded(time, step) {
  return Number(time.toFixed(Math.min(MOST_DECIMALS, Math.max(0, Math.ceil(-Math.log10(step))))));
}

/**
 * @param {PanelScale} scale
 * @param {ResponsePanel} panel
 * @param {Point} from
 * @param {Point} to its height counts
 * @param {number} horizon in [s]
 * @returns {Goal} over the whole horizon where the two lie above each other
 */
export function drawnGoal(scale, panel, from, to, horizon) {
  const [first, last] = [from.x, to.x].sort((a, b) => a - b)
    .map((x) => instantAt(scale, x, horizon));
  const whole = Math.abs(to.x - from.x) < SLOP || first >= last;
  const [start, end] = whole ? [0, horizon] : [first, last];
  return {
    kind: 'response', ...boundedIn(panel.channel), bound: boundAt(scale, panel, to.y), start,
    priority: 'soft', ...(end < horizon && {end}),
  };
}

/**
 * One end of a goal's span, moved; the other one stays before or after it.
 *
 * @param {Goal} goal
 * @param {'start'|'end'} end
 * @param {number} time in [s]
 * @param {number} horizon in [s]
 * @param {number} step least span in [s]
 * @returns {GoalChange}
 */
export function movedEnd(goal, end, time, horizon, step) {
  const least = 10 ** Math.floor(Math.log10(step));
  const last = Math.min(goal.end ?? horizon, horizon);
  if (end === 'start') return {start: exact(Math.max(0, Math.min(time, last - least)))};
  return time >= horizon ? {end: null} : {end: exact(Math.max(time, (goal.start ?? 0) + least))};
}

/** @param {number} time without the rounding error of a sum */
function exact(time) { return Number(time.toPrecision(ALL_DIGITS)); }

/**
 * @param {Goal} goal
 * @param {ResponsePanel} panel where it is seen
 * @param {number} horizon in [s]
 * @returns {string} such as `|e₂| ≤ 4.8 mrad, 1 to 6.2 s`, in the unit of the panel
 */
export function boundLabel(goal, {title, quantity, unit, channel, positive, scale}, horizon) {
  const {joint} = boundedIn(channel);
  const what = positive ? `${title} ${quantity}` : `|${quantity}${joint ? SUBSCRIPTS[joint] : ''}|`;
  const {start = 0, end = horizon} = goal;
  const shown = Number((goal.bound * scale).toPrecision(DIGITS));
  return `${what} ≤ ${written(shown)} ${unit}, ${written(start)} to ${written(Math.min(end, horizon))} s`;
}
