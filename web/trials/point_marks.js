// @ts-check
/** Draws the points of trials onto a canvas: a shape and a colour for each fate. */

/** @typedef {import('./plot_frame.js').Colors} Colors */
/** @typedef {import('./trials.js').Fate} Fate */
/** @typedef {CanvasRenderingContext2D} Pen */

const RADIUS = 3.2;
const FAINT = 0.15;

/**
 * @param {Colors} colors
 * @param {Fate} fate
 * @returns {string}
 */
export function colorOfFate(colors, fate) {
  return {
    kept: colors.accent, missed: colors.warning, diverged: colors.bad, refused: colors.bad,
    beaten: colors.muted, louder: colors.warning,
  }[fate];
}

/** @type {{[fate in Fate]: (pen: Pen, x: number, y: number, r: number) => void}} */
const SHAPES = {
  kept: (pen, x, y, r) => { pen.arc(x, y, r, 0, 2 * Math.PI); pen.fill(); },
  missed: (pen, x, y, r) => {
    pen.moveTo(x, y - 1.3 * r);
    pen.lineTo(x + 1.2 * r, y + r);
    pen.lineTo(x - 1.2 * r, y + r);
    pen.closePath();
    pen.fill();
  },
  diverged: (pen, x, y, r) => {
    pen.moveTo(x - r, y - r);
    pen.lineTo(x + r, y + r);
    pen.moveTo(x + r, y - r);
    pen.lineTo(x - r, y + r);
    pen.stroke();
  },
  refused: (pen, x, y, r) => { pen.rect(x - r, y - r, 2 * r, 2 * r); pen.stroke(); },
  louder: (pen, x, y, r) => {
    pen.moveTo(x, y + 1.3 * r);
    pen.lineTo(x + 1.2 * r, y - r);
    pen.lineTo(x - 1.2 * r, y - r);
    pen.closePath();
    pen.fill();
  },
  beaten: (pen, x, y, r) => { pen.arc(x, y, 0.8 * r, 0, 2 * Math.PI); pen.stroke(); },
};

/**
 * @param {Pen} pen
 * @param {Colors} colors
 * @param {Fate} fate
 * @param {number} x
 * @param {number} y
 * @param {boolean} [faint]
 */
export function drawPoint(pen, colors, fate, x, y, faint = false) {
  const color = colorOfFate(colors, fate);
  Object.assign(pen, {fillStyle: color, strokeStyle: color, lineWidth: 1.6});
  pen.globalAlpha = faint ? FAINT : 0.85;
  pen.beginPath();
  SHAPES[fate](pen, x, y, RADIUS);
  pen.globalAlpha = 1;
}

/** @typedef {'present'|'best'|'front'|'chosen'|'focused'} Mark */

/**
 * @param {Pen} pen
 * @param {Colors} colors
 * @param {Mark} mark
 * @param {number} x
 * @param {number} y
 */
export function drawMark(pen, colors, mark, x, y) {
  const radius = {present: 6, best: 7, front: 5.5, chosen: 8, focused: 10}[mark];
  const strong = mark === 'best' || mark === 'front';
  pen.strokeStyle = strong ? colors.good : colors.text;
  pen.lineWidth = mark === 'front' ? 1.2 : 2;
  pen.setLineDash(mark === 'focused' ? [3, 2] : []);
  pen.beginPath();
  if (mark === 'present') {
    for (const [dx, dy] of [[0, -1], [1, 0], [0, 1], [-1, 0]]) {
      pen.lineTo(x + dx * radius, y + dy * radius);
    }
    pen.closePath();
  } else pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.stroke();
  pen.setLineDash([]);
}

/**
 * A line that keeps its height until its next point; broken where there is no place.
 *
 * @param {Pen} pen
 * @param {Colors} colors
 * @param {[number, number][]} points in pixels
 */
export function drawSteps(pen, colors, points) {
  Object.assign(pen, {strokeStyle: colors.good, lineWidth: 1.8});
  pen.beginPath();
  points.forEach(([x, y], at) => {
    const [, before] = points[at - 1] ?? [NaN, NaN];
    if (Number.isNaN(before)) pen.moveTo(x, y);
    else {
      pen.lineTo(x, before);
      pen.lineTo(x, y);
    }
  });
  pen.stroke();
}
