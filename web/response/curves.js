// @ts-check
/** The points of whole responses to draw: each lane's current one over those it is compared with. */

import {isSampledEvery} from '../curves/panel_curves.js';
import {calmOnTop} from '../curves/trace_order.js';
import {dashOf} from '../logs/look.js';
import {extent, wanted} from '../curves/y_range.js';
import {boundsOf} from '../bounds/bounds.js';

/** @typedef {import('../api/preview_message.js').LaneResponse} LaneResponse */
/** @typedef {import('../api/preview_message.js').Response} Response */
/** @typedef {import('./views.js').ResponsePanel} ResponsePanel */
/** @typedef {import('../curves/panel_curves.js').Curve} Curve */
/** @typedef {import('../curves/panel_curves.js').DrawnPanel} DrawnPanel */
/** @typedef {import('../curves/y_range.js').Range} Range */
/** @typedef {{id: number, name: string, response: Response}} Pinned */
/** @typedef {{number: number, name: string, overlay: import('../api/requests/logs.js').Overlay}} Logged */
/** @typedef {{lane: LaneResponse, curve: Curve}} Traced */
/**
 * `lanes`: those to show, of the live experiment and, where only a baseline has them, others;
 * `logs`: of the real arm; `before`: the one before the last change; `goals`: those of the experiment.
 * @typedef {{panels: ResponsePanel[], current: Response|null, pinned: Pinned[], logs: Logged[],
 *   before: Response|null, goals: {[name: string]: import('../goals/words.js').Goal},
 *   shows: (lane: string) => boolean, window: Range}} ResponseSheet
 */

const BASELINE_WIDTH = 1;
/** Of several baselines the later are fainter. */
const STRONGEST = 0.95;
const FAINTER = 0.25;
const FAINTEST = 0.4;
const DASHES = '6px,4px';
/** Solid as the present, but a broad shadow behind it. */
const BEFORE = {width: 4, opacity: 0.4, quiet: true};
const LOG_WIDTH = 1.7;
/** How far these two may stretch a range: the present curves keep a fifth of the height. Ours. */
const BEFORE_STRETCH = 4;
/** The same of a goal's bound: the curves keep a quarter. Ours. */
const BOUND_STRETCH = 3;
/** @type {WeakMap<Float32Array, Float32Array>} columns in the units that are shown */
const scaled = new WeakMap();

/**
 * @param {ResponseSheet} sheet
 * @param {import('../curves/y_range.js').YRanges} ranges
 * @returns {DrawnPanel[]}
 */
export function responsePanels(sheet, ranges) {
  return sheet.panels.map((panel) => {
    const {now, then, before, logged} = tracesOf(sheet, panel);
    const over = (/** @type {Traced[]} */ list) => calmOnTop(list.map(({curve}) => curve));
    const bounds = boundsOf(sheet.goals, panel, sheet.current, sheet.shows);
    const curves = [...over(before), ...over(then), ...over(now), ...over(logged), ...bounds.map(boundCurve)];
    const data = dataRange([...then, ...now], [...before, ...logged], sheet.window);
    const range = ranges.linear(panel.id, withBounds(data, bounds), panel);
    for (const {cross} of curves) {
      if (cross) cross.y = Math.min(Math.max(cross.y, range[0]), range[1]);
    }
    return {panel: {...panel, traces: []}, curves, range};
  });
}

/**
 * @param {import('../bounds/bounds.js').Bound} bound
 * @param {number} index
 * @returns {Curve}
 */
function boundCurve({name, x, y, kept}, index) {
  const tone = kept === null ? 'muted' : kept ? 'good' : 'bad';
  // Its colour is part of what it is: the plot is drawn anew where that changes.
  const trace = {lane: '', role: `bound${index}${tone}`, look: {
    name, width: 1.6, dash: '7px,3px', tone: /** @type {'good'} */ (tone), quiet: true,
  }};
  return {trace, x, y, cross: null};
}

/**
 * @param {Range} range
 * @param {import('../bounds/bounds.js').Bound[]} bounds
 * @returns {Range} with the bounds in it, unless they would flatten the curves
 */
function withBounds(range, bounds) {
  return wanted([range], bounds.map(({y}) => /** @type {Range} */ ([y[0], y[0]])), BOUND_STRETCH);
}

/**
 * What every visible trace says at a moment.
 *
 * @param {ResponseSheet} sheet
 * @param {number} time in [s]
 * @returns {import('../plot_view/cursors.js').Reading[]}
 */
export function responseReadings(sheet, time) {
  return sheet.panels.flatMap((panel) => {
    const {now, then, logged} = tracesOf(sheet, panel);
    return [...now, ...then, ...logged].map(({lane, curve: {trace, y, steps}}) => ({
      lane: trace.lane, label: trace.look?.name ?? trace.lane,
      panel: `${panel.title} ${panel.quantity}`, unit: panel.unit,
      value: valueAt(lane.time, y, time, steps),
    }));
  });
}

