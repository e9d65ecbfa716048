// @ts-check
/** The numbers of one trace, worked out from the columns that arrive. */

/** @typedef {import('./ring.js').Ring} Ring */
/**
 * How a trace's value follows from its columns: as it is; the first less the second (q = q_d - e);
 * or the distance of the first three from the last three.
 * @typedef {'value'|'difference'|'distance'} Rule
 */
/**
 * `role`: another than these two begins with `baseline`. `held`: a sampled controller holds it from
 * one sample to the next.
 * @typedef {{lane: string, role: 'actual'|'desired'|string, label: string, places: number[],
 *   rule: Rule, scale: number, held?: boolean}} Trace
 */

/**
 * @param {Ring} ring
 * @param {Trace} trace
 * @param {number} from first row
 * @param {number} to one past the last row
 * @returns {Float32Array} Shape (to - from,), in the trace's unit; NaN where nothing arrived.
 */
export function valuesOf(ring, trace, from, to) {
  const columns = trace.places.map((place) => ring.copy(place, from, to));
  if (trace.rule === 'difference') return difference(columns[0], columns[1]);
  if (trace.rule === 'distance') return distance(columns, trace.scale);
  return columns[0];
}

/**
 * @param {Float32Array} left becomes the result
 * @param {Float32Array} right
 */
function difference(left, right) {
  for (let row = 0; row < left.length; row += 1) left[row] -= right[row];
  return left;
}

/**
 * @param {Float32Array[]} columns x, y, z and x, y, z
 * @param {number} scale
 */
function distance([x, y, z, ...desired], scale) {
  for (let row = 0; row < x.length; row += 1) {
    const dx = x[row] - desired[0][row];
    const dy = y[row] - desired[1][row];
    const dz = z[row] - desired[2][row];
    x[row] = scale * Math.sqrt(dx * dx + dy * dy + dz * dz);
  }
  return x;
}
