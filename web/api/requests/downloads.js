// @ts-check
/** Files that the server makes of the live experiment and of the live session. */

import {request} from '../http.js';

/**
 * Hand a lane of the live experiment over to a real controller.
 *
 * @param {string} lane
 * @param {string} controller its name there
 * @param {number} draws how many of what is uncertain
 * @returns {Promise<ArrayBuffer>} a ZIP
 */
export function handOver(lane, controller, draws) {
  return request('POST', '/api/hand-over', {lane, controller, draws});
}

/**
 * Run the live experiment and report on it.
 *
 * @returns {Promise<string>} one HTML file
 */
export function reportOf() { return request('POST', '/api/report', {since: 0}); }
