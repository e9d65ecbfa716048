// @ts-check
/** Which stretch of time the plots show: all that their source offers, or what their user holds. */

/** @typedef {[number, number]} Range */
/**
 * `shift`: as a part of the window's length.
 * @typedef {{shift?: number, factor?: number}} Change
 */

/** @type {Map<string, Change>} With Shift, because the page takes the arrow keys alone. */
export const TIME_KEYS = new Map([
  ['ArrowLeft', {shift: -0.1}], ['ArrowRight', {shift: 0.1}],
  ['ArrowUp', {factor: 0.8}], ['ArrowDown', {factor: 1.25}],
]);
const AXIS = /^([xy]axis\d*)\.range(?:\[([01])\])?$/;

/**
 * Ranges of the axes in a report of the plotting library about a zoom.
 *
 * @param {{[name: string]: any}} report
 * @returns {Map<string, Range>}
 */
export function reportedRanges(report) {
  /** @type {Map<string, Range>} */ const ranges = new Map();
  for (const [name, value] of Object.entries(report)) {
    const [, axis, end] = AXIS.exec(name) ?? [];
    if (!axis) continue;
    const range = ranges.get(axis) ?? /** @type {Range} */ ([NaN, NaN]);
    if (end) range[Number(end)] = Number(value);
    else [range[0], range[1]] = value.map(Number);
    ranges.set(axis, range);
  }
  return ranges;
}

/**
 * A window, moved or magnified.
 *
 * @param {Range} range in [s]
 * @param {Change} change
 * @returns {Range} in [s]
 */
function moved([from, to], {shift = 0, factor = 1}) {
  const middle = (from + to) / 2 + shift * (to - from);
  const half = ((to - from) / 2) * factor;
  return [middle - half, middle + half];
}

/** The visible window. */
export class PlotWindow {
  /** @type {Map<string, Range>} Axes that the user zoomed, of the view on the screen. */
  zoomed = new Map();
  /** @type {Range|null} Seconds shown while held. */ #held = null;
  #offered;

  /** @param {() => Range} offered seconds shown while nothing is held */
  constructor(offered) { this.#offered = offered; }

  /** Whether nothing is held. */
  get live() { return this.#held === null; }

  /** @returns {Range} in [s] */
  get range() { return this.#held ?? this.#offered(); }

  /** @param {Range} range in [s] */
  hold(range) { this.#held = [...range]; }

  /**
   * Hold what is seen, moved or magnified.
   *
   * @param {Change} change
   */
  move(change) { this.hold(moved(this.range, change)); }

  /** Hold nothing any more. */
  follow() {
    this.#held = null;
    this.zoomed.clear();
  }
}
