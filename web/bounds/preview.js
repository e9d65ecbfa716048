// @ts-check
/** The bound under the hand: its rectangle, its height, and what it says. */

import {element} from '../dom/element.js';
import {boundLabel} from './drawn.js';

/** @typedef {import('../goals/words.js').Goal} Goal */
/** @typedef {import('../response/views.js').ResponsePanel} ResponsePanel */

/** Pixels between the label and the line. */
const AWAY = 6;
const LABEL_HEIGHT = 20;

/** Shown while a bound is drawn or dragged. */
export class BoundPreview {
  #band = element('div', {class: 'bound-band'});
  #label = element('div', {class: 'bound-label'});
  element = element('div', {class: 'bound-preview', 'aria-hidden': 'true', hidden: true}, this.#band, this.#label);

  /**
   * @param {import('./panel_scale.js').PanelScale} scale
   * @param {ResponsePanel} panel
   * @param {Goal} goal
   * @param {number} horizon in [s]
   * @param {number} x where the hand is
   */
  show(scale, panel, goal, horizon, x) {
    this.element.hidden = false;
    const {start = 0, end = horizon} = goal;
    const value = goal.bound * panel.scale;
    const within = (/** @type {number} */ low, /** @type {number} */ at, /** @type {number} */ high) => (
      Math.min(Math.max(at, low), high)
    );
    const [left, right] = [start, Math.min(end, horizon)]
      .map((time) => within(scale.left, scale.x(time), scale.right));
    const [top, bottom] = [value, panel.positive ? 0 : -value]
      .map((each) => within(scale.top, scale.y(each), scale.bottom));
    this.#band.style.transform = `translate(${Math.round(left)}px, ${Math.round(top)}px)`;
    this.#band.style.width = `${Math.round(right - left)}px`;
    this.#band.style.height = `${Math.max(1, Math.round(bottom - top))}px`;
    this.#label.textContent = boundLabel(goal, panel, horizon);
    const at = within(scale.left, x, scale.right);
    const share = (at - scale.left) / (scale.right - scale.left);
    const above = top - AWAY - LABEL_HEIGHT;
    const height = above >= scale.top ? above : top + AWAY;
    // At the left edge it begins at the hand, at the right edge it ends there.
    this.#label.style.transform = `translate(${Math.round(at)}px, ${Math.round(height)}px) translateX(${-100 * share}%)`;
  }

  hide() { this.element.hidden = true; }
}
