// @ts-check
/** Files that the server makes of the live experiment and of the live session. */

import {request, requestFile} from '../http.js';

/**
 * Hand a lane of the live experiment over to a real controller.
 *
 * @param {string} lane
 * @param {string} controller its name there
 * @param {number} draws how many of what is uncertain
 * @param {AbortSignal} signal
 * @returns {Promise<ArrayBuffer>} a ZIP
 */
export function handOver(lane, controller, draws, signal) {
  return request('POST', '/api/hand-over', {lane, controller, draws}, signal);
}

/** @typedef {'csv'|'parquet'|'mcap'} Format */

/**
 * The newest rows of the live session.
 *
 * @param {Format} format
 * @param {number} seconds of simulated time at most
 * @param {AbortSignal} signal
 * @returns {Promise<Blob>}
 */
export function windowAs(format, seconds, signal) {
  return requestFile('/api/exports/window', {format, seconds}, signal);
}

/**
 * A whole run of the live experiment.
 *
 * @param {Format} format
 * @param {AbortSignal} signal
 * @returns {Promise<Blob>}
 */
export function runAs(format, signal) { return requestFile('/api/exports/run', {format}, signal); }

/**
 * Run the live experiment and report on it.
 *
 * @returns {Promise<string>} one HTML file
 */
export function reportOf() { return request('POST', '/api/report', {since: 0}); }
