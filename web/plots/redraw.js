// @ts-check
/** Hands figures to the plotting library in the cheapest way that shows them. */

import {movedCurves} from './curve_paths.js';
import {library} from './figure.js';

/** @typedef {{data: any[], layout: {[name: string]: any}}} Figure */

const CONFIG = {displayModeBar: false, doubleClick: false, scrollZoom: false, responsive: false};

/**
 * Draws one graph again and again. New points and ranges alone take a fifth less time than a
 * figure that may differ anywhere; measured with three lanes, three joints, 10 s at 1 kHz.
 */
export class PlotRedraw {
  #graph;
  #shape = '';
  #axes = '';
  /** @type {import('./curve_paths.js').Drawn} */ #drawn = new Map();

  /** @param {HTMLElement} graph */
  constructor(graph) { this.#graph = graph; }

  /**
   * @param {Figure} wanted
   * @param {{passing?: boolean}} [how] `passing`: another follows soon, and nobody points at this one
   * @returns {boolean} whether the graph is a new one
   */
  draw(wanted, {passing = false} = {}) {
    const figure = passing ? this.#inDrawnOrder(wanted) : wanted;
    const shape = shapeOf(figure);
    const axes = usedAxes(figure);
    // Where axes come and the size changes at once, the library draws the new axes' lines before it
    // knows where they lie, unless points told it: they would begin at NaN.
    if (this.#shape && axes !== this.#axes) this.#clear();
    const fresh = !this.#shape;
    try {
      if (shape === this.#shape && figure.data.length) this.#move(figure, passing);
      else library().react(this.#graph, figure.data, figure.layout, CONFIG);
      this.#shape = shape;
      this.#axes = axes;
      this.#drawn = new Map(figure.data.map(({uid, x, y}) => [uid, {x, y}]));
    } catch (error) {
      // Half a plot would make every later redraw fail as well.
      this.#clear();
      throw error;
    }
    return fresh;
  }

  /**
   * Which curve lies on top may change with every value: for the library that is another figure.
   *
   * @param {Figure} figure
   * @returns {Figure} its traces as they lie now, where they are the same ones
   */
  #inDrawnOrder(figure) {
    const traces = new Map(figure.data.map((trace) => [trace.uid, trace]));
    const data = [...this.#drawn.keys()].flatMap((uid) => traces.get(uid) ?? []);
    return data.length === figure.data.length && data.length === this.#drawn.size
      ? {...figure, data} : figure;
  }

  #clear() {
    library().purge(this.#graph);
    this.#shape = '';
    this.#drawn.clear();
  }

  /**
   * @param {Figure} figure of the same shape as the last
   * @param {boolean} passing
   */
  #move({data, layout}, passing) {
    const points = {x: data.map(({x}) => x), y: data.map(({y}) => y)};
    const drawn = /** @type {any} */ (this.#graph).layout;
    const ranges = axesOf(layout)
      .filter((axis) => String(drawn[axis].range) !== String(layout[axis].range))
      .map((axis) => [`${axis}.range`, layout[axis].range]);
    if (passing && !ranges.length && movedCurves(this.#graph, data, this.#drawn)) return;
    // Axes that hold still, as those of a whole response do, cost another fifth.
    if (ranges.length) library().update(this.#graph, points, Object.fromEntries(ranges));
    else library().restyle(this.#graph, points);
  }
}

/**
 * The library gives an axis no place before a trace belongs to it.
 *
 * @param {Figure} figure
 */
function usedAxes({data}) { return JSON.stringify([...new Set(data.map(({yaxis}) => yaxis))].sort()); }

/** @param {Figure['layout']} layout */
function axesOf(layout) { return Object.keys(layout).filter((name) => /^[xy]axis/.test(name)); }

/**
 * Everything about a figure but its points and ranges.
 *
 * @param {Figure} figure
 */
function shapeOf({data, layout}) {
  return JSON.stringify([
    data.map(({x, y, ...trace}) => trace),
    {...layout, ...Object.fromEntries(axesOf(layout).map((axis) => (
      [axis, {...layout[axis], range: null}]
    )))},
  ]);
}
