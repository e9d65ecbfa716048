// @ts-check
/** A place for one plot: its size and colours, and when it is drawn. */

import {element} from '../dom/element.js';
import {library, themeOf} from '../plots/figure.js';
import {RedrawPace} from '../screen/redraw_pace.js';

/** @typedef {import('../plots/figure.js').Theme & {accent: string, warning: string,
 *   good: string, bad: string}} Colors */
/** @typedef {{colors: Colors, width: number, height: number, touch: boolean}} Room */

/** The library can't lay out an axis of almost no pixels. */
const LEAST_WIDTH = 130;
const FONT_SIZE = 11;
export const CONFIG = {
  displayModeBar: false, responsive: false, scrollZoom: false, doubleClick: 'reset',
};

/** Calls `draw` after requests, while it can be seen, and when size or theme change. */
export class PlotFrame {
  /** @type {HTMLElement} */ element;
  graph = element('div', {class: 'search-graph', role: 'img'});
  #draw;
  #height;
  #width = 0;
  #pace = new RedrawPace(() => this.#run());
  #touch = matchMedia('(pointer: coarse)');

  /**
   * @param {number} height in pixels
   * @param {(room: Room) => void} draw
   */
  constructor(height, draw) {
    this.#height = height;
    this.#draw = draw;
    this.element = element('div', {class: 'search-figure'}, this.graph);
    this.element.style.height = `${height}px`;
    const changed = () => this.request();
    new ResizeObserver(([{contentRect}]) => {
      this.#width = Math.floor(contentRect.width);
      changed();
    }).observe(this.element);
    new MutationObserver(changed).observe(
      document.documentElement, {attributes: true, attributeFilter: ['data-theme']},
    );
    document.addEventListener('visibilitychange', changed);
    addEventListener('load', changed);
  }

  /** Ask for a drawing soon. */
  request() { this.#pace.request(); }

  /** @param {string} label what is to be seen, for those who can't see it */
  set label(label) {
    if (this.graph.getAttribute('aria-label') !== label) this.graph.setAttribute('aria-label', label);
  }

  /**
   * @param {object[]} data
   * @param {{[name: string]: any}} layout
   */
  react(data, layout) {
    try {
      library().react(this.graph, data, layout, CONFIG);
    } catch (error) {
      // Half a plot would make every later redraw fail as well.
      library().purge(this.graph);
      throw error;
    }
  }

  #run() {
    if (!library() || document.hidden || this.#width < LEAST_WIDTH) return;
    if (!this.element.isConnected) return;
    const style = getComputedStyle(this.element);
    const color = (/** @type {string} */ name) => style.getPropertyValue(name).trim();
    const colors = /** @type {Colors} */ ({
      ...themeOf(this.element), accent: color('--accent'), warning: color('--warning'),
    });
    this.#draw({colors, width: this.#width, height: this.#height, touch: this.#touch.matches});
  }
}

/**
 * @param {Room} room
 * @returns {{[name: string]: any}} what every plot's layout begins with
 */
export function layoutIn({colors, width, height, touch}) {
  return {
    width, height,
    font: {family: colors.font, size: FONT_SIZE, color: colors.muted},
    paper_bgcolor: 'transparent',
    plot_bgcolor: 'transparent',
    showlegend: false,
    hovermode: false,
    // A finger scrolls the page.
    dragmode: touch ? false : 'zoom',
  };
}

/**
 * @param {HTMLCanvasElement} canvas
 * @param {number} width in CSS pixels
 * @param {number} height
 * @returns {CanvasRenderingContext2D} of the empty canvas, whose units are CSS pixels
 */
export function penOf(canvas, width, height) {
  const ratio = devicePixelRatio || 1;
  Object.assign(canvas, {width: width * ratio, height: height * ratio});
  Object.assign(canvas.style, {width: `${width}px`, height: `${height}px`});
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  pen.scale(ratio, ratio);
  return pen;
}
