// @ts-check
/** The figures that a step quotes, each beside what the live session shows over the same time. */

import {element} from '../dom/element.js';
import {measured} from './measure.js';
import {figureNumber, threeDigits} from '../figures/columns.js';
import {figureOf} from '../figures/figure.js';

/** @typedef {import('./lesson_document.js').LessonFigure} Figure */
/** @typedef {{figure: Figure, cell: HTMLElement, text: string}} Row */

/** Time between two looks in [ms]. */
const LEAST_MS = 400;
const MARGINS = new Map([
  ['sampling_margin', figureOf('gamma')], ['margin_limit', figureOf('gamma_limit')],
]);

/**
 * @param {string} number
 * @returns {string} written as the quoted ones are: `186,000`, `2400`
 */
function inThousands(number) {
  return number.replace(/^\d{5,}/, (digits) => digits.replace(/\B(?=(\d{3})+$)/g, ','));
}

/** One table at a time; empty where nothing that is quoted can be measured. */
export class LessonFigures {
  element = element('div', {class: 'lesson-figures'});
  #api;
  /** @type {Row[]} */ #rows = [];
  #restarts = -1;
  #since = -Infinity;

  /** @param {import('../api/api.js').Api} api */
  constructor(api) {
    this.#api = api;
    for (const type of ['frame', 'metrics']) api.addEventListener(type, () => this.#look());
  }

  /** @param {Figure[]} figures */
  show(figures) {
    this.#restarts = -1;
    this.#rows = figures.map((figure) => ({figure, cell: element('td'), text: ''}));
    this.element.hidden = !figures.length;
    this.element.replaceChildren(!figures.length ? '' : element(
      'table', {'aria-label': 'Figures of this step'},
      element('thead', {}, element('tr', {}, ...['', 'quoted', 'live'].map((text) => (
        element('th', {scope: 'col'}, text)
      )))),
      element('tbody', {}, ...this.#rows.map(({figure, cell}) => element(
        'tr', {}, element('th', {scope: 'row'}, figure.label, figure.window && element(
          'small', {}, ` ${figure.window}`,
        )), element('td', {}, [figure.quoted, figure.unit].filter(Boolean).join('\u00a0')), cell,
      ))),
    ));
    this.#since = -Infinity;
    this.#look();
  }

  #look() {
    const ring = this.#api.kept;
    const now = performance.now();
    if (!ring || !this.#rows.length || now - this.#since < LEAST_MS) return;
    if (!this.element.isConnected && this.#since > 0) return;
    this.#since = now;
    if (ring.restarts !== this.#restarts) for (const row of this.#rows) row.text = '';
    this.#restarts = ring.restarts;
    for (const row of this.#rows) this.#fill(row, ring);
  }

  /**
   * @param {Row} row `text` once it is final: the ring forgets
   * @param {import('../curves/ring.js').Ring} ring
   */
  #fill(row, ring) {
    const {figure, cell} = row;
    const margin = MARGINS.get(figure.metric);
    if (margin) {
      const value = this.#api.metrics?.lanes?.[figure.lane]?.margin?.[margin.name];
      this.#write(cell, figureNumber(margin, value), '');
      return;
    }
    if (row.text) return;
    const seen = measured(ring, figure);
    const text = seen ? [inThousands(threeDigits(seen.value)), figure.unit].filter(Boolean).join('\u00a0') : '–';
    this.#write(cell, text, seen ? '' : 'It takes time to get there, or a reset.');
    if (seen?.whole) row.text = text;
    cell.classList.toggle('is-final', Boolean(seen?.whole));
  }

  /**
   * @param {HTMLElement} cell
   * @param {string} text
   * @param {string} title
   */
  #write(cell, text, title) {
    if (cell.textContent !== text) cell.textContent = text;
    if (cell.title !== title) cell.title = title;
  }
}
