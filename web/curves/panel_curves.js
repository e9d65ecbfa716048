// @ts-check
/** The points to draw: each panel's traces over the visible window, thinned to the pixels. */

import {bucketSize, decimated, positions} from './decimate.js';
import {rowsUntil} from './freezes.js';
import {amplitudeSpectrum, thinned} from './spectrum.js';
import {calmOnTop} from './trace_order.js';
import {valuesOf} from './trace_values.js';
import {extent, wanted} from './y_range.js';

/** @typedef {import('./ring.js').Ring} Ring */
/** @typedef {import('../live/views.js').Panel} Panel */
/** @typedef {import('./trace_values.js').Trace} Trace */
/** @typedef {import('./y_range.js').YRanges} YRanges */
/** @typedef {import('./y_range.js').Range} Range */
/** @typedef {{time: number, text: string}} Freeze */
/** @typedef {{x: number, y: number, text: string}} Cross */
/**
 * @typedef {{name?: string, width?: number, dash?: string, opacity?: number, quiet?: boolean,
 *   tone?: 'good'|'bad'|'muted'}} Look `tone`: a colour of the theme in place of the lane's
 */
/**
 * `look` says what the trace's role doesn't, `quiet`: the pointer passes over it; `steps`: each
 * value holds until the next.
 * @typedef {{trace: Pick<Trace, 'lane'|'role'> & {look?: Look}, x: Float64Array|Float32Array,
 *   y: Float64Array|Float32Array, cross: Cross|null,
 *   steps?: boolean}} Curve
 */
/** @typedef {{panel: Panel, curves: Curve[], range: Range}} DrawnPanel */
/**
 * @typedef {{ring: Ring, panels: Panel[], window: Range, pixels: number, ranges: YRanges,
 *   freezes: Map<string, Freeze>, hold?: number}} Sheet `hold`: for so long in [s] a sampled
 *   controller holds a torque, 0 where nothing is sampled
 */

/**
 * Curves over time.
 *
 * @param {Sheet} sheet
 * @returns {DrawnPanel[]}
 */
export function timePanels({ring, panels, window, pixels, ranges, freezes, hold = 0}) {
  const [from, to] = rowsIn(ring, window);
  const size = ring.dt ? bucketSize((window[1] - window[0]) / ring.dt, pixels) : 1;
  const x = positions(from, to, size).map((row) => ring.timeOf(row));
  // The extremes of a bucket are no samples: between them a line is right, a step would be made up.
  const held = size === 1 && isSampledEvery(hold, ring.dt);
  return panels.map((panel) => {
    const curves = panel.traces.map((trace) => {
      const freeze = freezes.get(trace.lane);
      const values = valuesOf(ring, trace, from, rowsUntil(ring, freeze, from, to));
      const cross = freeze ? crossAt(freeze, values, window, ring) : null;
      const steps = held && Boolean(trace.held);
      return {trace, x, y: decimated(values, from, size), cross, steps};
    });
    const range = ranges.linear(panel.id, dataRange(curves, freezes), panel);
    for (const {cross} of curves) if (cross) cross.y = within(cross.y, range);
    return {panel, curves: calmOnTop(curves), range};
  });
}

/**
 * @param {number} hold for so long in [s] a torque is held, 0 where nothing is sampled
 * @param {number} dt between two points in [s]
 * @returns {boolean} whether each point is one sample
 */
export function isSampledEvery(hold, dt) { return hold > 0 && Math.abs(dt / hold - 1) < 1e-3; }

/**
 * @param {{simulation?: {mode: string, control_rate: number}}} experiment
 * @returns {number} for so long in [s] a sampled controller holds a torque, 0 where nothing is sampled
 */
export function holdOf({simulation}) {
  return simulation?.mode === 'sampled' ? 1 / simulation.control_rate : 0;
}

/**
 * Amplitude spectra of the same window.
 *
 * @param {Sheet} sheet
 * @returns {DrawnPanel[]}
 */
export function spectrumPanels({ring, panels, window, pixels, ranges, freezes}) {
  const [from, to] = rowsIn(ring, window);
  return panels.map((panel) => {
    const curves = panel.traces.map((trace) => {
      const freeze = freezes.get(trace.lane);
      const values = valuesOf(ring, trace, from, rowsUntil(ring, freeze, from, to));
      const whole = amplitudeSpectrum(values, ring.dt);
      const {frequency, amplitude} = thinned(whole.frequency, whole.amplitude, pixels);
      return {trace, x: frequency, y: amplitude, cross: null};
    });
    return {panel, curves, range: ranges.logarithmic(panel.id, dataRange(curves, freezes))};
  });
}

/**
 * Rows of a window that the ring keeps.
 *
 * @param {Ring} ring
 * @param {Range} window in [s]
 * @returns {[number, number]} first row, and one past the last
 */
export function rowsIn(ring, [from, to]) {
  if (ring.empty) return [0, 0];
  return [ring.rowAt(from), Math.min(ring.rowAt(to) + 1, ring.end)];
}

/**
 * Where a lane stopped.
 *
 * @param {Freeze} freeze
 * @param {Float32Array} values up to there
 * @param {Range} window
 * @param {Ring} ring
 * @returns {Cross|null} null while that is out of sight
 */
function crossAt({time, text}, values, [from, to], ring) {
  if (!values.length || time < from || time > to || time > ring.newest + ring.dt) return null;
  return {x: time, y: values[values.length - 1], text};
}

/**
 * @param {Curve[]} curves
 * @param {Map<string, Freeze>} freezes
 * @returns {Range}
 */
function dataRange(curves, freezes) {
  const isFrozen = (/** @type {Curve} */ {trace}) => freezes.has(trace.lane);
  const ranges = (/** @type {Curve[]} */ list) => list.map(({y}) => extent(y));
  return wanted(
    ranges(curves.filter((curve) => !isFrozen(curve))), ranges(curves.filter(isFrozen)),
  );
}

/**
 * @param {number} value
 * @param {Range} range
 */
function within(value, [low, high]) { return Math.min(Math.max(value, low), high); }
