// @ts-check
/**
 * Moves the curves of a graph that is drawn already, without the plotting library.
 *
 * The library works out everything anew for other points on the same axes, which takes five times
 * as long. What is drawn here it doesn't know of: hovering and zooming are right again after its
 * next redraw.
 */

/** @typedef {import('./redraw.js').Figure['data']} Traces */
/**
 * An axis as the library has it: its values, and how many pixels they take.
 * @typedef {{range: [number, number], _length: number}} Axis
 */

/** @typedef {Map<string, {x: ArrayLike<number>, y: ArrayLike<number>}>} Drawn by the traces' ids */

/** Farther out of sight than this in pixels a point only costs digits. */
const FAR = 1e5;

/**
 * @param {HTMLElement} graph drawn by the library, with the same traces at other points
 * @param {Traces} traces on linear axes
 * @param {Drawn} drawn the points that stand there now; what is compared with stays as it is
 * @returns {boolean} whether all of them could be moved; if not, none was
 */
export function movedCurves(graph, traces, drawn) {
  const {data, _fullLayout: layout} = /** @type {any} */ (graph);
  /** @type {[Element, any][]} */ const moves = [];
  for (const [index, trace] of traces.entries()) {
    if (trace.mode !== 'lines') {
      if (!samePoints(trace, data[index])) return false;
      continue;
    }
    const {x, y} = drawn.get(trace.uid) ?? {};
    if (trace.x === x && trace.y === y) continue;
    const lines = graph.querySelectorAll(`.trace${CSS.escape(trace.uid)} .js-line`);
    // Where a curve was interrupted, or had no points, the library has other paths than one.
    if (lines.length !== 1) return false;
    moves.push([lines[0], trace]);
  }
  /** @type {Map<ArrayLike<number>, string[]>} */ const across = new Map();
  for (const [line, {x, y, xaxis, yaxis, line: {shape}}] of moves) {
    const texts = across.get(x) ?? placesAcross(layout[axisName(xaxis)], x);
    across.set(x, texts);
    line.setAttribute('d', path(texts, layout[axisName(yaxis)], y, shape === 'hv'));
  }
  return true;
}

/**
 * @param {any} trace
 * @param {any} drawn
 */
function samePoints(trace, drawn) {
  return String(trace.x) === String(drawn.x) && String(trace.y) === String(drawn.y);
}

/** @param {string} id such as `y2` */
function axisName(id) { return `${id[0]}axis${id.slice(1)}`; }

/**
 * @param {Axis} axis
 * @param {ArrayLike<number>} values
 * @returns {string[]} where they lie, in pixels
 */
export function placesAcross({range: [from, to], _length: length}, values) {
  const scale = length / (to - from);
  return Array.from(values, (value) => String(rounded(scale * (value - from))));
}

/**
 * @param {string[]} across
 * @param {Axis} axis
 * @param {ArrayLike<number>} values NaN interrupts the line
 * @param {boolean} steps whether each value holds until the next
 * @returns {string} of an SVG path
 */
export function path(across, {range: [low, high], _length: length}, values, steps) {
  const scale = length / (high - low);
  let text = '';
  let pen = 'M';
  for (let index = 0; index < across.length; index += 1) {
    const place = scale * (high - values[index]);
    if (Number.isNaN(place)) {
      pen = 'M';
    } else {
      const down = rounded(Math.min(FAR, Math.max(-FAR, place)));
      text += pen === 'L' && steps ? `H${across[index]}V${down}` : `${pen}${across[index]},${down}`;
      pen = 'L';
    }
  }
  return text || 'M0,0';
}

/** @param {number} pixels */
function rounded(pixels) { return Math.round(100 * pixels) / 100; }
