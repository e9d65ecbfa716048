// @ts-check
/** The axes of parallel coordinates: where a value stands on each, its ticks, and its brush. */

import {written} from '../fields/quantity.js';

/** @typedef {[number, number]} Brush least and greatest value that pass */

const DECADE = 10;
/** A brush that keys move covers this share of its axis, and moves by half of it; ours. */
const WINDOW = 0.25;

/** One axis: a label and a number of each trial. */
export class ParallelAxis {
  label;
  values;
  #log;
  #least;
  #most;

  /**
   * @param {string} id
   * @param {string} label
   * @param {number[]} values
   */
  constructor(id, label, values) {
    this.id = id;
    this.label = label;
    this.values = values;
    const [least, most] = [Math.min(...values), Math.max(...values)];
    this.#log = least > 0 && most >= DECADE * least;
    const width = most > least ? 0 : Math.abs(most) || 1;
    this.#least = this.#placed(least - width);
    this.#most = this.#placed(most + width);
  }

  /** @param {number} value */
  #placed(value) { return this.#log ? Math.log10(value) : value; }

  /**
   * @param {number} value
   * @returns {number} where it stands, 0 at the lower end to 1
   */
  along(value) { return (this.#placed(value) - this.#least) / (this.#most - this.#least); }

  /**
   * @param {number} along 0 to 1
   * @returns {number}
   */
  valueAt(along) {
    const place = this.#least + Math.min(Math.max(along, 0), 1) * (this.#most - this.#least);
    return this.#log ? 10 ** place : place;
  }

  /** @returns {{along: number, text: string}[]} */
  get ticks() {
    return [0, 1 / 3, 2 / 3, 1].map((along) => (
      {along, text: written(Number(this.valueAt(along).toPrecision(2)))}
    ));
  }

  /**
   * The brush after a key: a window that begins at one end and moves.
   *
   * @param {Brush|undefined} brush
   * @param {1|-1} way up or down
   * @returns {Brush}
   */
  moved(brush, way) {
    const step = (WINDOW / 2) * way;
    const low = brush ? this.along(brush[0]) + step : way > 0 ? 0 : 1 - WINDOW;
    const held = Math.min(Math.max(low, 0), 1 - WINDOW);
    return [this.valueAt(held), this.valueAt(held + WINDOW)];
  }
}
