// @ts-check
/** The binary message of whole responses. */

/** @typedef {import('../figures/columns.js').Figures} Figures of a whole run */
/** @typedef {{time: number, joint: number, cause: string, gamma: number|null}} Frozen */
/**
 * How good a run is; `error_estimate` [rad] is null where nobody asked for it.
 * @typedef {{error_estimate: number|null, unconverged: number, capped: number,
 *   at_least: boolean, remark: string,
 *   patch: import('../fields/merge_patch.js').Document|null}} Accuracy
 */
/**
 * How a lane keeps to the goals: value over bound by name, null where it can't be told.
 * @typedef {{ratios: {[goal: string]: number|null}, hard: number|null, soft: number|null,
 *   score: number|null, kept: boolean, met: boolean, worst: string}} Verdict
 */
/**
 * One lane over the horizon, thinned to its extremes; NaN after it left its bounds.
 * @typedef {{name: string, time: Float32Array, columns: Map<string, Float32Array>,
 *   metrics: Figures, frozen: Frozen|null, accuracy: Accuracy, goals: Verdict}} LaneResponse
 */
/**
 * `hold`: for so long in [s] a sampled controller holds a torque, 0 where nothing is sampled;
 * `estimated`: whether every lane's error was estimated.
 * @typedef {{revision: number, estimated: boolean, horizon: number, hold: number,
 *   lanes: Map<string, LaneResponse>}} Response
 */

const NUMBER_BYTES = 4;
const LENGTH_BYTES = 4;
/** The flange's path: x, y, z. It is for the 3D scene, which has its own. */
const PATH_COLUMNS = 3;

/**
 * @param {ArrayBuffer} buffer
 * @returns {{head: {[name: string]: any}, end: number}} the JSON before the columns, and where it ends
 */
export function headOf(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const text = new TextDecoder().decode(new Uint8Array(buffer, LENGTH_BYTES, length));
  return {head: JSON.parse(text), end: LENGTH_BYTES + length};
}

/**
 * @param {ArrayBuffer} buffer
 * @returns {Response} its columns are views of the buffer
 */
export function decodedResponse(buffer) {
  const {head, end} = headOf(buffer);
  let offset = end;
  const column = (/** @type {number} */ rows) => {
    const values = new Float32Array(buffer, offset, rows);
    offset += rows * NUMBER_BYTES;
    return values;
  };
  /** @type {Map<string, LaneResponse>} */ const lanes = new Map();
  for (const {name, points, path_points: pathPoints, metrics, frozen, accuracy, goals} of head.lanes) {
    const time = column(points);
    /** @type {string[]} */ const channels = head.channels;
    const columns = new Map(channels.map((channel) => [channel, column(points)]));
    offset += PATH_COLUMNS * pathPoints * NUMBER_BYTES;
    lanes.set(name, {name, time, columns, metrics, frozen, accuracy, goals});
  }
  const {revision, estimated, horizon, hold} = head;
  return {revision, estimated, horizon, hold, lanes};
}

/**
 * What a drag doesn't change arrives again with each response: a curve that hasn't moved is known
 * by its column.
 *
 * @param {Response} response
 * @param {Response|null} former
 * @returns {Response} the same, with the former's columns where they are equal
 */
export function withKnownColumns(response, former) {
  for (const [name, lane] of response.lanes) {
    const known = former?.lanes.get(name);
    if (!known) continue;
    if (areEqual(lane.time, known.time)) lane.time = known.time;
    for (const [channel, column] of lane.columns) {
      const before = known.columns.get(channel);
      if (before && areEqual(column, before)) lane.columns.set(channel, before);
    }
  }
  return response;
}

/**
 * @param {Float32Array} one
 * @param {Float32Array} other
 */
function areEqual(one, other) {
  return one.length === other.length
    && one.every((value, index) => Object.is(value, other[index]));
}
