// @ts-check
/** What studies are called, and how far they are, in words. */

import {inDigits} from '../figures/columns.js';

/** @typedef {import('../api/requests/studies.js').Summary} Summary */
/** @typedef {import('../api/requests/studies.js').Kind} Kind */

/** @type {{[kind in Kind]: {title: string, does: string, entries: string}}} */
export const KINDS = {
  tune: {
    title: 'Auto-tune', entries: 'trials',
    does: 'Searches for gains of the lane that keep to the goals, from the present ones on.',
  },
  robustness: {
    title: 'Robustness', entries: 'draws',
    does: 'Runs the lane at many draws of what is not known exactly, and shows what they come to.',
  },
  worst: {
    title: 'Worst case', entries: 'tries',
    does: 'Searches within the ranges of Uncertainty for where the lane does worst.',
  },
  sweep: {
    title: 'Sweep', entries: 'points',
    does: 'Runs the lane at every value of one field, or at every pair of values of two.',
  },
};

const MINUTE = 60;
const HOUR = 3600;

/** @param {Summary} summary */
export function nameOf({title, kind, lane}) { return title || `${KINDS[kind].title} of ${lane}`; }

/** @param {Summary} summary */
export function whenOf({created}) {
  return new Date(created * 1000).toLocaleString(undefined, {dateStyle: 'short', timeStyle: 'short'});
}

/** @param {Summary} summary */
export function stateWords({state, message}) {
  if (state === 'failed') return message ? `failed: ${message}` : 'failed';
  return state === 'waiting' ? 'waiting for its turn' : state;
}

/**
 * @param {Summary} summary
 * @returns {string} such as `40 of 200 trials, 12 s left`
 */
export function progressWords({kind, made, total, state, seconds_left: left, tasks_done: tasks}) {
  const counted = `${made} of ${total} ${KINDS[kind].entries}`;
  if (state === 'running' && left === null && tasks) {
    return `${counted}; ${tasks} ${tasks === 1 ? 'task' : 'tasks'} of the first have ended`;
  }
  return state === 'running' && left !== null ? `${counted}, ${durationWords(left)} left` : counted;
}

/** @param {number} seconds */
function durationWords(seconds) {
  if (seconds < MINUTE) return `${Math.max(1, Math.round(seconds))} s`;
  if (seconds < HOUR) return `${Math.round(seconds / MINUTE)} min`;
  return `${inDigits(seconds / HOUR, 2)} h`;
}
