// @ts-check
/** What a lane's whole response depends on, as a text that can be compared. */

/**
 * @param {{[section: string]: any}} experiment
 * @param {string} lane
 * @param {string[]} [except] gains that don't count
 */
export function keyOf(experiment, lane, except = []) {
  const {robot, trajectory, disturbance, simulation, lanes} = experiment;
  const gains = Object.entries(lanes?.[lane] ?? {}).filter(([name]) => !except.includes(name));
  return JSON.stringify([lane, gains, robot, trajectory, disturbance, simulation]);
}
