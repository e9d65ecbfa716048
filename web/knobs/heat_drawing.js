// @ts-check
/** Draws a strip of figures under a slider's track: colours, hatches, dots, the best position. */

import {fraction} from '../fields/quantity.js';

/** @typedef {import('./study_metric.js').StudyRow} StudyRow */
/** @typedef {import('./study_metric.js').Metric} Metric */
/** @typedef {{left: number, right: number, row: StudyRow|undefined}} Cell in pixels */

/** Height of the whole canvas and of the band in it, in pixels; the best tick takes it all. */
const HEIGHT = 9;
const BAND = {top: 1, height: 6};
/** From the best colour to the worst is this factor at least, and at most. */
const LEAST_SPAN = 1.3;
const GREATEST_SPAN = 30;
const TINY = 1e-12;
/**
 * From good to bad: blue to amber, told apart by every eye. What is good stands out from the page
 * and what is bad fades into it, so that the order of lightness turns with the theme.
 */
const STOPS = {
  light: ['#0a4a86', '#3b7fb3', '#8fb3c0', '#d9cfa3', '#f7dc9c'],
  dark: ['#a6d6ff', '#62a0cf', '#4e7488', '#5c5640', '#4a3613'],
};

/**
 * How good a figure is among the others, on a logarithmic scale.
 *
 * @param {number} figure
 * @param {number} best
 * @param {number} worst
 * @returns {number} 0 for the best, 1 for the worst
 */
export function badness(figure, best, worst) {
  const least = Math.max(best, TINY);
  const span = Math.min(Math.max(worst / least, LEAST_SPAN), GREATEST_SPAN);
  const place = Math.log(Math.max(figure, least) / least) / Math.log(span);
  return Math.min(1, Math.max(0, place));
}

/**
 * The best position of those that came to rest, else of those that chatter.
 *
 * @param {StudyRow[]} rows
 * @param {Metric} metric
 * @returns {StudyRow|undefined}
 */
export function bestOf(rows, {name}) {
  const known = rows.filter((row) => row[name] !== null);
  const calm = known.filter(({state}) => state === 'good');
  const chosen = calm.length ? calm : known;
  return chosen.reduce((/** @type {StudyRow|undefined} */ best, row) => (
    best && Number(best[name]) <= Number(row[name]) ? best : row
  ), undefined);
}

/**
 * Where each position lies along a slider: its piece ends half-way to its neighbours.
 *
 * @param {number} count
 * @param {(StudyRow|undefined)[]} rows
 * @param {{width: number, inset: number}} track the slider's width, half its thumb's
 * @returns {Cell[]}
 */
export function cellsOf(count, rows, {width, inset}) {
  const room = width - 2 * inset;
  const middle = (/** @type {number} */ index) => inset + (room * index) / (count - 1);
  return Array.from({length: count}, (_, index) => ({
    left: index ? middle(index - 0.5) : 0,
    right: index < count - 1 ? middle(index + 0.5) : width,
    row: rows[index],
  }));
}

/**
 * The value that lies at a place of the slider.
 *
 * @param {number} value
 * @param {import('../fields/quantity.js').Scale} scale
 * @param {{width: number, inset: number}} track
 * @returns {number} in pixels from the slider's left end
 */
export function placeOf(value, scale, {width, inset}) {
  return inset + (width - 2 * inset) * fraction(value, scale);
}

/**
 * @param {HTMLCanvasElement} canvas
 * @param {{cells: Cell[], metric: Metric, best: {row: StudyRow, place: number}|null,
 *   ended: boolean, width: number}} strip `ended`: whether all figures are known; a scale of some
 *   would colour all of them anew with each other
 */
export function drawStrip(canvas, {cells, metric, best, ended, width}) {
  const pen = sized(canvas, width);
  const style = getComputedStyle(canvas);
  const color = (/** @type {string} */ name) => style.getPropertyValue(name).trim();
  const dark = document.documentElement.dataset.theme === 'dark';
  const figures = cells.flatMap(({row}) => row?.[metric.name] ?? []);
  const range = [Math.min(...figures), Math.max(...figures)];
  for (const cell of cells) {
    const {row, left, right} = cell;
    const box = /** @type {const} */ ([left, BAND.top, right - left + 0.5, BAND.height]);
    pen.fillStyle = color('--track');
    pen.globalAlpha = row ? 1 : 0.55;
    if (row?.state !== 'refused') pen.fillRect(...box);
    pen.globalAlpha = 1;
    if (!row) continue;
    const figure = row[metric.name];
    if (figure !== null) {
      pen.fillStyle = ended
        ? shade(dark ? STOPS.dark : STOPS.light, badness(figure, range[0], range[1]))
        : color('--border-strong');
      pen.fillRect(...box);
    }
    if (row.state === 'diverged') hatch(pen, box, color('--text-muted'));
    if (row.state === 'chattering') dots(pen, box, color('--surface'), color('--text'));
  }
  if (best) tick(pen, best.place, color('--text'), color('--surface'));
}

/**
 * @param {HTMLCanvasElement} canvas
 * @param {number} width in CSS pixels
 */
function sized(canvas, width) {
  const ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(HEIGHT * ratio);
  canvas.style.width = `${width}px`;
  canvas.style.height = `${HEIGHT}px`;
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  pen.scale(ratio, ratio);
  return pen;
}

/**
 * @param {string[]} stops
 * @param {number} place 0 to 1
 * @returns {string} a color between two stops
 */
function shade(stops, place) {
  const along = place * (stops.length - 1);
  const index = Math.min(Math.floor(along), stops.length - 2);
  const share = along - index;
  const mixed = [1, 3, 5].map((at) => {
    const [from, to] = [stops[index], stops[index + 1]].map((stop) => (
      parseInt(stop.slice(at, at + 2), 16)
    ));
    return Math.round(from + (to - from) * share);
  });
  return `rgb(${mixed.join(' ')})`;
}

/**
 * @param {CanvasRenderingContext2D} pen
 * @param {readonly [number, number, number, number]} box
 * @param {string} color
 */
function hatch(pen, [x, y, width, height], color) {
  pen.save();
  pen.beginPath();
  pen.rect(x, y, width, height);
  pen.clip();
  pen.beginPath();
  // On one grid for all pieces, so that neighbours join without a seam.
  for (let at = Math.floor((x - height) / 4) * 4; at < x + width; at += 4) {
    pen.moveTo(at, y + height);
    pen.lineTo(at + height, y);
  }
  pen.strokeStyle = color;
  pen.lineWidth = 1.1;
  pen.stroke();
  pen.restore();
}

/**
 * @param {CanvasRenderingContext2D} pen
 * @param {readonly [number, number, number, number]} box
 * @param {string} color
 * @param {string} edge
 */
function dots(pen, [x, y, width, height], color, edge) {
  for (let at = Math.ceil(x / 4) * 4; at < x + width - 1; at += 4) {
    pen.beginPath();
    pen.arc(at, y + height / 2, 1.2, 0, 2 * Math.PI);
    pen.fillStyle = color;
    pen.fill();
    pen.strokeStyle = edge;
    pen.lineWidth = 0.6;
    pen.stroke();
  }
}

/**
 * @param {CanvasRenderingContext2D} pen
 * @param {number} place
 * @param {string} color
 * @param {string} halo
 */
function tick(pen, place, color, halo) {
  pen.fillStyle = halo;
  pen.fillRect(place - 2, 0, 4, HEIGHT);
  pen.fillStyle = color;
  pen.fillRect(place - 1, 0, 2, HEIGHT);
}
