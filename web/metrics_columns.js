// @ts-check
/** What the table of metrics shows: its columns, and how their numbers are written. */

import {written} from './quantity.js';

/**
 * Figures of one lane over one span of time.
 * @typedef {{mae: number[], max_error: number[], max_velocity_error: number[],
 *   chattering: number, peak_torque: number[], flange_rms: number, flange_max: number}} Figures
 */
/**
 * `value` is null where there is none; `joint` says at which joint a greatest value stands.
 * @typedef {{id: string, title: string, unit: string, meaning: string, extra?: boolean,
 *   value: (figures: Figures|null, gamma: number|null) => number|null,
 *   joint?: (figures: Figures) => number, limit?: number}} Column
 */

const MILLI = 1000;
const DIGITS = 3;
const LEAST_PLAIN = 1e-3;
const GREATEST_PLAIN = 1e6;
const FIRST_JOINTS = 3;

/** @param {number[]} values */
function greatest(values) { return Math.max(...values); }

/** @param {number[]} values */
function placeOfGreatest(values) { return values.indexOf(greatest(values)) + 1; }

/** @type {Column[]} */
const MEAN_ERRORS = Array.from({length: 6}, (_, index) => ({
  id: `mae${index + 1}`,
  title: `MAE J${index + 1}`,
  unit: 'mrad',
  meaning: `Mean absolute error of joint ${index + 1}.`,
  extra: index >= FIRST_JOINTS,
  value: (figures) => (figures ? figures.mae[index] * MILLI : null),
}));

/** @type {Column[]} */
export const COLUMNS = [
  ...MEAN_ERRORS,
  {
    id: 'max',
    title: 'max |e|',
    unit: 'mrad',
    meaning: 'Greatest error of any joint.',
    value: (figures) => (figures ? greatest(figures.max_error) * MILLI : null),
    joint: (figures) => placeOfGreatest(figures.max_error),
  },
  {
    id: 'chattering',
    title: 'chattering',
    unit: 'N·m/s',
    meaning: 'How much the torques of all joints move up and down in a second.',
    value: (figures) => figures && figures.chattering,
  },
  {
    id: 'peak',
    title: 'peak τ',
    unit: 'N·m',
    meaning: 'Greatest torque of any joint.',
    value: (figures) => (figures ? greatest(figures.peak_torque) : null),
    joint: (figures) => placeOfGreatest(figures.peak_torque),
  },
  {
    id: 'flange',
    title: 'flange RMS',
    unit: 'mm',
    meaning: 'Root mean square distance of the flange from where it should be.',
    value: (figures) => (figures ? figures.flange_rms * MILLI : null),
  },
  {
    id: 'gamma',
    title: 'margin γ',
    unit: '',
    meaning: 'Largest eigenvalue of h·D·M⁻¹; a sampled loop diverges above 2.',
    value: (_, gamma) => gamma,
    limit: 2,
  },
];

/**
 * @param {number|null|undefined} value
 * @returns {string} three significant digits, or a dash where there is no value
 */
export function threeDigits(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size === 0) return '0';
  if (size >= LEAST_PLAIN && size < GREATEST_PLAIN) {
    const text = value.toPrecision(DIGITS);
    return text.includes('e') ? written(Number(text)) : text.replace('-', '−');
  }
  return value.toExponential(DIGITS - 1).replace('e+', 'e').replaceAll('-', '−');
}

/**
 * The least of a column as it is written, where there is something to compare.
 *
 * @param {(number|null)[]} values
 * @returns {string|null}
 */
export function best(values) {
  const known = values.filter((value) => value !== null);
  const different = new Set(known.map(threeDigits)).size > 1;
  return different ? threeDigits(Math.min(...known)) : null;
}
