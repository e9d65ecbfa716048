// @ts-check
/** Numbers on the screen: how they are written, read, stepped and laid along a slider. */

/** @typedef {import('./schema.js').Field} Field */
/** @typedef {Pick<Field, 'minimum'|'maximum'|'step'|'log'|'odd'|'integer'>} Scale */

/** Positions of a logarithmic slider; one key press is 1/500 of its decades. */
export const POSITIONS = 500;
const MINUS = '−';

/**
 * @param {number} value
 * @returns {string} six digits at most, a real minus sign, no trailing zeros
 */
export function written(value) {
  const size = Math.abs(value);
  const rounded = Number(value.toPrecision(6));
  const plain = size === 0 || (size >= 1e-4 && size < 1e7);
  return (plain ? String(rounded) : rounded.toExponential()).replaceAll('-', MINUS);
}

/**
 * @param {number} value
 * @param {string} unit
 */
export function withUnit(value, unit) { return unit ? `${written(value)} ${unit}` : written(value); }

/**
 * Read what a person typed: `0.3`, `1e-3`, `0,3`, `pi/2`, `-3π/4`, and degrees where the unit
 * is rad.
 *
 * @param {string} text
 * @param {string} unit
 * @returns {number} NaN when it isn't a number
 */
export function read(text, unit) {
  const plain = text.trim().replaceAll(MINUS, '-').replace(',', '.').replace(/pi/i, 'π');
  if (plain === '') return NaN;
  if (unit === 'rad' && plain.endsWith('°')) return (read(plain.slice(0, -1), '') * Math.PI) / 180;
  const parts = /^([+-]?)(\d*\.?\d*)\s*π\s*(?:\/\s*(\d+\.?\d*))?$/.exec(plain);
  if (!parts) return Number(plain);
  const [, sign, factor, divisor] = parts;
  return (Number(`${sign}${factor || 1}`) * Math.PI) / Number(divisor ?? 1);
}

/**
 * @param {number} value
 * @param {Scale} scale
 * @returns {number} within the bounds; whole or odd where it must be
 */
export function fitting(value, {minimum, maximum, odd, integer}) {
  const whole = odd ? 2 * Math.round((value - 1) / 2) + 1 : value;
  const counted = integer ? Math.round(whole) : whole;
  // Without it 0.1 + 0.2 would show its rounding error.
  return Number(Math.min(maximum, Math.max(minimum, counted)).toPrecision(12));
}

/**
 * @param {number} value
 * @param {Scale} scale
 * @returns {number} where it lies along the slider, 0 to 1
 */
export function fraction(value, {minimum, maximum, log}) {
  const along = log
    ? Math.log(value / minimum) / Math.log(maximum / minimum)
    : (value - minimum) / (maximum - minimum);
  return Math.min(1, Math.max(0, along));
}

/**
 * @param {number} along 0 to 1
 * @param {Scale} scale
 * @returns {number} the value there, as round as the slider is fine
 */
export function valueAlong(along, scale) {
  const {minimum, maximum, step, log} = scale;
  if (log) {
    return fitting(Number((minimum * (maximum / minimum) ** along).toPrecision(3)), scale);
  }
  const raw = minimum + along * (maximum - minimum);
  return fitting(Math.round(raw / step) * step, scale);
}
