// @ts-check
/** How far this browser's user has come in each lesson, and the lesson that is open. */

import {recall, remember} from '../screen/remembered.js';

/** @typedef {import('./course.js').Standing} Standing */
/** @typedef {{furthest: number, done: boolean}} Progress how many steps were seen */

const PROGRESS = 'lessons.progress';
const OPEN = 'lessons.open';

/**
 * @param {string} key
 * @returns {any} what was kept there, or null
 */
function kept(key) {
  try {
    return JSON.parse(recall(key) ?? 'null');
  } catch {
    // Somebody else wrote it.
    return null;
  }
}

/**
 * @param {string} name of the lesson
 * @returns {Progress}
 */
export function progressOf(name) {
  const {furthest = 0, done = false} = kept(PROGRESS)?.[name] ?? {};
  return {furthest, done};
}

/**
 * @param {string} name
 * @param {number} steps that have been seen
 * @param {boolean} [done] whether it was gone through to its end
 */
export function noteProgress(name, steps, done = false) {
  const before = progressOf(name);
  const now = {furthest: Math.max(before.furthest, steps), done: done || before.done};
  remember(PROGRESS, JSON.stringify({...kept(PROGRESS), [name]: now}));
}

/** @returns {Standing|null} the lesson that was open when the page was left */
export function openLesson() {
  const standing = kept(OPEN);
  return standing?.name && standing.before?.experiment?.lanes ? standing : null;
}

/** @param {Standing|null} standing null when none is open any more */
export function noteOpenLesson(standing) {
  remember(OPEN, standing && JSON.stringify(standing));
}
