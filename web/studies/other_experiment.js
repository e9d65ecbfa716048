// @ts-check
/** In what the live experiment is another one than that of a study. */

import {difference, leaves, valueAt} from '../fields/merge_patch.js';

/** @typedef {import('../fields/merge_patch.js').Document} Document */

/** What a study's runs depend on, beside its lane. */
const SECTIONS = ['robot', 'trajectory', 'disturbance', 'simulation', 'uncertainty'];
const MOST = 3;

/**
 * Whatever a search turns does not count: to have other gains is what it is for.
 *
 * @param {import('../api/requests/studies.js').Study} study
 * @param {Document} live
 * @param {import('../fields/field_names.js').FieldNames} names
 * @returns {string[]} names of the fields, the first few; none where it is the same
 */
export function differencesOf({experiment, lane, kind, wanted}, live, names) {
  if (!live.lanes) return [];
  if (!(lane in live.lanes)) return [`its lanes: there is no ${lane}`];
  const part = (/** @type {Document} */ {lanes, goals, ...rest}) => ({
    ...Object.fromEntries(SECTIONS.map((name) => [name, rest[name]])), lanes: {[lane]: lanes[lane]},
  });
  const isTurned = (/** @type {readonly string[]} */ [section, , gain]) => (
    section === 'lanes' && kind === 'tune' && turns(wanted.gains, gain, live.lanes[lane][gain])
  );
  const paths = leaves(difference(part(experiment), part(live))).filter((path) => !isTurned(path));
  const found = paths.map((path) => names.of(path).symbol.replace('_', '') || inSentence(names.of(path).title));
  const goals = Object.keys(difference(goalsOf(experiment), goalsOf(live)));
  const all = [...new Set([...found, ...(goals.length ? ['its goals'] : [])])];
  return all.length > MOST ? [...all.slice(0, MOST), `${all.length - MOST} more`] : all;
}

/**
 * @param {Document} gains that a search turns by name; none where it turns all
 * @param {string} name
 * @param {any} value its present one
 */
function turns(gains, name, value) {
  if (Object.keys(gains).length) return name in gains;
  return [value].flat().every((one) => typeof one === 'number');
}

/** @param {Document} experiment */
function goalsOf(experiment) { return valueAt(experiment, ['goals']) ?? {}; }

/** @param {string} title which may begin with a person's name */
function inSentence(title) {
  return title.startsWith('Coulomb') ? title : title.charAt(0).toLowerCase() + title.slice(1);
}
