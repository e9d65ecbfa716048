// @ts-check
/** The knee of the curve of accuracy against chattering: where the price changes hands. */

/** A bend that is less than this of the way between both ends is no knee. */
const LEAST_BEND = 0.1;

/**
 * The point that bends farthest from the straight line between the quietest and the most exact one,
 * on logarithmic axes: on one side of it accuracy costs much torque, on the other calm much accuracy.
 *
 * @template {{mae: number|null, chattering: number|null}} Row
 * @param {Row[]} points
 * @returns {Row|null} null where there is none
 */
export function knee(points) {
  if (points.length < 3) return null;
  const least = (/** @type {'mae'|'chattering'} */ figure) => points.reduce((one, row) => (
    Number(row[figure]) < Number(one[figure]) ? row : one
  ));
  const [exact, quiet] = [least('mae'), least('chattering')];
  const place = (/** @type {Row} */ row) => [
    share(Number(row.chattering), Number(quiet.chattering), Number(exact.chattering)),
    share(Number(row.mae), Number(exact.mae), Number(quiet.mae)),
  ];
  let found = null;
  let most = LEAST_BEND;
  for (const row of points) {
    const [x, y] = place(row);
    // Both ends lie at x + y = 1, and at 0 would be calm that costs nothing.
    const bend = 1 - x - y;
    if (bend > most) [found, most] = [row, bend];
  }
  return found;
}

/**
 * @param {number} value
 * @param {number} from
 * @param {number} to
 */
function share(value, from, to) { return Math.log(value / from) / (Math.log(to / from) || 1); }
