// @ts-check
/** A bound is drawn: press at one instant, let go at another, at the height of the bound. */

import {element} from '../dom/element.js';
import {drawnGoal} from './drawn.js';
import {PanelScale, panelAt} from './panel_scale.js';

/** @typedef {import('../plots/canvas.js').TimeAxis} TimeAxis */
/** @typedef {import('../response/views.js').ResponsePanel} ResponsePanel */
/** @typedef {import('../goals/words.js').Goal} Goal */
/** @typedef {import('./drawn.js').Point} Point */
/** @typedef {{axis: TimeAxis, panels: ResponsePanel[], horizon: number}} Plots */

const HINT = 'Drag over a plot from one instant to another, at the height of the bound. '
  + 'A click bounds the whole response.';

/** Covers the plots while a bound may be drawn. */
export class BoundDrawing {
  /** Lies over the plots. */
  element;
  /** Stands above the plots. */
  hint;
  #preview;
  #on;
  /** @type {Plots|null} */ #plots = null;
  /** @type {{index: number, from: Point, to: Point}|null} */ #press = null;

  /**
   * @param {import('./preview.js').BoundPreview} preview
   * @param {{drawn: (goal: Goal) => void, armed: (armed: boolean) => void}} on
   */
  constructor(preview, on) {
    this.#preview = preview;
    this.#on = on;
    this.element = element('div', {class: 'bound-sheet', hidden: true, on: {
      pointerdown: (event) => this.#pressed(event),
      pointermove: (event) => this.#moved(event),
      pointerup: (event) => this.#released(event),
      pointercancel: () => this.#forget(),
      pointerleave: () => { if (!this.#press) this.#preview.hide(); },
    }});
    this.hint = element('p', {class: 'bound-hint', role: 'status', hidden: true},
      element('span', {}, HINT),
      element('button', {class: 'button small', type: 'button', title: 'Escape',
        on: {click: () => this.arm(false)}}, 'Cancel'));
    addEventListener('keydown', (event) => this.#keyed(event), true);
  }

  get armed() { return !this.element.hidden; }

  /** @param {boolean} armed whether the next press draws */
  arm(armed) {
    if (armed === this.armed) return;
    this.element.hidden = !armed;
    this.hint.hidden = !armed;
    this.#forget();
    this.#on.armed(armed);
  }

  /**
   * Follow a redraw of the plots.
   *
   * @param {Plots|null} plots null where there are none
   */
  place(plots) {
    this.#plots = plots;
    if (this.#press) this.#show(this.#press);
  }

  /** @param {PointerEvent} event */
  #pressed(event) {
    if (event.button !== 0 || !event.isPrimary || !this.#plots) return;
    event.preventDefault();
    this.element.setPointerCapture(event.pointerId);
    const at = this.#pointOf(event);
    this.#press = {index: panelAt(this.#plots.axis, at.y), from: at, to: at};
    this.#show(this.#press);
  }

  /** @param {PointerEvent} event */
  #moved(event) {
    if (!this.#plots || !event.isPrimary) return;
    const at = this.#pointOf(event);
    if (this.#press) this.#press.to = at;
    // Before the press: the line that a click would make.
    this.#show(this.#press ?? {index: panelAt(this.#plots.axis, at.y), from: at, to: at});
  }

  /** @param {PointerEvent} event */
  #released(event) {
    if (!this.#press || !event.isPrimary) return;
    this.#press.to = this.#pointOf(event);
    const goal = this.#goalOf(this.#press)?.goal;
    this.arm(false);
    if (goal) this.#on.drawn(goal);
  }

  #forget() {
    this.#press = null;
    this.#preview.hide();
  }

  /** @param {KeyboardEvent} event */
  #keyed(event) {
    if (event.key !== 'Escape' || !this.armed || !this.element.checkVisibility()) return;
    if (document.querySelector('dialog[open], :popover-open')) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    this.arm(false);
  }

  /** @param {{index: number, from: Point, to: Point}} press */
  #show(press) {
    const shown = this.#goalOf(press);
    if (shown) this.#preview.show(shown.scale, shown.panel, shown.goal, shown.horizon, press.to.x);
    else this.#preview.hide();
  }

  /** @param {{index: number, from: Point, to: Point}} press */
  #goalOf({index, from, to}) {
    const panel = this.#plots?.panels[index];
    if (!this.#plots || !panel) return null;
    const {axis, horizon} = this.#plots;
    const scale = new PanelScale(axis, index);
    return {scale, panel, horizon, goal: drawnGoal(scale, panel, from, to, horizon)};
  }

  /**
   * @param {PointerEvent} event
   * @returns {Point}
   */
  #pointOf({clientX, clientY}) {
    const {left, top} = this.element.getBoundingClientRect();
    return {x: clientX - left, y: clientY - top};
  }
}
