// @ts-check
/** The table of the live session: one row a lane, brought up to date in place. */

import {element, freshId} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {COLUMNS, best, inDigits, marginText, marginWarns, marginWords} from './columns.js';
import {MetricsNotes} from './notes.js';
import {sinceWords} from './since.js';
import {recall, remember} from '../screen/remembered.js';
import {withScrollCue} from '../dom/scroll_cue.js';

/** @typedef {import('../api/api.js').Api} Api */
/** @typedef {import('./columns.js').Column} Column */
/** @typedef {import('./columns.js').Figures} Figures */
/** @typedef {import('./notes.js').Note} Note */
/** @typedef {import('./columns.js').Margin} Margin */
/**
 * @typedef {{since: import('./since.js').Since, total: Figures|null,
 *   recent: Figures|null, margin: Margin|null, notes: Note[]}} LaneMetrics
 */
/**
 * @typedef {{figures: Figures|null, margin: Margin|null, values: (number|null)[],
 *   frozen: boolean, from: number}} Filled `from`: since when they count in [s]
 */
/**
 * @typedef {{row: HTMLTableRowElement, button: HTMLButtonElement, since: HTMLElement,
 *   cells: HTMLTableCellElement[], notes: MetricsNotes}} Row
 */

const LIVE = COLUMNS.filter(({figure}) => figure.live || figure.not_live);
const SPANS = /** @type {const} */ ([['total', 'since the last change'], ['recent', 'last 10 s']]);

/**
 * @param {HTMLElement} root
 * @param {Api} api
 */
export function mount(root, api) { new Metrics(root, api); }

class Metrics {
  #api;
  #body = element('tbody');
  #table;
  /** @type {Map<string, Row>} */ #rows = new Map();
  #built = '';
  /** @type {'total'|'recent'} */ #span = recall('metrics.span') === 'recent' ? 'recent' : 'total';

