// @ts-check
/** The moment that the 3D scene looks back at, as a line over the live plots. */

import {element} from '../dom/element.js';

/** @typedef {import('../plots/canvas.js').TimeAxis} TimeAxis */

/** One line, seen while the scene shows the past. */
export class LookLine {
  #line = element('div', {class: 'look-line', 'aria-hidden': 'true', hidden: true},
    element('span', {}, 'shown in 3D'));
  /** @type {TimeAxis|null} */ #axis = null;
  /** @type {number|null} */ #time = null;

  /**
   * @param {HTMLElement} stage
   * @param {import('../api/api.js').Api} api
   * @param {(time: number|null) => void} changed called with the new moment in [s]
   */
  constructor(stage, api, changed) {
    stage.append(this.#line);
    api.addEventListener('look', (event) => {
      this.#time = /** @type {CustomEvent} */ (event).detail.time;
      changed(this.#time);
      this.#show();
    });
  }

  /**
   * Follow a redraw of the plots.
   *
   * @param {TimeAxis|null} axis null where there are no times
   */
  place(axis) {
    this.#axis = axis;
    this.#show();
  }

  #show() {
    const [axis, time] = [this.#axis, this.#time];
    const [from, to] = axis?.window ?? [0, 0];
    this.#line.hidden = !axis || time === null || time < from || time > to;
    if (!axis || time === null || this.#line.hidden) return;
    const along = (time - from) / (to - from);
    this.#line.style.transform = `translateX(${Math.round(axis.left + along * axis.width)}px)`;
    this.#line.style.height = `${axis.height - 36}px`;
    this.#line.classList.toggle('is-right', along > 0.8);
  }
}