/**
 * @param {ResponseSheet} sheet
 * @param {ResponsePanel} panel
 * @returns {{now: Traced[], then: Traced[], before: Traced[], logged: Traced[]}} of the current
 *   response, of the baselines, of the response before the last change, and of logs
 */
function tracesOf({current, pinned, logs, before, shows}, panel) {
  const drawn = (/** @type {Response} */ response, /** @type {(lane: string) => object} */ how) => (
    [...response.lanes.values()].filter(({name}) => shows(name))
      .map((lane) => ({lane, curve: curveOf(lane, panel, how(lane.name), response.hold)}))
  );
  return {
    now: current ? drawn(current, (name) => ({role: 'actual', look: {name}})) : [],
    then: pinned.flatMap(({id, name, response}, index) => drawn(response, (lane) => ({
      role: `baseline${id}`,
      look: {
        name: `${lane} · ${name}`, width: BASELINE_WIDTH, dash: DASHES,
        opacity: Math.max(FAINTEST, STRONGEST - FAINTER * index),
      },
    }))),
    before: before ? drawn(before, (lane) => ({
      role: 'before', look: {...BEFORE, name: `${lane} · before the last change`},
    })).map(({lane, curve}) => ({lane, curve: {...curve, cross: null}})) : [],
    // A log is nobody's lane, whatever its file is called.
    logged: logs.flatMap(({number, name, overlay: {response}}, index) => (
      [...response.lanes.values()].map((lane) => ({lane, curve: curveOf(lane, panel, {
        lane: '', role: `log${number}`,
        look: {name, width: LOG_WIDTH, dash: dashOf(index).dash, tone: 'muted'},
      }, 0)}))
    )),
  };
}

/**
 * @param {LaneResponse} lane
 * @param {ResponsePanel} panel
 * @param {object} how role and look
 * @param {number} hold for so long in [s] a torque is held, 0 where nothing is sampled
 * @returns {Curve}
 */
function curveOf({name, time, columns, frozen}, {channel, scale, held = false}, how, hold) {
  const column = columns.get(channel) ?? new Float32Array(time.length).fill(NaN);
  const y = inUnits(column, scale);
  const cross = frozen && {x: frozen.time, y: lastFinite(y), text: frozen.cause};
  const trace = /** @type {Curve['trace']} */ ({lane: name, ...how});
  // A long run arrives thinned to its extremes, which are no samples any more.
  const steps = held && isSampledEvery(hold, (time[time.length - 1] - time[0]) / (time.length - 1));
  return {trace, x: time, y, cross: cross && Number.isFinite(cross.y) ? cross : null, steps};
}

/**
 * @param {Float32Array} column of which every panel has the same scale
 * @param {number} scale
 * @returns {Float32Array} the same one every time: a curve that hasn't moved is known by it
 */
function inUnits(column, scale) {
  if (scale === 1) return column;
  const known = scaled.get(column) ?? column.map((value) => value * scale);
  scaled.set(column, known);
  return known;
}

/** @param {ArrayLike<number>} values */
function lastFinite(values) {
  let last = values.length - 1;
  while (last > 0 && !Number.isFinite(values[last])) last -= 1;
  return values[last];
}

/**
 * What was is seen whole, unless it would flatten what is; a lane that ran away is not.
 *
 * @param {Traced[]} traces
 * @param {Traced[]} before
 * @param {Range} window
 * @returns {Range}
 */
function dataRange(traces, before, [from, to]) {
  const seen = (/** @type {Traced[]} */ list) => list.map(({lane, curve}) => extent(
    /** @type {Float32Array} */ (curve.y).subarray(
      Math.max(0, rowAt(lane.time, from) - 1), rowAt(lane.time, to) + 1,
    ),
  ));
  const apart = (/** @type {Traced[]} */ list) => Object.groupBy(list, ({lane}) => (
    lane.frozen ? 'frozen' : 'running'
  ));
  const {running = [], frozen = []} = apart(traces);
  const {running: ran = [], frozen: away = []} = apart(before);
  const present = wanted(seen(running.length ? running : ran), seen([...frozen, ...away]));
  return wanted([present], seen(ran), BEFORE_STRETCH);
}

/**
 * @param {ArrayLike<number>} times rising
 * @param {number} time
 * @returns {number} the first row at or after a time, or how many there are
 */
function rowAt(times, time) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < time) low = middle + 1;
    else high = middle;
  }
  return low;
}

/**
 * @param {ArrayLike<number>} times rising
 * @param {ArrayLike<number>} values
 * @param {number} time
 * @param {boolean} [steps] whether each value holds until the next
 * @returns {number|null} on the line between two points, null where there is none
 */
export function valueAt(times, values, time, steps = false) {
  const right = rowAt(times, time);
  if (right >= times.length || (right === 0 && times[0] > time)) return null;
  const left = Math.max(0, right - 1);
  const span = times[right] - times[left];
  const share = steps && time < times[right] ? 0 : span > 0 ? (time - times[left]) / span : 1;
  const value = values[left] + share * (values[right] - values[left]);
  return Number.isFinite(value) ? value : null;
}
