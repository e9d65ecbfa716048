// @ts-check
/** The figure on the screen: its size, its theme, and when it is drawn. */

import {element} from '../dom/element.js';
import {figure, library, themeOf} from './figure.js';
import {GAP, MARGIN, axisNumber} from './figure_panels.js';
import {PlotGestures} from './gestures.js';
import {PlotRedraw} from './redraw.js';
import {RedrawPace} from '../screen/redraw_pace.js';
import {linesOf} from './revision_marks.js';
import {YRanges} from '../curves/y_range.js';

/** @typedef {import('../curves/y_range.js').Range} Range */
/** @typedef {import('../curves/panel_curves.js').DrawnPanel} DrawnPanel */
/** @typedef {{pixels: number, ranges: YRanges}} Room */
/**
 * Everything that decides what is drawn. `message` says why there is nothing to see, or '';
 * `passing`: another sheet follows soon.
 * @typedef {{title: string, spectrum: boolean, panels: {title: string, quantity: string}[],
 *   window: Range, zoomed: Map<string, Range>, curves: (room: Room) => DrawnPanel[],
 *   message: string, marks: import('./revision_marks.js').RevisionMark[],
 *   stops?: import('../curves/freezes.js').Stop[],
 *   colors: Map<string, string|undefined>, selected: string, passing?: boolean}} CanvasSheet
 */
/**
 * Where the times lie on the stage, and each panel with its values, in pixels.
 * @typedef {{window: Range, left: number, width: number, height: number,
 *   panels: {top: number, height: number, range: Range}[]}} TimeAxis
 */

/** Lower than this in pixels a panel can't be read; the stage scrolls instead. plots.css has it. */
const LEAST_PANEL = '--least-panel';
/** The library can't lay out a time axis of almost no pixels. */
const LEAST_WIDTH = 50;

/** Draws sheets into a stage. */
export class Canvas {
  #stage;
  #sheet;
  #graph = element('div', {class: 'plots-graph'});
  #message = element('p', {class: 'plots-message'});
  #redraw = new PlotRedraw(this.#graph);
  #ranges = new YRanges();
  #pace;
  /** @type {import('./figure.js').Theme|null} */ #theme = null;
  #touch = matchMedia('(pointer: coarse)');
  #size = {width: 0, height: 0};
  #leastPanel = 0;
  #gestures;
  #on;

