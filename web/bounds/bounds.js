// @ts-check
/** The goals of a response as lines in its plots: where they hold, and at which value. */

import {violations} from './violations.js';

/** @typedef {import('../goals/words.js').Goal} Goal */
/** @typedef {import('../api/preview_message.js').LaneResponse} LaneResponse */
/** @typedef {import('../api/preview_message.js').Response} Response */
/** @typedef {import('../response/views.js').ResponsePanel} ResponsePanel */
/**
 * `kept` by every lane that is shown, at the panel's joint; null where there is no response to tell.
 * @typedef {{name: string, goal: Goal, x: Float64Array, y: Float64Array,
 *   kept: boolean|null}} Bound
 */

/**
 * @param {{[name: string]: Goal}} goals
 * @param {ResponsePanel} panel
 * @param {Response|null} response
 * @param {(lane: string) => boolean} shows
 * @returns {Bound[]} two of each goal where the panel shows negative values as well
 */
export function boundsOf(goals, panel, response, shows) {
  const horizon = response?.horizon ?? 0;
  return Object.entries(goals).flatMap(([name, goal]) => {
    if (goal.kind !== 'response' || !concerns(goal, panel.channel)) return [];
    const [start, end] = [goal.start ?? 0, Math.min(goal.end ?? horizon, horizon)];
    if (start >= end) return [];
    const lanes = [...response?.lanes ?? []].flatMap(([lane, one]) => (shows(lane) ? [one] : []));
    const known = lanes.length > 0 && lanes.every(({goals: judged}) => judged?.ratios[name] !== undefined);
    const kept = known ? lanes.every((lane) => isKept(lane, name, goal, panel.channel)) : null;
    const value = goal.bound * panel.scale;
    const signs = panel.positive ? [1] : [1, -1];
    return signs.map((sign) => ({
      name, goal, x: Float64Array.of(start, end), y: Float64Array.of(sign * value, sign * value), kept,
    }));
  });
}

/**
 * The verdict is of all joints that a goal concerns: at one of them alone a bound that is missed may
 * be kept. Where no curve shows who misses it, all of them count as missed.
 *
 * @param {LaneResponse} lane
 * @param {string} name of the goal
 * @param {Goal} goal
 * @param {string} channel of the panel
 */
function isKept(lane, name, goal, channel) {
  const ratio = lane.goals?.ratios[name];
  if (typeof ratio === 'number' && ratio <= 1) return true;
  const misses = [...lane.columns].filter(([column, values]) => (
    concerns(goal, column) && violations(lane.time, values, goal, 0).length > 0
  ));
  return misses.length > 0 && misses.every(([column]) => column !== channel);
}

/**
 * @param {string} channel of a panel, such as `e2`
 * @returns {{channel: string, joint: number}} what a goal calls it, such as e of joint 2
 */
export function boundedIn(channel) {
  const [, stem, joint] = /** @type {RegExpExecArray} */ (/^(.*?)(\d*)$/.exec(channel));
  return {channel: stem, joint: Number(joint)};
}

/**
 * @param {Goal} goal
 * @param {string} channelOfPanel
 */
function concerns({channel, joint}, channelOfPanel) {
  const shown = boundedIn(channelOfPanel);
  return channel === shown.channel && (joint === 0 || joint === shown.joint);
}
