// @ts-check
/** The parts of the time axis in which a lane leaves a bound, in red over the plots. */

import {PanelScale} from './panel_scale.js';
import {violations} from './violations.js';

/** @typedef {import('../plots/canvas.js').TimeAxis} TimeAxis */
/** @typedef {import('../response/views.js').ResponsePanel} ResponsePanel */
/** @typedef {import('../api/preview_message.js').LaneResponse} LaneResponse */
/** @typedef {import('./bounds.js').Bound} Bound */

const SVG = 'http://www.w3.org/2000/svg';
/** Pixels below which a stretch of time could not be seen. */
const LEAST_WIDTH = 1.5;
/** Pixels of the strip along the time axis. */
const STRIP = 4;

/** Two paths a lane and panel: where several lanes leave a bound it is as much redder. */
export class BoundShading {
  element = document.createElementNS(SVG, 'svg');
  /** @type {SVGPathElement[]} by turns the heights of the panels, and strips along their axes */
  #paths = [];

  constructor() {
    this.element.setAttribute('class', 'bound-shading');
    this.element.setAttribute('aria-hidden', 'true');
  }

  /**
   * @param {TimeAxis} axis
   * @param {{panel: ResponsePanel, bounds: Bound[]}[]} panels
   * @param {LaneResponse[]} lanes that are shown
   * @param {string} held name of the goal that a hand moves: the response judges another bound
   */
  show(axis, panels, lanes, held) {
    this.element.setAttribute('width', String(axis.left + axis.width));
    this.element.setAttribute('height', String(axis.height));
    const texts = panels.flatMap(({panel, bounds}, index) => {
      const scale = new PanelScale(axis, index);
      // The lower line of a bound says the same as the upper one.
      const upper = bounds.filter(({y}) => y[0] > 0);
      return lanes.flatMap((lane) => {
        const stretches = upper.flatMap((bound) => stretchesOf(scale, panel, bound, lane, held));
        return stretches.length ? [
          rectangles(stretches, scale.top, scale.bottom),
          rectangles(stretches, scale.bottom - STRIP, scale.bottom),
        ] : [];
      });
    });
    this.#keep(texts.length);
    texts.forEach((each, index) => this.#paths[index].setAttribute('d', each));
  }

  clear() { this.#keep(0); }

  /** @param {number} count of paths */
  #keep(count) {
    while (this.#paths.length > count) this.#paths.pop()?.remove();
    while (this.#paths.length < count) {
      const path = document.createElementNS(SVG, 'path');
      this.element.append(path);
      this.#paths.push(path);
    }
  }
}

/**
 * @param {PanelScale} scale
 * @param {ResponsePanel} panel
 * @param {Bound} bound
 * @param {LaneResponse} lane
 * @param {string} held
 * @returns {[number, number][]} from where to where, in pixels
 */
function stretchesOf(scale, {channel}, {name, goal}, {time, columns, goals}, held) {
  const ratio = goals?.ratios[name];
  const values = columns.get(channel);
  if (!values || (name !== held && typeof ratio === 'number' && ratio <= 1)) return [];
  return violations(time, values, goal, scale.timePerPixel).flatMap(([from, to]) => {
    const left = Math.max(scale.left, scale.x(from));
    const right = Math.min(scale.right, Math.max(scale.x(to), left + LEAST_WIDTH));
    return left < right ? [/** @type {[number, number]} */ ([left, right])] : [];
  });
}

/**
 * @param {[number, number][]} stretches
 * @param {number} top
 * @param {number} bottom
 * @returns {string} of an SVG path
 */
function rectangles(stretches, top, bottom) {
  return stretches.map(([left, right]) => (
    `M${left.toFixed(1)},${top}H${right.toFixed(1)}V${bottom}H${left.toFixed(1)}Z`
  )).join('');
}
