// @ts-check
/** Which stretch of time the plots show: the newest, or the one their user holds. */

/** @typedef {import('../curves/ring.js').Ring} Ring */
/** @typedef {[number, number]} Range */
/**
 * `shift`: as a part of the window's length.
 * @typedef {{shift?: number, factor?: number}} Change
 */

export const LENGTHS = [2, 5, 10, 30, 60];
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
export function moved([from, to], {shift = 0, factor = 1}) {
  const middle = (from + to) / 2 + shift * (to - from);
  const half = ((to - from) / 2) * factor;
  return [middle - half, middle + half];
}

/** Time in [s] after which a close-up is taken: what the start itself does has died away (*ours*). */
const SETTLED = 1;

/** The visible window. */
export class PlotWindow {
  /** Seconds shown while following. */
  length = 10;
  /** @type {Range|null} Seconds shown while held. */ #held = null;
  /** Samples of the close-up that was asked for. */ #samples = 0;
  /** The same until it is taken. */ #wanted = 0;
  /** @type {number|null} When the last lane stopped in [s], null while one runs. */ still = null;
  /** @type {Map<string, Range>} Axes that the user zoomed, of the tab on the screen. */
  zoomed = new Map();

  /** Whether the newest data are always in sight. */
  get live() { return this.#held === null; }

  /**
   * @param {Ring} ring
   * @returns {Range} in [s]
   */
  range(ring) {
    if (this.#held) return this.#held;
    if (ring.empty) return [0, this.length];
    const oldest = ring.timeOf(ring.start);
    // Where no lane runs any more, the newest is of no lane: the stop stays in sight.
    const end = Math.min(ring.newest, (this.still ?? Infinity) + this.length / 2);
    const from = Math.max(end - this.length, oldest);
    return [from, from + this.length];
  }

  /** @param {Range} range in [s] */
  hold(range) {
    this.#held = [...range];
    this.#wanted = 0;
    this.#samples = 0;
  }

  /**
   * Hold so many samples, as soon as there are any that are settled.
   *
   * @param {number} samples 0: follow the newest
   */
  closeUp(samples) {
    this.follow();
    this.#wanted = samples;
    this.#samples = samples;
  }

  /** Time begins anew; a close-up is taken again. */
  restarted() {
    const samples = this.#samples;
    this.follow();
    this.closeUp(samples);
  }

  /**
   * Take the close-up that is wanted, where it can be taken.
   *
   * @param {Ring} ring
   * @returns {boolean} whether it was
   */
  settle(ring) {
    if (!this.#wanted || ring.empty || ring.newest < SETTLED) return false;
    this.#wanted = 0;
    this.#held = [ring.newest - this.#samples * ring.dt, ring.newest];
    return true;
  }

  /**
   * Hold what is seen, moved or magnified.
   *
   * @param {Ring} ring
   * @param {Change} change
   */
  move(ring, change) {
    this.hold(moved(this.range(ring), change));
  }

  /** Show the newest again. */
  follow() {
    this.#held = null;
    this.#wanted = 0;
    this.#samples = 0;
    this.zoomed.clear();
  }
}
