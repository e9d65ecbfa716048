// @ts-check
/** Logs of a real arm that the server keeps while it runs: brought, compared, followed, fitted. */

import {request} from '../http.js';
import {decodedResponse, headOf} from '../preview_message.js';

/** @typedef {import('../../fields/merge_patch.js').Document} Document */
/** @typedef {import('../preview_message.js').Response} Response */
/**
 * `holds`: what it has columns of, such as `torques`; `shift` [s]: null where it is found.
 * @typedef {{number: number, name: string, arm: string, rows: number, duration: number, rate: number,
 *   holds: string[], remarks: string[], shown: boolean, shift: number|null}} Log
 */
/**
 * `mapping`: column by `time`, joint from 1, or that with `.torque`.
 * @typedef {{mapping?: {[what: string]: string}, source?: string|null, angles?: string,
 *   time?: string}} Said
 */
/**
 * @typedef {{log: Log|null, reason: {message: string, row: number|null, column: string}|null,
 *   columns: string[], sources: string[], joints: string[], mapping: {[what: string]: string}}} LogReport
 */
/**
 * A log as a response whose one lane is the log; `begin` and `end` [s]: its rows within the horizon.
 * @typedef {{response: Response, shift: number, rms: number|null, others: number[],
 *   against: 'experiment'|'log', begin: number, end: number, remarks: string[]}} Overlay
 */
/**
 * @typedef {{patch: Document, spacing: number, waypoints: number, duration: number, rms: number[],
 *   greatest: number[], limits: string[], remarks: string[]}} LogTrajectory
 */
/**
 * @typedef {{path: string, title: string, unit: string, present: number, value: number|null,
 *   low: number|null, high: number|null, told: 'yes'|'given'|'no', reason: string}} Estimate
 */
/**
 * `torque` and `residual` by joint, in [N·m].
 * @typedef {{estimates: Estimate[], patch: Document, rms_torque: number[], rms_residual: number[],
 *   bandwidth: number, remarks: string[], time: number[], torque: number[][],
 *   residual: number[][]}} Identification
 */

/** @returns {Promise<Log[]>} the oldest first */
export async function listLogs() { return (await request('GET', '/api/logs')).logs; }

/**
 * @param {File} file
 * @param {Said} said
 * @returns {Promise<LogReport>}
 */
export function bringLog(file, said) {
  const form = new FormData();
  form.append('wanted', JSON.stringify(said));
  form.append('file', file, file.name);
  return request('POST', '/api/logs', form);
}

/**
 * @param {number} number
 * @param {boolean} shown beside the lanes
 */
export function showLog(number, shown) { return request('PATCH', `/api/logs/${number}`, {shown}); }

/** @param {number} number */
export function forgetLog(number) { return request('DELETE', `/api/logs/${number}`); }

/**
 * @param {number} number
 * @param {number|'auto'|null} shift in [s]; null: as it was last
 * @returns {Promise<Overlay|null>}
 */
export async function compareLog(number, shift) {
  return overlayOf(await request('POST', `/api/logs/${number}/curves`, {shift}));
}

/**
 * @param {number} number
 * @returns {Promise<Overlay|null>} what the owner's page last showed; null: nothing yet
 */
export async function keptCurves(number) {
  return overlayOf(await request('GET', `/api/logs/${number}/curves`));
}

/**
 * @param {number} number
 * @returns {Promise<LogTrajectory>}
 */
export function logTrajectory(number) { return request('POST', `/api/logs/${number}/trajectory`, {}); }

/**
 * @param {number} number
 * @param {number[]|null} constants torque per current in [N·m/A]; null: the log has torques
 * @returns {Promise<Identification>}
 */
export function identifyLog(number, constants) {
  return request('POST', `/api/logs/${number}/identify`, {constants});
}

/** @param {ArrayBuffer|null} buffer */
function overlayOf(buffer) {
  if (!buffer) return null;
  const {shift, rms, others, against, begin, end, remarks} = headOf(buffer).head;
  return {response: decodedResponse(buffer), shift, rms, others, against, begin, end, remarks};
}