  /**
   * @param {HTMLElement} stage
   * @param {() => CanvasSheet} sheet what to draw now
   * @param {{zoom: (report: object) => void, live: () => void,
   *   drawn: (axis: TimeAxis|null) => void}} on `drawn`: null where there are no times
   * @param {number} [share] of the main thread that drawing may take
   */
  constructor(stage, sheet, on, share) {
    this.#pace = new RedrawPace(() => this.#draw(), share);
    this.#stage = stage;
    this.#sheet = sheet;
    this.#on = on;
    stage.append(this.#graph, this.#message);
    new ResizeObserver(([{contentRect: {width, height}}]) => {
      this.#size = {width: Math.floor(width), height: Math.floor(height)};
      this.#leastPanel = parseFloat(getComputedStyle(stage).getPropertyValue(LEAST_PANEL));
      this.request();
    }).observe(stage);
    document.addEventListener('visibilitychange', () => this.request());
    addEventListener('load', () => this.request());
    this.#watchTheme();
    this.#gestures = new PlotGestures(this.#graph, stage, {
      released: () => this.request(),
      doubled: () => on.live(),
    });
  }

  /** @param {{least?: number}} [options] as of {@link RedrawPace} */
  request(options) { this.#pace.request(options); }

  /** Choose the vertical ranges anew. */
  forgetRanges() { this.#ranges.clear(); }

  /** @returns {import('./redraw.js').Figure} the figure with title and legend */
  forFile() { return this.#figure(this.#sheet(), true); }

  #watchTheme() {
    const changed = () => { this.#theme = null; this.request(); };
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', changed);
    this.#touch.addEventListener('change', changed);
    new MutationObserver(changed).observe(
      document.documentElement, {attributes: true, attributeFilter: ['data-theme']},
    );
  }

  /** Whether anybody can see it. */
  get #visible() {
    const across = this.#size.width - MARGIN.l - MARGIN.r;
    return !document.hidden && across >= LEAST_WIDTH && this.#size.height > 0;
  }

  #draw() {
    if (!this.#visible || this.#gestures.pressed) return;
    const sheet = this.#sheet();
    this.#say(library() ? sheet.message : missingLibrary());
    this.#graph.hidden = !sheet.panels.length;
    if (!sheet.panels.length || !library()) { this.#on.drawn(null); return; }
    const drawing = this.#figure(sheet, false);
    if (this.#redraw.draw(drawing, sheet)) this.#listen();
    this.#on.drawn(sheet.spectrum ? null : timeAxis(drawing.layout, sheet.panels.length));
    // Counts the layout into the cost of this redraw, where it belongs.
    this.#graph.getBoundingClientRect();
    this.#describe(sheet);
  }

  /**
   * @param {CanvasSheet} sheet
   * @param {boolean} forFile
   */
  #figure(sheet, forFile) {
    const {panels, window, spectrum} = sheet;
    this.#theme ??= themeOf(this.#stage);
    const {width} = this.#size;
    const least = panels.length * (this.#leastPanel + GAP) - GAP + MARGIN.t + MARGIN.b;
    const pixels = Math.max(width - MARGIN.l - MARGIN.r, LEAST_WIDTH);
    const drawn = sheet.curves({pixels, ranges: this.#ranges});
    return figure({
      ...sheet,
      panels: drawn,
      window: spectrum ? frequencies(drawn) : window,
      marks: sheet.marks.map((mark) => ({time: mark.time, lines: linesOf(mark)})),
      width,
      height: Math.max(this.#size.height, least),
      touch: this.#touch.matches,
      theme: this.#theme,
      legend: forFile,
    });
  }

  #listen() {
    const graph = /** @type {any} */ (this.#graph);
    graph.on('plotly_relayout', (/** @type {object} */ report) => {
      if (!this.#gestures.vertical) this.#on.zoom(report);
    });
  }

  /** @param {string} text */
  #say(text) {
    this.#message.hidden = !text;
    if (this.#message.textContent !== text) this.#message.textContent = text;
  }

  /** @param {CanvasSheet} sheet */
  #describe({title: view, panels}) {
    const parts = panels.map(({title, quantity}) => `${title} ${quantity}`);
    const text = `${view}: ${parts.join(', ')}`;
    if (this.#graph.getAttribute('aria-label') === text) return;
    this.#graph.setAttribute('role', 'img');
    this.#graph.setAttribute('aria-label', text);
  }
}

function missingLibrary() {
  return document.readyState === 'complete'
    ? 'The plotting library did not load. Reload the page.' : 'Loading the plots …';
}

/**
 * @param {{[name: string]: any}} layout
 * @param {number} panels how many
 * @returns {TimeAxis}
 */
function timeAxis(layout, panels) {
  const {width, height, xaxis} = layout;
  const room = height - MARGIN.t - MARGIN.b;
  return {
    window: xaxis.range, left: MARGIN.l, width: width - MARGIN.l - MARGIN.r, height,
    panels: Array.from({length: panels}, (_, index) => {
      const {domain: [low, high], range} = layout[`yaxis${axisNumber(index)}`];
      return {top: MARGIN.t + (1 - high) * room, height: (high - low) * room, range};
    }),
  };
}

/**
 * @param {DrawnPanel[]} panels
 * @returns {Range} decades that all spectra span
 */
function frequencies(panels) {
  const axes = panels.flatMap(({curves}) => curves.map(({x}) => x)).filter((x) => x.length);
  if (!axes.length) return [-1, 2];
  return [
    Math.log10(Math.min(...axes.map((x) => x[0]))),
    Math.log10(Math.max(...axes.map((x) => x[x.length - 1]))),
  ];
}
