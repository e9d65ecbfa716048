// @ts-check
/** How a figure changed against a baseline, in words. */

import {written} from '../fields/quantity.js';

/** @typedef {{kind: 'better'|'worse'|'same'|'none', text: string}} Change */

/** Smaller changes are nobody's doing: float32 columns and rounding on the screen. */
const LEAST_SHARE = 0.0005;
const DIGITS = 2;
const MANY_TIMES = 2;

/**
 * @param {number|null} before the baseline's
 * @param {number|null} now
 * @param {import('./figure.js').Figure['better']} better which way is
 * @returns {Change}
 */
export function changeOf(before, now, better) {
  if (before === null || now === null) return {kind: 'none', text: ''};
  if (before === now) return {kind: 'same', text: 'same'};
  const judged = (/** @type {boolean} */ less, /** @type {string} */ size) => {
    const kind = better === 'none' ? 'none' : less === (better === 'less') ? 'better' : 'worse';
    const words = [less ? '▼' : '▲', size, kind === 'none' ? '' : kind];
    return /** @type {Change} */ ({kind, text: words.filter(Boolean).join(' ')});
  };
  if (before === 0) return judged(now < 0, '');
  const share = now / before - 1;
  if (Math.abs(share) < LEAST_SHARE) return {kind: 'same', text: 'same'};
  const many = share >= MANY_TIMES - 1;
  return judged(share < 0, many ? `${rounded(now / before)}×` : percent(Math.abs(share)));
}

/** @param {number} share */
function percent(share) { return share < 0.01 ? '< 1 %' : `${rounded(100 * share)} %`; }

/** @param {number} value */
function rounded(value) { return written(Number(value.toPrecision(DIGITS))); }
