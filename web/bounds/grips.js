// @ts-check
/** What a bound in the plots is taken by: its line for the value, its two ends for the instants. */

import {element} from '../dom/element.js';
import {goalWords} from '../goals/words.js';
import {boundAt, instantAt, movedEnd} from './drawn.js';
import {PanelScale} from './panel_scale.js';

/** @typedef {import('../plots/canvas.js').TimeAxis} TimeAxis */
/** @typedef {import('../response/views.js').ResponsePanel} ResponsePanel */
/** @typedef {import('./bounds.js').Bound} Bound */
/** @typedef {'value'|'start'|'end'} Part */
/** @typedef {{name: string, scale: PanelScale, panel: ResponsePanel, x: number, y: number}} Place */
/**
 * @typedef {{grip: HTMLElement, part: Part, place: Place, bound: Bound}} Grip
 */

/** A press that moves less than this in pixels moves nothing. */
const SLOP = 3;
/** @type {Part[]} The ends last, where they lie over the line. */
const PARTS = ['value', 'start', 'end'];
const HOW = {value: 'drag it up or down', start: 'drag its beginning', end: 'drag its end'};

/** Three grips a line; they stay while their bound is in the plots, so that a drag goes on. */
export class BoundGrips {
  element = element('div', {class: 'bound-grips'});
  #edits;
  #preview;
  #moved;
  /** @type {Map<string, Grip>} */ #grips = new Map();
  #horizon = 0;
  /** @type {{key: string, stop: () => void}|null} */ #drag = null;

  /**
   * @param {import('../goals/edits.js').GoalEdits} edits
   * @param {import('./preview.js').BoundPreview} preview
   * @param {() => void} moved a bound is elsewhere now
   */
  constructor(edits, preview, moved) {
    this.#edits = edits;
    this.#preview = preview;
    this.#moved = moved;
  }

  /**
   * @param {TimeAxis} axis
   * @param {{panel: ResponsePanel, bounds: Bound[]}[]} panels
   * @param {number} horizon in [s]
   */
  show(axis, panels, horizon) {
    this.#horizon = horizon;
    /** @type {Set<string>} */ const seen = new Set();
    panels.forEach(({panel, bounds}, index) => {
      const scale = new PanelScale(axis, index);
      for (const bound of bounds) {
        for (const part of PARTS) {
          const key = JSON.stringify([panel.id, bound.name, Math.sign(bound.y[0]), part]);
          seen.add(key);
          this.#place(key, part, scale, panel, bound);
        }
      }
    });
    this.#keep(seen);
  }

  clear() { this.#keep(new Set()); }

  /** @param {Set<string>} seen keys of those that stay */
  #keep(seen) {
    for (const [key, {grip}] of this.#grips) {
      if (seen.has(key)) continue;
      if (this.#drag?.key === key) this.#drag.stop();
      grip.remove();
      this.#grips.delete(key);
    }
  }

  /**
   * @param {string} key
   * @param {Part} part
   * @param {PanelScale} scale
   * @param {ResponsePanel} panel
   * @param {Bound} bound
   */
  #place(key, part, scale, panel, bound) {
    const {name, goal, x: [start, end], y: [value]} = bound;
    const [left, right, y] = [scale.x(start), scale.x(end), scale.y(value)];
    const [from, to] = [Math.max(left, scale.left), Math.min(right, scale.right)];
    const x = part === 'end' ? right : left;
    const place = {name, scale, panel, x, y};
    const grip = this.#gripOf(key, part, place, bound);
    grip.hidden = y < scale.top - 1 || y > scale.bottom + 1 || from >= to
      || (part !== 'value' && (x < scale.left - 1 || x > scale.right + 1));
    const tone = bound.kept === null ? '' : bound.kept ? 'is-kept' : 'is-missed';
    const classes = `bound-grip is-${part} ${tone}`;
    if (grip.className !== classes) grip.className = classes;
    if (grip.hidden) return;
    const {style} = grip;
    style.transform = `translate(${Math.round(part === 'value' ? from : x)}px, ${Math.round(y)}px)`;
    if (part === 'value') style.width = `${Math.round(to - from)}px`;
    const title = `${goalWords(goal, this.#horizon)}: ${HOW[part]}`;
    if (grip.title !== title) grip.title = title;
  }

  /**
   * @param {string} key
   * @param {Part} part
   * @param {Place} place
   * @param {Bound} bound
   */
  #gripOf(key, part, place, bound) {
    const known = this.#grips.get(key);
    if (known) { Object.assign(known, {place, bound}); return known.grip; }
    // From the keyboard a bound is moved in the list of goals.
    const grip = element('div', {
      'aria-hidden': 'true', 'data-goal': place.name, 'data-part': part,
      on: {pointerdown: (event) => this.#grasped(key, event)},
    });
    this.element.append(grip);
    this.#grips.set(key, {grip, part, place, bound});
    return grip;
  }

  /**
   * @param {string} key
   * @param {PointerEvent} press
   */
  #grasped(key, press) {
    const {grip, place} = /** @type {Grip} */ (this.#grips.get(key));
    if (press.button !== 0 || this.#drag) return;
    press.preventDefault();
    grip.setPointerCapture(press.pointerId);
    const {name, x, y} = place;
    let moved = false;
    const drag = new AbortController();
    const {signal} = drag;
    const stop = (/** @type {'end'|'cancel'} */ how = 'end') => {
      if (signal.aborted) return;
      drag.abort();
      unwatch();
      this.#drag = null;
      this.#preview.hide();
      // The bound stays where it was let go until the server has answered.
      if (moved) this.#edits[how]().then(this.#moved);
    };
    const unwatch = this.#edits.watch(name, () => stop());
    this.#drag = {key, stop};
    grip.addEventListener('pointermove', ({clientX, clientY}) => {
      const [across, down] = [clientX - press.clientX, clientY - press.clientY];
      if (!moved && Math.hypot(across, down) < SLOP) return;
      moved = true;
      this.#move(key, x + across, y + down);
    }, {signal});
    grip.addEventListener('lostpointercapture', () => stop(), {signal});
    addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      event.preventDefault();
      event.stopImmediatePropagation();
      stop('cancel');
    }, {signal, capture: true});
  }

  /**
   * @param {string} key
   * @param {number} x
   * @param {number} y
   */
  #move(key, x, y) {
    const {part, place: {name, scale, panel}} = /** @type {Grip} */ (this.#grips.get(key));
    const goal = this.#edits.all[name];
    if (!goal) return;
    const change = part === 'value' ? {bound: boundAt(scale, panel, y)}
      : movedEnd(goal, part, instantAt(scale, x, this.#horizon), this.#horizon, scale.timePerPixel);
    this.#edits.move(name, change);
    this.#preview.show(scale, panel, this.#edits.all[name], this.#horizon, x);
    this.#moved();
  }
}
