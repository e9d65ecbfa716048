// @ts-check
/**
 * One point per trial: axes and lines by the plotting library, the points on a canvas above them.
 * Thousands of points of the library would each be an element, or need WebGL, for which it compiles
 * code at run time: the page's content policy forbids that.
 */

import {axis} from '../lenses/figure.js';
import {element} from '../dom/element.js';
import {saveImageButton} from '../plot_view/save_image.js';
import {PlotFrame, layoutIn, penOf} from './plot_frame.js';
import {drawMark, drawPoint, drawSteps} from './point_marks.js';
import {heightHere} from '../screen/low_screen.js';

/** @typedef {import('./plot_frame.js').Room} Room */
/** @typedef {import('./trials.js').Fate} Fate */
/** @typedef {{title: string, log: boolean, range: [number, number]}} Scale `range` as it is read */
/**
 * What to draw. `x`, `y`: of each trial, NaN for no place; beyond the axis' upper end a point is
 * drawn on the edge. `lines`: traces of the library; `steps`: a line that changes with every trial.
 * `marked`: trials by what they are.
 *
 * @typedef {{label: string, x: Float64Array, y: Float64Array, fates: Fate[],
 *   passes: (number: number) => boolean, marked: [import('./point_marks.js').Mark, number][],
 *   lines: (colors: import('./plot_frame.js').Colors) => object[],
 *   steps?: {x: number[], y: (number|null)[]}, across: Scale, up: Scale, key: string}} PointSheet
 *   `key`: tells lines from others
 */

const HEIGHT = heightHere(250, 165);
const MARGIN = {l: 62, r: 14, t: 12, b: 38};
/** A finger covers more than a pointer; in pixels. */
const NEAR = 14;
const NEAR_FINGER = 24;
/** A hand that moves no more than this has pressed, not dragged; in pixels. */
const STILL = 4;

/** Draws sheets; tells which trial is pointed at, and pressed. */
export class PointPlot {
  /** @type {HTMLElement} */ element;
  #frame = new PlotFrame(HEIGHT, (room) => this.#draw(room));
  #canvas = element('canvas', {class: 'search-points', 'aria-hidden': 'true'});
  /** @type {PointSheet|null} */ #sheet = null;
  /** @type {Room|null} */ #room = null;
  #drawn = '';
  #listening = false;
  #on;
  /** @type {[number, number]|null} */ #pressed = null;

  /** @param {{focus: (number: number|null) => void, choose: (number: number) => void}} on */
  constructor(on) {
    this.#on = on;
    this.element = this.#frame.element;
    this.element.append(this.#canvas, saveImageButton(this.#frame.graph, this.#canvas));
    const focus = (/** @type {PointerEvent} */ event) => {
      if (event.pointerType !== 'touch') on.focus(this.#at(event));
    };
    this.element.addEventListener('pointermove', focus);
    this.element.addEventListener('pointerleave', () => on.focus(null));
    this.element.addEventListener('pointerdown', ({clientX, clientY}) => {
      this.#pressed = [clientX, clientY];
      // The library covers the page until the pointer is released.
      const options = {once: true, capture: true};
      addEventListener('pointerup', (released) => this.#released(released), options);
    }, true);
  }

  /** @param {PointSheet} sheet */
  draw(sheet) {
    this.#sheet = sheet;
    this.#frame.label = sheet.label;
    this.#frame.request();
  }

  /** @param {Room} room */
  #draw(room) {
    const sheet = this.#sheet;
    if (!sheet || !this.element.checkVisibility()) return;
    this.#room = room;
    const {across, up, key} = sheet;
    const now = JSON.stringify([key, across, up, room]);
    // A redraw in the middle of a drag would break it off.
    if (now !== this.#drawn && !this.#pressed) {
      this.#frame.react(sheet.lines(room.colors), {
        ...layoutIn(room), margin: MARGIN, uirevision: `${across.title} ${up.title}`,
        xaxis: axis(room.colors, scaled(across)), yaxis: axis(room.colors, scaled(up)),
      });
      this.#drawn = now;
    }
    if (!this.#listening) {
      this.#listening = true;
      const graph = /** @type {any} */ (this.#frame.graph);
      graph.on('plotly_relayout', () => this.#points());
      graph.on('plotly_relayouting', () => this.#points());
    }
    this.#points();
  }

  #points() {
    const sheet = this.#sheet;
    const room = this.#room;
    if (!sheet || !room || !this.#drawn) return;
    const {width, height, colors} = room;
    const pen = penOf(this.#canvas, width, height);
    const {xaxis, yaxis} = /** @type {any} */ (this.#frame.graph)._fullLayout;
    pen.beginPath();
    pen.rect(xaxis._offset - 10, yaxis._offset - 10, xaxis._length + 20, yaxis._length + 20);
    pen.clip();
    const {fates, passes, marked, steps} = sheet;
    if (steps) drawSteps(pen, colors, steps.x.map((x, at) => this.#pixels(x, steps.y[at] ?? NaN)));
    for (let number = 0; number < fates.length; number += 1) {
      const [x, y] = this.#place(number);
      if (!Number.isNaN(x + y)) drawPoint(pen, colors, fates[number], x, y, !passes(number));
    }
    for (const [mark, number] of marked) {
      const [x, y] = this.#place(number);
      if (!Number.isNaN(x + y)) drawMark(pen, colors, mark, x, y);
    }
  }

  /**
   * @param {number} number of a trial
   * @returns {[number, number]} where it is drawn, in pixels; NaN for nowhere
   */
  #place(number) {
    const {x = [], y = []} = this.#sheet ?? {};
    return this.#pixels(x[number], y[number]);
  }

  /**
   * @param {number} x
   * @param {number} y
   * @returns {[number, number]}
   */
  #pixels(x, y) {
    const layout = /** @type {any} */ (this.#frame.graph)._fullLayout;
    const along = pixel(layout.xaxis, x);
    const above = pixel(layout.yaxis, y);
    const right = layout.xaxis._offset + layout.xaxis._length;
    return [Math.min(along, right), Math.max(above, layout.yaxis._offset)];
  }

  /**
   * @param {PointerEvent} event
   * @returns {number|null} the nearest trial
   */
  #at({clientX, clientY, pointerType}) {
    if (!this.#sheet || !this.#room || !this.#drawn) return null;
    const {left, top} = this.element.getBoundingClientRect();
    let nearest = null;
    let least = pointerType === 'touch' ? NEAR_FINGER : NEAR;
    for (let number = 0; number < this.#sheet.fates.length; number += 1) {
      const [x, y] = this.#place(number);
      const distance = Math.hypot(x - clientX + left, y - clientY + top);
      if (distance < least) { least = distance; nearest = number; }
    }
    return nearest;
  }

  /** @param {PointerEvent} event */
  #released(event) {
    if (!this.#pressed) return;
    const [x, y] = this.#pressed;
    this.#pressed = null;
    this.#frame.request();
    if (Math.hypot(event.clientX - x, event.clientY - y) > STILL) return;
    const number = this.#at(event);
    if (number !== null) this.#on.choose(number);
  }
}

/**
 * @param {any} axisOfGraph the library's
 * @param {number} value
 */
function pixel(axisOfGraph, value) {
  if (axisOfGraph.type === 'log' && !(value > 0)) return NaN;
  return axisOfGraph._offset + axisOfGraph.c2p(value);
}

/** @param {Scale} scale */
function scaled({title, log, range}) {
  return log
    ? {title, type: 'log', range: range.map(Math.log10), nticks: 6, zeroline: false}
    : {title, range, zeroline: false};
}
