// @ts-check
/** Where moments and values lie in one panel of the plots, in pixels of the stage, and back. */

/** @typedef {import('../plots/canvas.js').TimeAxis} TimeAxis */

/** One panel as it is drawn. */
export class PanelScale {
  left;
  right;
  top;
  bottom;
  #window;
  #range;

  /**
   * @param {TimeAxis} axis
   * @param {number} index of the panel
   */
  constructor({window, left, width, panels}, index) {
    const {top, height, range} = panels[index];
    [this.left, this.right] = [left, left + width];
    [this.top, this.bottom] = [top, top + height];
    this.#window = window;
    this.#range = range;
  }

  /** Seconds that one pixel takes. */
  get timePerPixel() { return (this.#window[1] - this.#window[0]) / (this.right - this.left); }

  /** The value that one pixel takes, in the unit of the panel. */
  get valuePerPixel() { return (this.#range[1] - this.#range[0]) / (this.bottom - this.top); }

  /** @param {number} time in [s] */
  x(time) { return this.left + (time - this.#window[0]) / this.timePerPixel; }

  /** @param {number} value in the unit of the panel */
  y(value) { return this.top + (this.#range[1] - value) / this.valuePerPixel; }

  /**
   * @param {number} x
   * @returns {number} in [s], within what is seen
   */
  time(x) { return this.#window[0] + (this.#acrossIn(x) - this.left) * this.timePerPixel; }

  /**
   * @param {number} y
   * @returns {number} in the unit of the panel, within what is seen
   */
  value(y) { return this.#range[1] - (this.#downIn(y) - this.top) * this.valuePerPixel; }

  /** @param {number} x */
  #acrossIn(x) { return Math.min(Math.max(x, this.left), this.right); }

  /** @param {number} y */
  #downIn(y) { return Math.min(Math.max(y, this.top), this.bottom); }
}

/**
 * @param {TimeAxis} axis
 * @param {number} y
 * @returns {number} index of the panel there, or of the nearest one
 */
export function panelAt({panels}, y) {
  const far = panels.map(({top, height}) => Math.max(top - y, y - top - height, 0));
  return far.indexOf(Math.min(...far));
}
