// @ts-check
/**
 * Gains that this tab tries as side B, kept over a reload of the page: which they are, and those that
 * they stand in for. Another tab has its own.
 */

import {same} from '../fields/merge_patch.js';

/** @typedef {import('../fields/merge_patch.js').Document} Document */
/**
 * `former`, `tried`: the whole lane.
 * @typedef {{lane: string, former: Document, tried: Document, origin: Origin}} Tried
 */
/** @typedef {{study: number, trial: number}} Origin where the tried gains are from */

const KEY = 'slidetune.tried';

/** @param {Tried|null} tried null: none any more */
export function keepTried(tried) {
  try {
    if (tried) sessionStorage.setItem(KEY, JSON.stringify(tried));
    else sessionStorage.removeItem(KEY);
  } catch {
    // Storage may be switched off; the list of edits has the former gains too.
  }
}

/**
 * What is still tried; forgotten where the lane has other gains by now.
 *
 * @param {Document} experiment the live one
 * @returns {Tried|null}
 */
export function triedStill(experiment) {
  if (!experiment.lanes) return null; // not known yet
  try {
    /** @type {Tried|null} */ const kept = JSON.parse(sessionStorage.getItem(KEY) ?? 'null');
    if (kept && same(experiment.lanes?.[kept.lane], kept.tried)) return kept;
    if (kept) keepTried(null);
    return null;
  } catch {
    return null;
  }
}
