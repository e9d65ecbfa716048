// @ts-check
/** What the live session shows for a figure that a lesson quotes, over the same window. */

import {JOINTS} from '../api/arm.js';
import {amplitudeSpectrum} from '../curves/spectrum.js';

/** @typedef {import('./lesson_document.js').LessonFigure} Figure */
/** @typedef {import('../curves/ring.js').Ring} Ring */

const AXES = ['x', 'y', 'z'];
/** Way back of the torque in [N·m] that makes a reversal, as the server has it. */
const DEADBAND = 0.01;
/** A Hann window shows a sine in three bins: by so much their powers are more than its own. */
const HANN_BINS = 1.5;

/**
 * In SI units.
 * @typedef {(figure: Figure, columns: (group: string) => Float32Array[], ring: Ring) => number} Rule
 */

/** @type {{[metric: string]: Rule}} */
const RULES = {
  mean_error: (figure, columns) => ofJoint(figure, columns('e').map(meanSize)),
  max_error: (figure, columns) => ofJoint(figure, columns('e').map(greatest)),
  error_at: (figure, columns) => (
    ofJoint(figure, columns('e').map((e) => Math.abs(e[e.length - 1])))
  ),
  peak_torque: (figure, columns) => ofJoint(figure, columns('tau').map(greatest)),
  chattering: (_, columns, {dt}) => sum(columns('tau').map((tau) => way(tau) / ((tau.length - 1) * dt))),
  switches: (figure, columns, {dt}) => ofJoint(figure, columns('tau').map((tau) => (
    reversals(tau) / ((tau.length - 1) * dt)
  ))),
  rms_torque: (figure, columns) => ofJoint(figure, columns('tau').map((tau) => (
    Math.sqrt(sum(tau.map((value) => value * value)) / tau.length)
  ))),
  sign_changes: (figure, columns) => ofJoint(figure, columns('S').map(sidesChanged)),
  reaching_time: (figure, columns, {dt}) => ofJoint(figure, columns('S').map((S, index) => (
    figure.since + dt * reachedRow(S, figure.layer[index])
  ))),
  high_frequency_torque: ({high_frequency: bound}, columns, {dt}) => Math.sqrt(sum(columns('tau').map((tau) => {
    const {frequency, amplitude} = amplitudeSpectrum(tau, dt);
    return sum([...amplitude].filter((__, bin) => frequency[bin] >= bound)
      .map((size) => (size * size) / 2 / HANN_BINS));
  }))),
  flange_rms: (_, columns) => {
    const squares = distances(columns);
    return Math.sqrt(sum(squares) / squares.length);
  },
  flange_max: (_, columns) => Math.sqrt(greatest(distances(columns))),
};

/**
 * @param {Ring} ring
 * @param {Figure} figure one that belongs to a time
 * @returns {{value: number, whole: boolean}|null} `value`: in the figure's unit; `whole`: the window
 *   has passed; null where it hasn't begun, or its begin isn't kept
 */
export function measured(ring, figure) {
  const rule = RULES[figure.metric];
  const instant = figure.at !== null;
  const [since, until] = instant ? [Number(figure.at), Number(figure.at)] : [figure.since, figure.until];
  if (!rule || ring.empty || ring.newest < since + ring.dt) return null;
  if (ring.timeOf(ring.start) > since + 1e-6) return null;
  const from = ring.rowAt(since);
  const to = Math.min(ring.rowAt(until) + 1, ring.end);
  const columns = (/** @type {string} */ group) => {
    const shared = group === 'flange_d';
    const parts = shared || group === 'flange' ? AXES : JOINTS;
    return parts.map((part) => {
      const place = ring.place(shared ? '' : figure.lane, group, part);
      return place < 0 ? new Float32Array(to - from).fill(NaN) : ring.copy(place, from, to);
    });
  };
  const value = figure.factor * rule(figure, columns, ring);
  return Number.isNaN(value) ? null : {value, whole: ring.newest >= until};
}

/**
 * @param {Figure} figure
 * @param {number[]} values of the joints
 */
function ofJoint({joint, reduced}, values) {
  if (joint !== null) return values[joint - 1];
  return reduced === 'greatest' ? Math.max(...values) : sum(values) / values.length;
}

/** @param {ArrayLike<number>} values */
function sum(values) {
  let total = 0;
  for (let index = 0; index < values.length; index += 1) total += values[index];
  return total;
}

/** @param {ArrayLike<number>} values */
function meanSize(values) {
  let total = 0;
  for (let index = 0; index < values.length; index += 1) total += Math.abs(values[index]);
  return total / values.length;
}

/** @param {ArrayLike<number>} values */
function greatest(values) {
  let most = 0;
  for (let index = 0; index < values.length; index += 1) {
    const size = Math.abs(values[index]);
    if (!(size <= most)) most = size;
  }
  return most;
}

/** @param {ArrayLike<number>} values */
function way(values) {
  let total = 0;
  for (let index = 1; index < values.length; index += 1) {
    total += Math.abs(values[index] - values[index - 1]);
  }
  return total;
}

/** @param {Float32Array} values NaN where rows are missing, and then so is the count */
function reversals(values) {
  let [count, direction, highest, lowest] = [0, 0, -Infinity, Infinity];
  for (const value of values) {
    if (Number.isNaN(value)) return NaN;
    highest = Math.max(highest, value);
    lowest = Math.min(lowest, value);
    const turn = direction >= 0 && value < highest - DEADBAND ? -1
      : Number(direction <= 0 && value > lowest + DEADBAND);
    if (turn) {
      if (direction) count += 1;
      [direction, highest, lowest] = [turn, value, value];
    }
  }
  return count;
}

/** @param {ArrayLike<number>} values */
function sidesChanged(values) {
  let changes = 0;
  for (let index = 1; index < values.length; index += 1) {
    if (values[index] > 0 !== values[index - 1] > 0) changes += 1;
  }
  return changes / (values.length - 1);
}

/**
 * @param {ArrayLike<number>} S
 * @param {number} layer
 * @returns {number} the first row within the layer or beyond zero
 */
function reachedRow(S, layer) {
  for (let index = 0; index < S.length; index += 1) {
    if (Math.abs(S[index]) <= layer || S[index] * S[0] < 0) return index;
  }
  return Infinity;
}

/**
 * @param {(group: string) => Float32Array[]} columns
 * @returns {Float32Array} squares of the flange's distances from where it should be
 */
function distances(columns) {
  const [actual, desired] = [columns('flange'), columns('flange_d')];
  return actual[0].map((_, row) => (
    sum(actual.map((axis, index) => (axis[row] - desired[index][row]) ** 2))
  ));
}
