// @ts-check
/** From where to where an axis goes, and whether it is logarithmic. */

/** @typedef {import('./point_plot.js').Scale} Scale */

/** Values that span as much are read better on a logarithmic axis; ours. */
const SPAN = 10;
/** So large a share of the values lies within the axis; the rest on its edge. Ours. */
const WITHIN = 0.92;
const ROOM = 0.06;

/**
 * An axis that holds most of the values, and all of the `needed` ones.
 *
 * @param {string} title
 * @param {Float64Array} values NaN where there is none
 * @param {(number|null)[]} [needed]
 * @returns {Scale}
 */
export function scaleOf(title, values, needed = []) {
  const known = values.filter((value) => Number.isFinite(value)).sort();
  const wanted = /** @type {number[]} */ (needed.filter((value) => Number.isFinite(value)));
  if (!known.length && !wanted.length) return {title, log: false, range: [0, 1]};
  const least = Math.min(known[0] ?? Infinity, ...wanted);
  const most = Math.max(known[Math.ceil(WITHIN * known.length) - 1] ?? -Infinity, ...wanted);
  if (least > 0 && most >= SPAN * least) {
    const room = (most / least) ** ROOM;
    return {title, log: true, range: [rounded(least / room), rounded(most * room)]};
  }
  const room = (most - least) * ROOM || Math.abs(most) * ROOM || 1;
  return {title, log: false, range: [rounded(least - room), rounded(most + room)]};
}

/**
 * Steady, so that the axes stand still while little is new.
 *
 * @param {number} value
 */
function rounded(value) { return Number(value.toPrecision(3)); }
