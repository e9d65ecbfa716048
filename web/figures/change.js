// @ts-check
/** How a figure changed against a baseline, in words. Of every figure less is better. */

import {written} from '../fields/quantity.js';

/** @typedef {{kind: 'better'|'worse'|'same'|'none', text: string}} Change */

/** Smaller changes are nobody's doing: float32 columns and rounding on the screen. */
const LEAST_SHARE = 0.0005;
const DIGITS = 2;
const MANY_TIMES = 2;

/**
 * @param {number|null} before the baseline's
 * @param {number|null} now
 * @returns {Change}
 */
export function changeOf(before, now) {
  if (before === null || now === null) return {kind: 'none', text: ''};
  if (before === now) return {kind: 'same', text: 'same'};
  if (before === 0) return {kind: 'worse', text: '▲ worse'};
  const share = now / before - 1;
  if (Math.abs(share) < LEAST_SHARE) return {kind: 'same', text: 'same'};
  if (share < 0) return {kind: 'better', text: `▼ ${percent(-share)} better`};
  const size = share >= MANY_TIMES - 1 ? `${rounded(now / before)}×` : percent(share);
  return {kind: 'worse', text: `▲ ${size} worse`};
}

/** @param {number} share */
function percent(share) { return share < 0.01 ? '< 1 %' : `${rounded(100 * share)} %`; }

/** @param {number} value */
function rounded(value) { return written(Number(value.toPrecision(DIGITS))); }
