// @ts-check
/** One picture of a lens: drawn in the page's colours, again when size or theme change. */

import {element} from '../dom/element.js';
import {library, themeOf} from '../plots/figure.js';
import {saveImageButton} from '../plot_view/save_image.js';
import {RedrawPace} from '../screen/redraw_pace.js';

/** @typedef {import('../plots/figure.js').Theme & {accent: string}} Colors */
/** @typedef {{data: object[], layout: {[name: string]: any}}} Figure */
/** @typedef {(colors: Colors, width: number) => Figure} Build */

const FONT_SIZE = 11;
const MARGIN = {l: 66, r: 12, t: 8, b: 38};
/** The library can't lay out an axis of almost no pixels. */
const LEAST_WIDTH = MARGIN.l + MARGIN.r + 50;
const CONFIG = {displayModeBar: false, responsive: false, scrollZoom: false, doubleClick: 'reset'};

/**
 * @param {Colors} colors
 * @param {{[name: string]: any}} options of the library
 * @returns {{[name: string]: any}} an axis in the page's colours
 */
export function axis(colors, options) {
  const {title, ...rest} = options;
  return {
    title: {text: title, standoff: 6},
    gridcolor: colors.grid,
    zerolinecolor: colors.zero,
    linecolor: colors.zero,
    showline: true,
    ticks: '',
    exponentformat: 'power',
    ...rest,
  };
}

/**
 * @param {string} color `#rrggbb`
 * @param {number} share 0 to 1
 * @returns {string} that colour, so far transparent
 */
export function faint(color, share) {
  const parts = [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16));
  return parts.some(Number.isNaN) ? color : `rgba(${parts.join(',')},${share})`;
}

/** Draws what it is given into its element, whenever that can be seen. */
export class LensFigure {
  /** @type {HTMLElement} */ element;
  #graph = element('div', {class: 'lens-graph', role: 'img'});
  #height;
  #width = 0;
  /** @type {Build|null} */ #build = null;
  #pace = new RedrawPace(() => this.#draw());
  #touch = matchMedia('(pointer: coarse)');
  #click;
  #pressed = false;
  #listening = false;

  /** @param {{height: number, click?: (point: any) => void}} options */
  constructor({height, click}) {
    this.#height = height;
    this.#click = click;
    this.element = element(
      'div', {class: 'lens-figure'}, this.#graph, saveImageButton(this.#graph),
    );
    this.element.style.height = `${height}px`;
    new ResizeObserver(([{contentRect}]) => {
      this.#width = Math.floor(contentRect.width);
      this.#request();
    }).observe(this.element);
    const changed = () => this.#request();
    new MutationObserver(changed).observe(
      document.documentElement, {attributes: true, attributeFilter: ['data-theme']},
    );
    document.addEventListener('visibilitychange', changed);
    addEventListener('load', changed);
    // A redraw in the middle of a drag would break it off.
    this.#graph.addEventListener('pointerdown', () => { this.#pressed = true; }, true);
    const released = () => setTimeout(() => { this.#pressed = false; });
    for (const type of ['pointerup', 'pointercancel', 'blur']) addEventListener(type, released);
  }

  /**
   * @param {string} label what is to be seen, for those who can't see it
   * @param {Build} build
   */
  draw(label, build) {
    this.#build = build;
    if (this.#graph.getAttribute('aria-label') !== label) this.#graph.setAttribute('aria-label', label);
    this.#request();
  }

  #request() { if (this.#build) this.#pace.request(); }

  #draw() {
    if (!this.#build || !library() || document.hidden || this.#pressed) return;
    if (this.#width < LEAST_WIDTH) return;
    const colors = colorsOf(this.element);
    const {data, layout} = this.#build(colors, this.#width);
    const whole = {...base(colors, this.#touch.matches), ...layout};
    try {
      library().react(
        this.#graph, data, {...whole, width: this.#width, height: this.#height}, CONFIG,
      );
    } catch (error) {
      // Half a plot would make every later redraw fail as well.
      library().purge(this.#graph);
      this.#listening = false;
      throw error;
    }
    if (this.#listening || !this.#click) return;
    this.#listening = true;
    const graph = /** @type {any} */ (this.#graph);
    graph.on('plotly_click', ({points}) => this.#click?.(points[0]));
  }
}

/**
 * @param {Element} place
 * @returns {Colors}
 */
function colorsOf(place) {
  const style = getComputedStyle(place);
  const color = (/** @type {string} */ name) => style.getPropertyValue(name).trim();
  return {
    ...themeOf(place), accent: color('--accent'),
  };
}

/**
 * @param {Colors} colors
 * @param {boolean} touch
 */
function base(colors, touch) {
  return {
    margin: MARGIN,
    font: {family: colors.font, size: FONT_SIZE, color: colors.muted},
    paper_bgcolor: 'transparent',
    plot_bgcolor: 'transparent',
    showlegend: false,
    hovermode: 'closest',
    hoverlabel: {
      bgcolor: colors.background, bordercolor: colors.zero,
      font: {family: colors.font, size: FONT_SIZE, color: colors.text},
    },
    // A finger scrolls the page.
    dragmode: touch ? false : 'zoom',
  };
}
