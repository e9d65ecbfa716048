// @ts-check
/**
 * Fewer points than samples, without losing a peak: the least and the greatest of each bucket.
 *
 * Buckets lie on multiples of their size, counted from the ring's first row, so that a point
 * doesn't change while the window slides over it.
 */

/**
 * Rows a bucket spans so that about two points fall on each pixel.
 *
 * @param {number} rows in the window
 * @param {number} pixels
 * @returns {number} 1: draw the samples as they are
 */
export function bucketSize(rows, pixels) {
  const size = Math.ceil(rows / Math.max(pixels, 1));
  return size > 2 ? size : 1;
}

/**
 * Where the points of {@link decimated} lie, in rows.
 *
 * @param {number} from first row
 * @param {number} to one past the last row
 * @param {number} size of a bucket
 * @returns {Float64Array} Shape (points,).
 */
export function positions(from, to, size) {
  if (size === 1) return Float64Array.from({length: to - from}, (_, index) => from + index);
  const first = Math.floor(from / size);
  const buckets = Math.ceil(to / size) - first;
  const rows = new Float64Array(2 * buckets);
  for (let bucket = 0; bucket < buckets; bucket += 1) {
    const left = (first + bucket) * size;
    rows[2 * bucket] = Math.max(left + 0.25 * size, from);
    rows[2 * bucket + 1] = Math.min(left + 0.75 * size, to - 1);
  }
  return rows;
}

/**
 * The extremes of each bucket in the order in which they occur; NaN where a bucket has no value.
 *
 * @param {ArrayLike<number>} values of the rows from `from`
 * @param {number} from row of the first value
 * @param {number} size of a bucket
 * @returns {Float64Array} Shape (points,), as {@link positions}.
 */
export function decimated(values, from, size) {
  if (size === 1) return Float64Array.from(values);
  const to = from + values.length;
  const first = Math.floor(from / size);
  const buckets = Math.ceil(to / size) - first;
  const points = new Float64Array(2 * buckets);
  for (let bucket = 0; bucket < buckets; bucket += 1) {
    const left = Math.max((first + bucket) * size, from) - from;
    const right = Math.min((first + bucket + 1) * size, to) - from;
    extremes(values, left, right, points, 2 * bucket);
  }
  return points;
}

/**
 * @param {ArrayLike<number>} values
 * @param {number} left
 * @param {number} right
 * @param {Float64Array} points
 * @param {number} at
 */
function extremes(values, left, right, points, at) {
  let least = Infinity;
  let greatest = -Infinity;
  let leastAt = left;
  let greatestAt = left;
  for (let index = left; index < right; index += 1) {
    const value = values[index];
    if (value < least) { least = value; leastAt = index; }
    if (value > greatest) { greatest = value; greatestAt = index; }
  }
  const empty = least > greatest;
  const rising = leastAt <= greatestAt;
  points[at] = empty ? NaN : rising ? least : greatest;
  points[at + 1] = empty ? NaN : rising ? greatest : least;
}
