// @ts-check
/** The binary message of telemetry. */

/**
 * Telemetry: `data[column * rows + row]`, columns in the order of the channels.
 * @typedef {{revision: number, rows: number, columns: number, dropped: number, time: number,
 *   dt: number, data: Float32Array}} Frame
 */

const HEADER_BYTES = 32;

/**
 * @param {ArrayBuffer} buffer
 * @returns {Frame}
 */
export function decoded(buffer) {
  const view = new DataView(buffer);
  const [revision, rows, columns, dropped] = [0, 4, 8, 12].map((at) => view.getUint32(at, true));
  const data = new Float32Array(buffer, HEADER_BYTES, rows * columns);
  const [time, dt] = [view.getFloat64(16, true), view.getFloat64(24, true)];
  return {revision, rows, columns, dropped, time, dt, data};
}
