// @ts-check
/** Arms that are kept at the server: listed, brought, forgotten. */

import {request} from '../http.js';

/**
 * @typedef {{name: string, title: string, meaning: string, joints: number, shipped: boolean,
 *   problem: string}} ArmSummary
 */
/** @typedef {{kind: string, where: string, line: number|null, text: string, remedy: string}} Finding */
/**
 * @typedef {{name: string, robot: string, summary: string, tip: string, joints: string[],
 *   held: string[], findings: Finding[]}} Report
 */
/** @typedef {{urdf?: string, tip?: string, total_mass?: string}} Said */

/** @returns {Promise<ArmSummary[]>} those that ship first */
export async function listArms() { return (await request('GET', '/api/arms')).arms; }

/**
 * Have an arm examined, and kept where nothing is refused.
 *
 * @param {{path: string, file: File}[]} files
 * @param {Said} said
 * @returns {Promise<Report>}
 */
export function bringArm(files, said) {
  const form = new FormData();
  for (const {path, file} of files) form.append('files', file, path);
  const given = Object.entries(said).filter(([, value]) => value);
  return request('POST', `/api/arms?${new URLSearchParams(Object.fromEntries(given))}`, form);
}

/**
 * @param {string} law
 * @returns {Promise<{[gain: string]: any}>} a lane of it with gains of the live arm's size
 */
export async function laneOfItsSize(law) {
  return (await request('GET', `/api/arms/lane?${new URLSearchParams({law})}`)).lane;
}

/** @param {string} name */
export function forgetArm(name) { return request('DELETE', `/api/arms/${encodeURIComponent(name)}`); }
