// @ts-check
/** What a lane's whole response depends on, as a text that can be compared. */

import {versionOf} from './law_versions.js';

/**
 * @param {{[section: string]: any}} experiment
 * @param {string} lane
 * @param {string[]} [except] gains that don't count
 */
export function keyOf(experiment, lane, except = []) {
  const {robot, trajectory, disturbance, simulation, lanes} = experiment;
  const gains = Object.entries(lanes?.[lane] ?? {}).filter(([name]) => !except.includes(name));
  const version = versionOf(lanes?.[lane]?.law);
  return JSON.stringify([lane, gains, version, robot, trajectory, disturbance, simulation]);
}

/** Gains that the threshold of silence does not depend on. */
const FREE = ['epsilon', 'switching'];

/**
 * @param {{[section: string]: any}} experiment
 * @param {string} lane
 * @returns {string} what its threshold of silence depends on
 */
export function thresholdKey(experiment, lane) { return keyOf(experiment, lane, FREE); }
