// @ts-check
/** What the table of metrics shows: its columns, and how their numbers are written. */

import {written} from '../fields/quantity.js';

/**
 * Figures of one lane over one span of time.
 * @typedef {{mae: number[], max_error: number[], max_velocity_error: number[],
 *   chattering: number, peak_torque: number[], flange_rms: number, flange_max: number}} Figures
 */
/**
 * How a sampled loop stands: the spectral radius of one control period, γ, and the γ at which this
 * very loop leaves its border. Numbers are null where there are none (no γ for sign and power).
 * @typedef {{stable: boolean, radius: number|null, bounded: boolean, gamma: number|null,
 *   gamma_limit: number|null}} Margin
 */
/**
 * `value` is null where there is none; `joint` says at which joint a greatest value stands.
 * @typedef {{id: string, title: string, unit: string, meaning: string, extra?: boolean,
 *   value: (figures: Figures|null, margin: Margin|null) => number|null,
 *   joint?: (figures: Figures) => number, isMargin?: boolean}} Column
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
    title: 'γ / border',
    unit: '',
    meaning: 'Largest eigenvalue of T·D·M⁻¹, and where this loop leaves its border when its reaching '
      + 'gains grow. The condition itself is ρ < 1: the spectral radius of one control period.',
    value: (_, margin) => margin?.gamma ?? null,
    isMargin: true,
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
 * @param {Margin|null} margin
 * @returns {string} γ and its border, or ρ where there is no γ; sign(S) has neither, nor an end
 */
export function marginText(margin) {
  if (!margin) return '–';
  if (margin.gamma !== null) {
    return `${threeDigits(margin.gamma)} / ${margin.gamma_limit ? threeDigits(margin.gamma_limit) : '–'}`;
  }
  return margin.radius === null ? '∞' : `ρ ${margin.radius.toPrecision(DIGITS + 1)}`;
}

/**
 * @param {Margin|null} margin
 * @returns {string} what the cell says when it is pointed at
 */
export function marginWords(margin) {
  if (!margin) return 'only a sampled loop has a margin';
  const {radius, stable, bounded} = margin;
  if (radius === null) return bounded
    ? 'the gain of sign(S) at the surface has no bound: it always chatters'
    : 'the gain of sign(S) at the surface has no bound: it diverges';
  const rho = `ρ = ${radius.toPrecision(DIGITS + 2)}`;
  if (stable) return `${rho}: small deviations die out`;
  return `${rho}, above 1: ${bounded ? 'a limit cycle' : 'the sampled loop diverges'}`;
}

/**
 * @param {Margin|null} margin
 * @returns {boolean} whether it deserves a warning; that sign(S) chatters is no news
 */
export function marginWarns(margin) {
  return margin !== null && !margin.stable && (margin.radius !== null || !margin.bounded);
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
