// @ts-check
/** What the cursors read: their times, and every visible trace's values, as a table. */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {written} from '../fields/quantity.js';

/** @typedef {import('./cursors.js').Reading} Reading */
/** @typedef {{time: number, readings: Reading[]}|null} Column null: that cursor isn't set */

const TIME_DIGITS = 4;
const DIGITS = 5;
const NOTHING = '–';

/** The table below the plots; hidden without cursors. */
export class CursorReadout {
  element;
  /** @type {(lane: string) => string} */ colorOf = () => '';

  #times = element('span', {class: 'cursor-times'});
  #body = element('tbody');
  /** @type {HTMLTableCellElement[][]} */ #cells = [];
  #built = '';

  /** @param {() => void} close */
  constructor(close) {
    const table = element(
      'table', {class: 'cursor-table'},
      element('thead', {}, element('tr', {}, ...['trace', 'y_A', 'y_B', 'Δy', 'unit'].map((title) => (
        element('th', {scope: 'col'}, ...indexed(title))
      )))),
      this.#body,
    );
    const remove = element('button', {
      type: 'button', class: 'button icon-only small', 'aria-label': 'Remove the cursors',
      title: 'Remove the cursors (Esc)', on: {click: close},
    }, icon('close'));
    this.element = element(
      'section', {class: 'cursor-readout', 'aria-label': 'Cursors', hidden: true},
      element('div', {class: 'cursor-head'}, this.#times, remove),
      element('div', {class: 'cursor-scroll', tabindex: 0, role: 'region', 'aria-label': 'Values at the cursors'}, table),
    );
  }

  /**
   * @param {Column} a
   * @param {Column} b
   */
  show(a, b) {
    this.element.hidden = !a && !b;
    if (this.element.hidden) return;
    this.#showTimes(a, b);
    const readings = (a ?? b)?.readings ?? [];
    this.#build(readings);
    readings.forEach(({unit}, row) => {
      const [first, second] = [a, b].map((column) => column?.readings[row]?.value ?? null);
      const between = first === null || second === null ? null : second - first;
      const texts = [first, second, between].map(inDigits);
      [...texts, unit].forEach((text, index) => setText(this.#cells[row][index], text));
    });
  }

  /**
   * @param {Column} a
   * @param {Column} b
   */
  #showTimes(a, b) {
    const parts = [];
    if (a) parts.push(['t_A', a.time, 's']);
    if (b) parts.push(['t_B', b.time, 's']);
    if (a && b) parts.push(['Δt', b.time - a.time, 's']);
    const text = JSON.stringify(parts);
    if (this.#times.dataset.text === text) return;
    this.#times.dataset.text = text;
    this.#times.replaceChildren(...parts.map(([name, value, unit]) => element(
      'span', {class: 'cursor-time', 'data-name': name}, ...indexed(String(name)),
      ` ${Number(value).toFixed(TIME_DIGITS).replace('-', '−')} ${unit}`,
    )));
  }

  /** @param {Reading[]} readings */
  #build(readings) {
    const built = JSON.stringify(readings.map(({lane, label, panel}) => (
      [lane, label, panel, this.colorOf(lane)]
    )));
    if (built === this.#built) return;
    this.#built = built;
    this.#cells = readings.map(() => Array.from({length: 4}, () => element('td')));
    this.#body.replaceChildren(...readings.map(({lane, label, panel}, row) => {
      const dot = element('span', {class: 'plots-dot', 'aria-hidden': 'true'});
      dot.style.setProperty('--lane', this.colorOf(lane) || 'var(--text)');
      const head = element('th', {scope: 'row'}, dot, element('span', {}, panel), ' ',
        element('span', {class: 'cursor-label'}, label));
      return element('tr', {}, head, ...this.#cells[row]);
    }));
  }
}

/**
 * @param {string} text such as `t_A`
 * @returns {(string|HTMLElement)[]}
 */
function indexed(text) {
  const [base, below] = text.split('_');
  return below ? [element('i', {class: 'symbol'}, base), element('sub', {}, below)] : [base];
}

/** @param {number|null} value */
function inDigits(value) {
  return value === null ? NOTHING : written(Number(value.toPrecision(DIGITS)));
}

/**
 * @param {HTMLElement} cell
 * @param {string} text
 */
function setText(cell, text) { if (cell.textContent !== text) cell.textContent = text; }
