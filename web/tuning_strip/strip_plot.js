// @ts-check
/** A plot of a few pixels' height, drawn without the plotting library. */

import {path, placesAcross} from '../plots/curve_paths.js';
import {element} from '../dom/element.js';
import {threeDigits} from '../figures/columns.js';

/** @typedef {import('../curves/panel_curves.js').DrawnPanel} DrawnPanel */

const SVG = 'http://www.w3.org/2000/svg';

/** One panel; its paths are kept from one picture to the next. */
export class StripPlot {
  element;
  #svg = document.createElementNS(SVG, 'svg');
  #zero = this.#path('strip-zero');
  /** @type {SVGPathElement[]} */ #lines = [];
  #high = element('span', {class: 'strip-high'});
  #low = element('span', {class: 'strip-low'});
  #before = element('span', {class: 'strip-before', hidden: true},
    element('span', {class: 'plots-shadow', 'aria-hidden': 'true'}), 'before the last change');
  #size = {width: 0, height: 0};

  /** @param {() => void} resized asked for when there is another place to draw on */
  constructor(resized) {
    this.#svg.setAttribute('role', 'img');
    this.element = element('div', {class: 'strip-plot'}, this.#svg, this.#high, this.#low, this.#before);
    new ResizeObserver(([{contentRect: {width, height}}]) => {
      this.#size = {width, height};
      resized();
    }).observe(this.element);
  }

  /**
   * @param {DrawnPanel & {window: import('../curves/y_range.js').Range}} drawn
   * @param {{lanes: import('../api/api.js').Lane[], selected: string}} of
   */
  draw({panel, curves, range, window}, {lanes, selected}) {
    const {width, height} = this.#size;
    const across = {range: window, _length: width};
    const up = {range, _length: height};
    const colors = new Map(lanes.map(({name, color}) => [name, color]));
    while (this.#lines.length < curves.length) this.#lines.push(this.#path('strip-line'));
    while (this.#lines.length > curves.length) this.#lines.pop()?.remove();
    for (const [index, {trace, x, y, steps}] of curves.entries()) {
      const line = this.#lines[index];
      line.setAttribute('d', path(placesAcross(across, x), up, y, Boolean(steps)));
      line.style.setProperty('--lane', colors.get(trace.lane) ?? '');
      line.classList.toggle('is-before', trace.role === 'before');
      line.classList.toggle('is-selected', trace.lane === selected);
    }
    this.#before.hidden = !curves.some(({trace}) => trace.role === 'before');
    this.#zero.setAttribute('d', path(placesAcross(across, window), up, [0, 0], false));
    this.#high.textContent = `${threeDigits(range[1])} ${panel.unit}`;
    this.#low.textContent = threeDigits(range[0]);
    this.#svg.setAttribute('aria-label', `Error of ${panel.title} in every lane`);
  }

  /** @param {string} name of its class */
  #path(name) {
    const line = document.createElementNS(SVG, 'path');
    line.classList.add(name);
    this.#svg.append(line);
    return line;
  }
}
