// @ts-check
/** In what the live experiment is another one than that of a study. */

import {difference, leaves, valueAt} from '../fields/merge_patch.js';

/** @typedef {import('../fields/merge_patch.js').Document} Document */

/** What a study's runs depend on, beside its lane. */
const SECTIONS = ['robot', 'trajectory', 'disturbance', 'simulation', 'uncertainty'];
const MOST = 3;

/**
 * @param {import('../api/studies.js').Study} study
 * @param {Document} live
 * @param {import('../fields/field_names.js').FieldNames} names
 * @returns {string[]} names of the fields, the first few; none where it is the same
 */
export function differencesOf({experiment, lane}, live, names) {
  if (!live.lanes) return [];
  if (!(lane in live.lanes)) return [`its lanes: there is no ${lane}`];
  const part = (/** @type {Document} */ {lanes, goals, ...rest}) => ({
    ...Object.fromEntries(SECTIONS.map((name) => [name, rest[name]])), lanes: {[lane]: lanes[lane]},
  });
  const paths = leaves(difference(part(experiment), part(live)));
  const found = paths.map((path) => names.of(path).symbol || inSentence(names.of(path).title));
  const goals = Object.keys(difference(goalsOf(experiment), goalsOf(live)));
  const all = [...new Set([...found, ...(goals.length ? ['its goals'] : [])])];
  return all.length > MOST ? [...all.slice(0, MOST), `${all.length - MOST} more`] : all;
}

/** @param {Document} experiment */
function goalsOf(experiment) { return valueAt(experiment, ['goals']) ?? {}; }

/** @param {string} title */
function inSentence(title) { return title.charAt(0).toLowerCase() + title.slice(1); }
