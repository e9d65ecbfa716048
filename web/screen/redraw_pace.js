// @ts-check
/** Draws at most once per animation frame, and seldom enough that sliders never wait. */

/** Share of the main thread that drawing may take; ours. */
const SHARE = 0.4;
/** Painting what was drawn costs about a tenth more than preparing it; measured. */
const PAINTING = 1.1;

/** Calls `draw` after requests, at a rate that follows from how long it takes. */
export class RedrawPace {
  /** Smoothed cost of one redraw in [ms]. */
  cost = 0;
  /** Number of redraws so far. */
  count = 0;

  #draw;
  #share;
  #waiting = false;
  #earliest = 0;

  /**
   * @param {() => void} draw
   * @param {number} [share] of the main thread
   */
  constructor(draw, share = SHARE) {
    this.#draw = draw;
    this.#share = share;
  }

  /**
   * Ask for a redraw soon.
   *
   * @param {{least?: number}} [options] least time between two redraws in [ms]
   */
  request({least = 0} = {}) {
    if (this.#waiting) return;
    this.#waiting = true;
    const wait = Math.max(this.#earliest, this.#last + least) - performance.now();
    if (wait > 4) setTimeout(() => requestAnimationFrame(() => this.#run()), wait);
    else requestAnimationFrame(() => this.#run());
  }

  #last = -Infinity;

  #run() {
    this.#waiting = false;
    const before = performance.now();
    this.#draw();
    const now = performance.now();
    const cost = (now - before) * PAINTING;
    this.cost = this.count ? 0.8 * this.cost + 0.2 * cost : cost;
    this.count += 1;
    this.#last = before;
    // Smoothed: after one that took long, such as the first of a drag, the next needn't wait.
    this.#earliest = before + this.cost / this.#share;
  }
}
