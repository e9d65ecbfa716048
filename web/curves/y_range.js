// @ts-check
/** Vertical ranges that hold still: they grow at once and shrink only when much is empty. */

const PADDING = 0.06;
/** A range that the data fill less than this is drawn anew. */
const LEAST_FILL = 0.45;
/** How far a frozen lane's last values may stretch the range, as a multiple of the others'. */
const FROZEN_STRETCH = 1;
const DECADES = 5;

/** @typedef {[number, number]} Range */

/**
 * @param {ArrayLike<number>} values
 * @returns {Range} [Infinity, -Infinity] when there is none
 */
export function extent(values) {
  let low = Infinity;
  let high = -Infinity;
  for (let index = 0; index < values.length; index += 1) {
    const value = values[index];
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
}

/**
 * @param {Range[]} ranges
 * @returns {Range}
 */
function union(ranges) {
  return [Math.min(...ranges.map(([low]) => low)), Math.max(...ranges.map(([, high]) => high))];
}

/**
 * What has to be seen: a lane that ran away doesn't flatten those that run.
 *
 * @param {Range[]} running
 * @param {Range[]} frozen
 * @param {number} [stretch] how far these may stretch the range, as a multiple of the others'
 * @returns {Range}
 */
export function wanted(running, frozen, stretch = FROZEN_STRETCH) {
  const [low, high] = union(running);
  if (low > high) return union(frozen);
  const reach = stretch * (high - low || Math.abs(high) || 1);
  const [deepest, greatest] = union(frozen);
  return [
    Math.min(low, Math.max(deepest, low - reach)),
    Math.max(high, Math.min(greatest, high + reach)),
  ];
}

/** @param {Range} range */
function padded([low, high]) {
  // Less than a float32 can tell apart, or than Plotly can lay ticks along, counts as nothing.
  const size = Math.max(Math.abs(low), Math.abs(high));
  const told = high - low > Math.max(1e-12, 1e-7 * size);
  const span = told ? high - low : size > 1e-9 ? 0.2 * size : 1;
  const middle = (low + high) / 2;
  const half = span * (0.5 + PADDING);
  return /** @type {Range} */ ([middle - half, middle + half]);
}

/** Keeps the range of each panel. */
export class YRanges {
  /** @type {Map<string, Range>} */ #ranges = new Map();

  clear() { this.#ranges.clear(); }

  /**
   * @param {string} panel
   * @param {Range} data
   * @param {{positive?: boolean}} [of] a quantity that can't be negative begins at 0
   * @returns {Range}
   */
  linear(panel, [lowest, highest], {positive = false} = {}) {
    const data = /** @type {Range} */ ([positive ? Math.min(0, lowest) : lowest, highest]);
    if (data[0] > data[1]) return this.#ranges.get(panel) ?? [-1, 1];
    const kept = this.#ranges.get(panel);
    if (kept && kept[0] <= data[0] && kept[1] >= data[1]
      && data[1] - data[0] >= LEAST_FILL * (kept[1] - kept[0])) return kept;
    const range = padded(data);
    if (positive) range[0] = data[0];
    this.#ranges.set(panel, range);
    return range;
  }

  /**
   * @param {string} panel
   * @param {Range} data positive
   * @returns {Range} decades, as a logarithmic axis takes them
   */
  logarithmic(panel, data) {
    if (!(data[1] > 0) || data[0] > data[1]) return this.#ranges.get(panel) ?? [-3, 0];
    const high = Math.log10(data[1]);
    const low = Math.max(data[0] > 0 ? Math.log10(data[0]) : -Infinity, high - DECADES);
    return this.linear(panel, [low, high]);
  }
}
