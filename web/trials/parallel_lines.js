// @ts-check
/** Draws the lines and axes of parallel coordinates, and finds the line at a place. */

/** @typedef {import('./plot_frame.js').Colors} Colors */
/** @typedef {import('./parallel_axes.js').ParallelAxis} ParallelAxis */
/** @typedef {import('./parallel_axes.js').Brush} Brush */
/** @typedef {import('./parallel.js').Box} Box */

/** So many colours from the best trials to the worst; one stroke each. */
const SHADES = 12;
const FONT = 11;
/** As far from a line in pixels a pointer still means it. */
const NEAR = 8;
const BRUSH_WIDTH = 10;

/**
 * @param {CanvasRenderingContext2D} pen
 * @param {Colors} colors
 * @param {Box} box
 * @param {ParallelAxis[]} axes
 * @param {boolean[]} passes of each line, the worst trial's first
 * @param {[string, number][]} marked lines by what they are
 * @param {Map<string, Brush>} brushes
 */
export function drawLines(pen, colors, box, axes, passes, marked, brushes) {
  const count = passes.length;
  const of = (/** @type {number} */ shade) => (
    passes.map((_, at) => at).filter((at) => Math.floor((SHADES * at) / count) === shade)
  );
  Object.assign(pen, {lineWidth: 1, globalAlpha: 0.06, strokeStyle: colors.muted});
  stroke(pen, box, axes, passes.map((_, at) => at).filter((at) => !passes[at]));
  for (let shade = 0; shade < SHADES; shade += 1) {
    const share = (shade + 1) / SHADES;
    pen.globalAlpha = 0.12 + 0.73 * share ** 2;
    pen.strokeStyle = mixed(colors.muted, colors.accent, share);
    stroke(pen, box, axes, of(shade).filter((at) => passes[at]));
  }
  pen.globalAlpha = 1;
  for (const [mark, at] of marked) {
    pen.strokeStyle = mark === 'best' ? colors.good : colors.text;
    pen.lineWidth = 2.2;
    pen.setLineDash(mark === 'present' ? [2, 3] : mark === 'focused' ? [5, 3] : []);
    stroke(pen, box, axes, [at]);
  }
  pen.setLineDash([]);
  axes.forEach((axis, at) => drawAxis(pen, colors, box, axis, at, brushes.get(axis.id)));
}

/**
 * @param {CanvasRenderingContext2D} pen
 * @param {Box} box
 * @param {ParallelAxis[]} axes
 * @param {number[]} lines
 */
function stroke(pen, box, axes, lines) {
  pen.beginPath();
  for (const line of lines) {
    axes.forEach((axis, at) => {
      const [x, y] = placeOf(box, axis, at, line);
      if (at) pen.lineTo(x, y);
      else pen.moveTo(x, y);
    });
  }
  pen.stroke();
}

/**
 * @param {CanvasRenderingContext2D} pen
 * @param {Colors} colors
 * @param {Box} box
 * @param {ParallelAxis} axis
 * @param {number} at
 * @param {Brush|undefined} brush
 */
function drawAxis(pen, colors, {left, gap, top, height}, axis, at, brush) {
  const x = left + at * gap;
  Object.assign(pen, {strokeStyle: colors.muted, lineWidth: 1.2, fillStyle: colors.text});
  pen.beginPath();
  pen.moveTo(x, top);
  pen.lineTo(x, top + height);
  pen.stroke();
  pen.font = `600 ${FONT + 1}px ${colors.font}`;
  pen.textAlign = 'center';
  pen.textBaseline = 'alphabetic';
  pen.fillText(axis.label, x, top - 12, gap - 4);
  pen.font = `${FONT - 1}px ${colors.font}`;
  pen.textAlign = 'right';
  pen.textBaseline = 'middle';
  Object.assign(pen, {lineWidth: 3, strokeStyle: colors.background, fillStyle: colors.muted});
  for (const {along, text} of axis.ticks) {
    const y = top + (1 - along) * height;
    // Legible over the lines.
    pen.strokeText(text, x - 5, y);
    pen.fillText(text, x - 5, y);
  }
  if (!brush) return;
  const [low, high] = brush.map((end) => top + (1 - axis.along(end)) * height);
  Object.assign(pen, {globalAlpha: 0.35, fillStyle: colors.accent});
  pen.fillRect(x - BRUSH_WIDTH / 2, high, BRUSH_WIDTH, low - high);
  Object.assign(pen, {globalAlpha: 1, strokeStyle: colors.accent, lineWidth: 1.2});
  pen.strokeRect(x - BRUSH_WIDTH / 2, high, BRUSH_WIDTH, low - high);
}

/**
 * @param {Box} box
 * @param {ParallelAxis} axis
 * @param {number} at which axis it is
 * @param {number} line
 * @returns {[number, number]} in pixels
 */
function placeOf({left, gap, top, height}, axis, at, line) {
  return [left + at * gap, top + (1 - axis.along(axis.values[line])) * height];
}

/**
 * @param {Box} box
 * @param {ParallelAxis[]} axes
 * @param {number} x in pixels
 * @param {number} y
 * @param {(line: number) => boolean} passes
 * @returns {number|null} the nearest line there; of equals the better trial's
 */
export function linesAt(box, axes, x, y, passes) {
  const first = Math.floor((x - box.left) / box.gap);
  if (first < 0 || first >= axes.length - 1) return null;
  const share = (x - box.left) / box.gap - first;
  let nearest = null;
  let least = NEAR;
  for (let line = 0; line < axes[0].values.length; line += 1) {
    if (!passes(line)) continue;
    const [[, from], [, to]] = [first, first + 1].map((at) => placeOf(box, axes[at], at, line));
    const distance = Math.abs(from + share * (to - from) - y);
    if (distance <= least) { least = distance; nearest = line; }
  }
  return nearest;
}

/**
 * @param {string} from `#rrggbb`
 * @param {string} to
 * @param {number} share 0 to 1
 */
function mixed(from, to, share) {
  const parts = (/** @type {string} */ color) => [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16));
  const [low, high] = [parts(from), parts(to)];
  return `rgb(${low.map((one, at) => Math.round(one + share * (high[at] - one))).join(' ')})`;
}
