// @ts-check
/** Which gains a search turns, and between which values. */

import {element, symbol} from '../dom/element.js';
import {read, written} from '../fields/quantity.js';
import {valueText} from '../fields/field_names.js';
import {numberBox, refuse} from './form_field.js';
import {usualRange} from './tunable.js';

/** @typedef {import('./tunable.js').Tunable} Tunable */
/** @typedef {{low: number, high: number, joints: string}} Range */

const DIGITS = 4;
const GREATEST = 'Of a gain with other values at other joints, From and To are those of the joint with the '
  + 'greatest one; alike: the others keep their proportion to it.';

/** One row a gain. */
export class GainTable {
  element;
  // On a narrow screen it is no table to look at: its roles say that it is one.
  #body = element('tbody', {role: 'rowgroup'});
  /** @type {GainRow[]} */ #rows = [];
  #greatest = element('p', {class: 'study-meaning study-greatest', hidden: true}, GREATEST);
  #changed;
  #built = '';

  /** @param {() => void} changed */
  constructor(changed) {
    this.#changed = changed;
    const headings = ['Gain', 'Now', 'From', 'To', 'Joints'];
    this.element = element('div', {class: 'study-scroll', tabindex: 0, role: 'region', 'aria-label': 'Gains to search'},
      element('table', {class: 'study-gains', role: 'table'},
        element('thead', {role: 'rowgroup'}, element('tr', {role: 'row'}, ...headings.map((text) => (
          element('th', {scope: 'col', role: 'columnheader'}, text)
        )))), this.#body), this.#greatest);
  }

  /**
   * What was typed stays, as long as the lane has the same gains.
   *
   * @param {string} lane
   * @param {Tunable[]} gains
   */
  show(lane, gains) {
    const built = JSON.stringify([lane, gains.map(({id}) => id)]);
    if (built !== this.#built) {
      this.#built = built;
      this.#rows = gains.map((gain) => new GainRow(gain, this.#changed));
      this.#body.replaceChildren(...this.#rows.map((row) => row.element));
    }
    this.#rows.forEach((row, index) => row.show(gains[index]));
    this.#greatest.hidden = !gains.some(({value}) => Array.isArray(value) && new Set(value).size > 1);
  }

  /** @returns {{[gain: string]: Range}} of those that are ticked */
  get value() {
    return Object.fromEntries(this.#rows.filter(({ticked}) => ticked).map((row) => [row.name, row.value]));
  }

  /**
   * @param {string} name
   * @param {string} text
   * @returns {boolean} whether there is such a gain
   */
  refuse(name, text) {
    const row = this.#rows.find((one) => one.name === name);
    row?.refuse(text);
    return row !== undefined;
  }

  /** Take every refusal back. */
  clear() { for (const row of this.#rows) row.refuse(''); }
}

/** A gain. */
class GainRow {
  element;
  name;
  #tick;
  #low;
  #high;
  #joints;
  #touched = false;
  #now = element('td', {role: 'cell', class: 'study-now'});
  #alert = element('p', {class: 'control-alert', role: 'alert'});

  /**
   * @param {Tunable} gain
   * @param {() => void} changed
   */
  constructor({id, field}, changed) {
    this.name = id;
    const edited = () => { this.refuse(''); changed(); };
    const box = (/** @type {string} */ end) => numberBox({
      'aria-label': `${field.title}, ${end}`,
      on: {input: () => { this.#touched = true; this.#tick.checked = true; edited(); }},
    });
    this.#tick = element('input', {type: 'checkbox', checked: true, on: {change: edited}});
    this.#low = box('from');
    this.#high = box('to');
    this.#joints = field.kind === 'joints' && element('select', {
      class: 'select', 'aria-label': `${field.title}, joints`, on: {change: edited},
    }, element('option', {value: 'alike', title: 'Six values stay in proportion'}, 'alike'),
    element('option', {value: 'each', title: 'Every joint’s value is searched by itself'}, 'each'));
    const label = element('label', {title: field.description}, this.#tick,
      field.symbol ? symbol(field.symbol) : null, element('span', {}, field.title),
      field.unit ? element('span', {class: 'unit'}, field.unit) : null);
    const cell = (/** @type {import('../dom/element.js').Child} */ content) => (
      element('td', {role: 'cell'}, content)
    );
    this.element = element('tr', {role: 'row', 'data-gain': id},
      element('th', {scope: 'row', role: 'rowheader'}, label, this.#alert), this.#now,
      cell(this.#low), cell(this.#high), cell(this.#joints));
  }

  get ticked() { return this.#tick.checked; }

  /** @returns {Range} NaN for what is no number */
  get value() {
    return {
      low: read(this.#low.value, ''), high: read(this.#high.value, ''),
      joints: this.#joints ? this.#joints.value : 'alike',
    };
  }

  /** @param {Tunable} gain */
  show(gain) {
    const text = valueText(gain.value);
    if (this.#now.textContent !== text) this.#now.textContent = text;
    if (this.#touched) return;
    const [low, high] = usualRange(gain).map((end) => written(Number(end.toPrecision(DIGITS))));
    if (this.#low.value !== low) this.#low.value = low;
    if (this.#high.value !== high) this.#high.value = high;
  }

  /** @param {string} text */
  refuse(text) {
    refuse(this.#low, this.#alert, text);
    refuse(this.#high, this.#alert, text);
  }
}
