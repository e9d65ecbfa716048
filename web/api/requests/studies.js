// @ts-check
/** Studies that the server keeps: searches for gains, draws of what is uncertain, sweeps. */

import {request} from '../http.js';

/** @typedef {import('../../fields/merge_patch.js').Document} Document */
/** @typedef {'tune'|'robustness'|'worst'|'sweep'} Kind */
/**
 * A study, and how far it is: `made` of `total` entries; `created` in seconds since 1970.
 *
 * @typedef {{id: number, kind: Kind, lane: string, title: string, created: number, version: string,
 *   state: 'waiting'|'running'|'stopped'|'done'|'failed', message: string, total: number,
 *   made: number, seconds_left: number|null, tasks_done: number}} Summary
 */
/** @typedef {Summary & {wanted: Document, experiment: Document, result: Document}} Study */
/**
 * What came of one run. `ratios` of the goals and `figures` by name, null where there are none;
 * `cost` is what a search makes small: below 1 where every hard goal holds.
 *
 * @typedef {{cost: number, score: number|null, kept: boolean,
 *   ratios: {[goal: string]: number|null}, figures: {[name: string]: number|null},
 *   diverged_at: number|null, refused: string}} Outcome
 */
/**
 * @typedef {{number: number, values: {[gain: string]: number}, patch: Document, outcome: Outcome,
 *   draws: {draws: number, diverged: number, kept: number, means?: {[figure: string]: number|null}},
 *   beaten: boolean, louder?: boolean}} Trial
 */
/**
 * @typedef {{index: number, share: number[], values: {[quantity: string]: number},
 *   outcome: Outcome}} Draw
 */
/** @typedef {{values: number[], outcome: Outcome}} Point */
/** @typedef {Trial|Draw|Point} Entry */
/** @typedef {{low: (number|null)[], median: (number|null)[], high: (number|null)[],
 *   least: (number|null)[], greatest: (number|null)[]}} Band */
/** @typedef {{draws: number, time: number[], curves: {[name: string]: Band}}} Bands */
/** @typedef {'yaml'|'csv'|'parquet'|'preset'} Format */
/**
 * `revision`: the one that it made; for `seconds` of simulated time the hard goals in `watched` are
 * watched, those in `unwatched` can't be.
 *
 * @typedef {{accepted: boolean, revision: number, seconds: number, watched: string[],
 *   unwatched: string[]}} Accepted
 */

const ROOT = '/api/studies';

/** @param {Summary} summary */
export function isUnderWay({state}) { return state === 'waiting' || state === 'running'; }

/** @returns {Promise<Summary[]>} the newest first */
export async function listStudies() { return (await request('GET', ROOT)).studies; }

/** @returns {Promise<{[kind in Kind]: Document}>} JSON Schemas of what a study of a kind is told */
export function studyKinds() { return request('GET', `${ROOT}/kinds`); }

/**
 * Begin a study of the live experiment.
 *
 * @param {{kind: Kind, wanted: Document, title?: string, experiment?: Document}} wanted
 * @returns {Promise<Summary>} broken with an ApiError that names the refused fields
 */
export function beginStudy(wanted) { return request('POST', ROOT, wanted); }

/**
 * @param {number} id
 * @returns {Promise<Study>}
 */
export function oneStudy(id) { return request('GET', `${ROOT}/${id}`); }

/**
 * @param {number} id
 * @param {number} place of the entry, from 0
 * @returns {Promise<Document>} the whole experiment that it is of
 */
export function entryExperiment(id, place) {
  return request('GET', `${ROOT}/${id}/entries/${place}/experiment`);
}

/**
 * @param {number} id
 * @returns {Promise<Bands>}
 */
export function studyBands(id) { return request('GET', `${ROOT}/${id}/bands`); }

/**
 * End it early; what is done is kept.
 *
 * @param {number} id
 * @returns {Promise<Summary>}
 */
export function stopStudy(id) { return request('POST', `${ROOT}/${id}/stop`); }

/**
 * Go on with one that was stopped or has failed.
 *
 * @param {number} id
 * @returns {Promise<Summary>}
 */
export function resumeStudy(id) { return request('POST', `${ROOT}/${id}/resume`); }

/**
 * Show an entry's run in 3D beside the nominal one.
 *
 * @param {number} id
 * @param {number} place number of the entry, from 0
 * @returns {Promise<{seconds: number}>} for how long
 */
export function replayEntry(id, place) { return request('POST', `${ROOT}/${id}/entries/${place}/replay`); }

/** @param {number} id */
export function deleteStudy(id) { return request('DELETE', `${ROOT}/${id}`); }

/**
 * @param {number} id
 * @param {Format} format
 * @param {number} [trial] whose gains a preset has; those of the best one where it is left out
 * @returns {string} address of the file
 */
export function studyFile(id, format, trial) {
  const of = trial === undefined ? '' : `&trial=${trial}`;
  return `${ROOT}/${id}/download?format=${format}${of}`;
}

/**
 * Give a live lane other gains; for a while the server watches whether it keeps its hard goals, and
 * goes back to the former gains with a notice if it does not.
 *
 * @param {string} lane
 * @param {Document} patch merge patch of the experiment that touches nothing but this lane
 * @param {string} client id of this page, whose edit it is
 * @returns {Promise<Accepted>} broken with an ApiError where the server refuses
 */
export function acceptGains(lane, patch, client) {
  return request('POST', `${ROOT}/accept`, {lane, patch, client});
}

/**
 * Follow a study: all its entries so far, then more as they come, until it ends.
 *
 * @param {number} id
 * @param {(summary: Summary, entries: Entry[], first: number) => void} onProgress `entries` from
 *   the one numbered `first` on
 * @param {(message: string) => void} onLost the server can't be heard; it is tried again
 * @returns {() => void} stop following
 */
export function followStudy(id, onProgress, onLost) {
  const source = new EventSource(`${ROOT}/${id}/events`);
  source.addEventListener('progress', (event) => {
    const {entries, first, ...summary} = JSON.parse(/** @type {MessageEvent} */ (event).data);
    onProgress(summary, entries, first);
    // Of one that has ended the entries may take several messages.
    if (!isUnderWay(summary) && first + entries.length >= summary.made) source.close();
  });
  source.addEventListener('error', () => {
    onLost(source.readyState === EventSource.CLOSED ? 'The study can\'t be followed any more.' : '');
  });
  return () => source.close();
}
