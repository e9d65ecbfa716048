// @ts-check
/** When a lane leaves the bound of a goal. */

/** @typedef {import('../goals/words.js').Goal} Goal */
/** @typedef {[number, number]} Span in [s] */

/**
 * Where |value| is above the bound, on straight lines between the points. What is not a number any
 * more, after a lane left its own bounds, is above every bound.
 *
 * @param {ArrayLike<number>} time rising, in [s]
 * @param {ArrayLike<number>} values in the unit of the goal
 * @param {Goal} goal
 * @param {number} gap spans that are closer than this in [s] are one
 * @returns {Span[]}
 */
export function violations(time, values, {bound, start = 0, end = Infinity}, gap) {
  /** @type {Span[]} */ const spans = [];
  const add = (/** @type {number} */ from, /** @type {number} */ to) => {
    const [first, last] = [Math.max(from, start), Math.min(to, end)];
    if (first > last) return;
    const before = spans.at(-1);
    if (before && first - before[1] <= gap) before[1] = Math.max(before[1], last);
    else spans.push([first, last]);
  };
  for (let row = 1; row < time.length; row += 1) {
    const [past, now] = [excess(values[row - 1], bound), excess(values[row], bound)];
    if (past <= 0 && now <= 0) continue;
    const [from, to] = [time[row - 1], time[row]];
    // An infinite excess begins, or ends, where the numbers do.
    const share = past === Infinity || now === Infinity ? 1 : past / (past - now);
    const crossing = from + share * (to - from);
    add(past > 0 ? from : crossing, now > 0 ? to : crossing);
  }
  return spans;
}

/**
 * @param {number} value
 * @param {number} bound
 */
function excess(value, bound) { return Number.isFinite(value) ? Math.abs(value) - bound : Infinity; }
