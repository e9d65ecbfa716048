// @ts-check
/** The window over telemetry: it follows the newest, or takes a close-up of a few samples. */

import {PlotWindow} from '../plot_view/window.js';

/** @typedef {import('../plot_view/window.js').Range} Range */

/** Time in [s] after which a close-up is taken: what the start itself does has died away (*ours*). */
const SETTLED = 1;

/** The visible window of the live plots. */
export class TelemetryWindow extends PlotWindow {
  /** Seconds shown while following. */
  length = 10;
  /** Samples of the close-up that was asked for. */ #samples = 0;
  /** The same until it is taken. */ #wanted = 0;
  #telemetry;

  /** @param {import('./telemetry.js').Telemetry} telemetry */
  constructor(telemetry) {
    super(() => this.#newest());
    this.#telemetry = telemetry;
  }

  /** @returns {Range} in [s] */
  #newest() {
    const {ring, still} = this.#telemetry;
    if (ring.empty) return [0, this.length];
    const oldest = ring.timeOf(ring.start);
    // Where no lane runs any more, the newest is of no lane: the stop stays in sight.
    const end = Math.min(ring.newest, (still ?? Infinity) + this.length / 2);
    const from = Math.max(end - this.length, oldest);
    return [from, from + this.length];
  }

  /**
   * @override
   * @param {Range} range in [s]
   */
  hold(range) {
    super.hold(range);
    this.#wanted = 0;
    this.#samples = 0;
  }

  /** @override */
  follow() {
    super.follow();
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
  restarted() { this.closeUp(this.#samples); }

  /**
   * Take the close-up that is wanted, where it can be taken.
   *
   * @returns {boolean} whether it was
   */
  settle() {
    const {ring} = this.#telemetry;
    if (!this.#wanted || ring.empty || ring.newest < SETTLED) return false;
    this.#wanted = 0;
    super.hold([ring.newest - this.#samples * ring.dt, ring.newest]);
    return true;
  }
}
