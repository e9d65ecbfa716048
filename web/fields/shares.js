// @ts-check
/** The shares of six joints in one gain, turned together. */

import {fitting} from './quantity.js';

/**
 * @param {readonly number[]} values
 * @returns {number} the one of the greatest size, with its sign
 */
export function greatest(values) {
  return values.reduce((most, value) => (Math.abs(value) > Math.abs(most) ? value : most), 0);
}

/**
 * All of them by one factor, each held within the bounds.
 *
 * @param {readonly number[]} values
 * @param {number} to what becomes of the greatest
 * @param {import('./quantity.js').Scale} scale
 * @returns {number[]}
 */
export function scaled(values, to, scale) {
  const most = greatest(values);
  return values.map((value) => {
    const share = most ? value / most : 1;
    return fitting(share === 1 ? to : Number((to * share).toPrecision(6)), scale);
  });
}