  /**
   * @param {HTMLElement} root
   * @param {Api} api
   */
  constructor(root, api) {
    this.#api = api;
    this.#table = element(
      'table', {class: 'metrics-table'},
      element('caption', {class: 'metrics-caption'}, 'How well each lane has tracked so far'),
      element('thead', {}, heading()), this.#body,
    );
    this.#showAll(recall('metrics.joints') === 'all');
    root.classList.add('metrics');
    root.append(this.#bar(), withScrollCue(element(
      'div', {class: 'metrics-scroll', tabindex: 0, role: 'region', 'aria-label': 'Live session so far'},
      this.#table,
    )));
    for (const type of ['hello', 'state', 'metrics', 'select']) {
      api.addEventListener(type, () => this.#show());
    }
    this.#show();
  }

  #bar() {
    const name = freshId('metrics-span');
    const spans = SPANS.map(([span, label]) => element(
      'label', {class: 'metrics-span'},
      element('input', {
        type: 'radio', name, value: span, checked: span === this.#span,
        on: {change: () => this.#choose(span)},
      }), element('span', {}, label),
    ));
    const joints = element('input', {
      type: 'checkbox', checked: this.#table.classList.contains('is-all'),
      on: {change: (event) => this.#showAll(event.target.checked)},
    });
    return element(
      'div', {class: 'metrics-bar'},
      element('h2', {class: 'metrics-title'}, 'Live session so far'),
      element('div', {class: 'metrics-spans', role: 'radiogroup', 'aria-label': 'Time span'},
        ...spans),
      element('button', {
        class: 'button small', type: 'button', on: {click: () => this.#api.reset()},
        title: 'Back to t = 0: every lane’s figures start over (Backspace)',
      }, icon('reset'), 'Reset'),
      element('label', {class: 'metrics-all'}, joints, element('span', {}, 'all columns')),
    );
  }

  /** @param {'total'|'recent'} span */
  #choose(span) {
    this.#span = span;
    remember('metrics.span', span);
    this.#show();
  }

  /** @param {boolean} all */
  #showAll(all) {
    this.#table.classList.toggle('is-all', all);
    remember('metrics.joints', all ? 'all' : null);
  }

  #show() {
    const {lanes, selected} = this.#api;
    const built = JSON.stringify(lanes);
    if (built !== this.#built) this.#build();
    this.#built = built;
    this.#fill();
    for (const [name, {row, button}] of this.#rows) {
      row.classList.toggle('is-selected', name === selected);
      if (name === selected) button.setAttribute('aria-current', 'true');
      else button.removeAttribute('aria-current');
    }
  }

  #build() {
    this.#rows.clear();
    this.#body.replaceChildren(...this.#api.lanes.map(({name, color}) => {
      const row = this.#row(name, color);
      this.#rows.set(name, row);
      return row.row;
    }));
  }

  /**
   * @param {string} name
   * @param {string} color
   * @returns {Row}
   */
  #row(name, color) {
    const dot = element('span', {class: 'metrics-dot', 'aria-hidden': 'true'});
    dot.style.setProperty('--lane', color);
    const button = element('button', {
      type: 'button', class: 'metrics-lane', title: `Select ${name}`,
      on: {click: () => this.#api.select(name)},
    }, dot, element('span', {}, name));
    const since = element('span', {class: 'metrics-since'});
    const cells = LIVE.map((column) => element('td', {class: classOf(column)}));
    const notes = new MetricsNotes();
    const row = element(
      'tr', {}, element('th', {scope: 'row'}, button, since), ...cells,
      element('td', {class: 'metrics-notes-cell'}, notes.element),
    );
    return {row, button, since, cells, notes};
  }

  #fill() {
    const {metrics, session} = this.#api;
    /** @type {Map<string, Filled>} */
    const lanes = new Map();
    for (const [name, {row, since, notes}] of this.#rows) {
      const known = /** @type {LaneMetrics|undefined} */ (metrics?.lanes?.[name]);
      const state = session?.lanes?.[name];
      const figures = known?.[this.#span] ?? null;
      const margin = known?.margin ?? null;
      const values = LIVE.map(({value}) => value(figures, margin));
      const frozen = state?.status === 'frozen';
      row.classList.toggle('is-frozen', frozen);
      fillSince(since, sinceWords(known?.since ?? null, this.#span));
      notes.show(frozen ? state : null, known?.notes ?? []);
      const from = this.#span === 'total' ? known?.since?.time ?? 0 : 0;
      lanes.set(name, {figures, margin, values, frozen, from});
    }
    LIVE.forEach((column, index) => {
      // What a lane reached before it stopped, or over another time, can't be compared.
      const compared = [...lanes.values()].filter(({frozen}) => !frozen);
      const alike = new Set(compared.map(({from}) => from)).size === 1;
      const merit = alike ? best(column, compared.map(({values}) => values[index])) : null;
      for (const [name, {figures, margin, values, frozen}] of lanes) {
        const cell = /** @type {Row} */ (this.#rows.get(name)).cells[index];
        const {digits} = column.figure;
        const isBest = !frozen && merit !== null && inDigits(values[index], digits) === merit;
        if (column.isMargin) fillMargin(cell, margin);
        else fillCell(cell, column, values[index], figures, isBest);
      }
    });
  }
}

/**
 * @param {HTMLElement} place
 * @param {{text: string, title: string}} words
 */
function fillSince(place, {text, title}) {
  if (place.textContent !== text) place.textContent = text;
  if (place.title !== title) place.title = title;
}

/**
 * @param {HTMLTableCellElement} cell
 * @param {Column} column
 * @param {number|null} value
 * @param {Figures|null} figures
 * @param {boolean} isBest
 */
function fillCell(cell, {joint, figure}, value, figures, isBest) {
  const text = inDigits(value, figure.digits);
  if (cell.textContent !== text) cell.textContent = text;
  cell.classList.toggle('is-best', isBest);
  const words = figure.not_live || [
    joint && figures ? `joint ${joint(figures)}` : '', isBest ? 'best of all lanes' : '',
  ].filter(Boolean).join(', ');
  if (cell.title !== words) cell.title = words;
}

/**
 * @param {HTMLTableCellElement} cell
 * @param {Margin|null} margin
 */
function fillMargin(cell, margin) {
  const warns = marginWarns(margin);
  const text = `${marginText(margin)}${warns ? ' ⚠' : ''}`;
  if (cell.textContent !== text) cell.textContent = text;
  cell.classList.toggle('is-over', warns);
  const words = marginWords(margin);
  if (cell.title !== words) cell.title = words;
}

/** @param {Column} column */
function classOf({extra, figure, id}) {
  return `metrics-number metrics-${id}${extra || figure.not_live ? ' metrics-extra' : ''}`;
}

function heading() {
  return element(
    'tr', {}, element('th', {scope: 'col'}, 'lane'),
    ...LIVE.map((column) => element(
      'th', {scope: 'col', class: classOf(column), title: column.meaning},
      column.title, column.unit && element('span', {class: 'metrics-unit'}, ` ${column.unit}`),
    )),
    element('th', {scope: 'col', class: 'metrics-notes-cell'}, 'notes'),
  );
}
