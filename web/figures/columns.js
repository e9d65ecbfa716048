// @ts-check
/** What the tables of figures show: their columns, and how their numbers are written. */

import {JOINTS, unitAt} from '../api/arm.js';
import {FIGURES, figureOf} from './figure.js';
import {written} from '../fields/quantity.js';

/** @typedef {import('./figure.js').Figure} Figure */
/**
 * Figures of one lane over one span of time, by name; lists are by joint.
 * @typedef {{[name: string]: any}} Figures
 */
/**
 * How a sampled loop stands: the spectral radius of one control period, γ, and the γ at which this
 * very loop becomes unstable. Numbers are null where there are none (no γ for sign and power).
 * @typedef {{stable: boolean, radius: number|null, bounded: boolean, gamma: number|null,
 *   gamma_limit: number|null}} Margin
 */
/**
 * `value` is as it is shown, null where there is none; `joint` says at which joint a greatest value
 * stands; `extra` columns are those of the wrist, and of figures that say they are.
 * @typedef {{id: string, figure: Figure, title: string, unit: string, meaning: string,
 *   value: (figures: Figures|null, margin: Margin|null) => number|null,
 *   of?: number, extra?: boolean, joint?: (figures: Figures) => number, isMargin?: boolean}} Column
 */

const DIGITS = 3;
const LEAST_PLAIN = 1e-3;
const GREATEST_PLAIN = 1e6;
const FIRST_JOINTS = 3;
const [GAMMA, LIMIT, RADIUS] = ['gamma', 'gamma_limit', 'radius'].map(figureOf);

/** @type {Column[]} */
export const COLUMNS = FIGURES.filter(({column}) => column).flatMap(columnsOf);

/**
 * @param {Figure} figure
 * @returns {Column[]} a mean hides the worst joint, so that each has its own
 */
function columnsOf(figure) {
  if (figure.source === 'margin') return [marginColumn(figure)];
  if (figure.reduced === 'mean') return JOINTS.map((joint) => jointColumn(figure, joint));
  const {name, short: title, shown_unit: unit, factor, per_joint: perJoint} = figure;
  const greatest = (/** @type {Figures|null} */ figures) => {
    const value = figures?.[name] ?? null;
    if (!perJoint || value === null) return value;
    return value.includes(null) ? null : Math.max(...value);
  };
  return [{
    id: name, figure, title, unit, meaning: `${figure.meaning}${perJoint ? ', greatest of the joints' : ''}.`,
    extra: figure.extra,
    value: (figures) => scaled(greatest(figures), factor),
    ...(perJoint && {joint: (figures) => figures[name].indexOf(greatest(figures)) + 1}),
  }];
}

/**
 * @param {Figure} figure
 * @param {number} joint
 * @returns {Column}
 */
function jointColumn(figure, joint) {
  const {name, short, meaning, factor} = figure;
  const unit = unitAt(figure.shown_unit, joint);
  return {
    id: `${name}${joint}`, figure, title: `${short} J${joint}`, unit, of: joint,
    meaning: `${meaning} of joint ${joint}.`, extra: joint > FIRST_JOINTS,
    value: (figures) => scaled(figures?.[name]?.[joint - 1] ?? null, factor),
  };
}

/**
 * @param {Figure} figure
 * @returns {Column}
 */
function marginColumn(figure) {
  return {
    id: figure.name, figure, title: `${figure.short} / ${LIMIT.short}`, unit: figure.shown_unit,
    meaning: `${figure.meaning}, and ${inSentence(LIMIT.meaning)}. The condition itself is `
      + `${RADIUS.symbol} < 1: the ${inSentence(RADIUS.meaning)}.`,
    value: (_, margin) => scaled(margin?.gamma ?? null, figure.factor), isMargin: true,
  };
}

/**
 * @param {number|null} value
 * @param {number} factor
 */
function scaled(value, factor) { return value === null ? null : value * factor; }

/** @param {string} text */
function inSentence(text) { return text.charAt(0).toLowerCase() + text.slice(1); }

/**
 * @param {Figure} figure
 * @param {number|null|undefined} value as the server gives it
 * @returns {string} the number alone, a dash where there is none
 */
export function figureNumber({factor, digits}, value) {
  return inDigits(typeof value === 'number' ? value * factor : null, digits);
}

/**
 * @param {Figure} figure
 * @param {number|null|undefined} value as the server gives it
 * @param {number} [joint] from 1, where it is of one
 * @returns {string} such as `8.31 mrad`, a dash where there is none
 */
export function figureText(figure, value, joint) {
  const whole = joint ? unitAt(figure.shown_unit, joint) : figure.shown_unit;
  const unit = typeof value === 'number' ? whole : '';
  return [figureNumber(figure, value), unit].filter(Boolean).join(' ');
}

/**
 * @param {Figure} figure
 * @returns {string} such as `MAE mrad`
 */
export function figureHeading({short, shown_unit: unit}) { return `${short} ${unit}`; }

/**
 * @param {number|null|undefined} value
 * @returns {string} three significant digits, or a dash where there is no value
 */
export function threeDigits(value) { return inDigits(value, DIGITS); }

/**
 * @param {number|null|undefined} value
 * @param {number} digits significant ones
 */
export function inDigits(value, digits) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size === 0) return '0';
  if (size >= LEAST_PLAIN && size < GREATEST_PLAIN) {
    const text = value.toPrecision(digits);
    return text.includes('e') ? written(Number(text)) : text.replace('-', '−');
  }
  return value.toExponential(digits - 1).replace('e+', 'e').replaceAll('-', '−');
}

/**
 * @param {Margin|null} margin
 * @returns {string} γ and its limit, or ρ where there is no γ; sign(S) has neither, nor an end
 */
export function marginText(margin) {
  if (!margin) return '–';
  if (margin.gamma !== null) {
    return `${figureNumber(GAMMA, margin.gamma)} / ${figureNumber(LIMIT, margin.gamma_limit || null)}`;
  }
  return margin.radius === null ? '∞' : `${RADIUS.symbol} ${margin.radius.toPrecision(RADIUS.digits)}`;
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
  const rho = `${RADIUS.symbol} = ${radius.toPrecision(RADIUS.digits + 1)}`;
  if (stable) return `${rho}: small deviations decay`;
  return `${rho}, above 1: ${bounded ? 'a limit cycle' : 'without torque limits the sampled loop diverges'}`;
}

/**
 * @param {Margin|null} margin
 * @returns {boolean} whether it deserves a warning; that sign(S) chatters is no news
 */
export function marginWarns(margin) {
  return margin !== null && !margin.stable && (margin.radius !== null || !margin.bounded);
}

/**
 * The best of a column as it is written, where there is something to compare.
 *
 * @param {Column} column
 * @param {(number|null)[]} values
 * @returns {string|null}
 */
export function best({figure: {better, digits}}, values) {
  const known = values.filter((value) => value !== null);
  const texts = new Set(known.map((value) => inDigits(value, digits)));
  if (better === 'none' || texts.size < 2) return null;
  return inDigits(better === 'less' ? Math.min(...known) : Math.max(...known), digits);
}
