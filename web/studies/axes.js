// @ts-check
/** What a sweep goes through: one field or two, and their values. */

import {element} from '../dom/element.js';
import {read, written} from '../fields/quantity.js';
import {numberBox, refuse} from './form_field.js';
import {spansDecade, usualRange} from './tunable.js';

/** @typedef {import('./tunable.js').Tunable} Tunable */
/** @typedef {{field: string, low: number, high: number, count: number, logarithmic: boolean}} Axis */

const DIGITS = 4;
const COUNT = 20;
/** Of each of two. */
const COUNT_OF_TWO = 12;

/** One row a field, two at most. */
export class Axes {
  element;
  #rows = element('div', {class: 'study-axes'});
  /** @type {AxisRow[]} */ #axes = [];
  #more;
  #total = element('p', {class: 'study-total'});
  #changed;
  /** @type {Tunable[]} */ #fields = [];
  #built = '';

  /** @param {() => void} changed */
  constructor(changed) {
    this.#changed = () => { this.#tell(); changed(); };
    this.#more = element('button', {
      class: 'button small', type: 'button', on: {click: () => this.#second()},
    }, 'Add a second field');
    this.element = element('div', {}, this.#rows, this.#more, this.#total);
  }

  /** @param {Tunable[]} fields those that can be swept */
  show(fields) {
    this.#fields = fields;
    const built = JSON.stringify(fields.map(({id}) => id));
    if (built === this.#built) return;
    this.#built = built;
    if (!this.#axes.length) this.#axes = [this.#row(COUNT, [])];
    for (const axis of this.#axes) axis.offer(fields);
    this.#draw();
  }

  /**
   * @param {number} count
   * @param {string[]} taken fields that are swept already
   */
  #row(count, taken) {
    const row = new AxisRow(this.#changed, () => this.#remove(row));
    row.offer(this.#fields);
    const free = this.#fields.find(({id}) => !taken.includes(id));
    if (free) row.choose(free.id);
    row.count = count;
    return row;
  }

  #second() {
    const [first] = this.#axes;
    if (first.value.count === COUNT) first.count = COUNT_OF_TWO;
    this.#axes = [first, this.#row(COUNT_OF_TWO, [first.value.field])];
    this.#draw();
    this.#axes[1].focus();
    this.#changed();
  }

  /** @param {AxisRow} row */
  #remove(row) {
    this.#axes = this.#axes.filter((one) => one !== row);
    this.#draw();
    this.#more.focus();
    this.#changed();
  }

  #draw() {
    this.#axes.forEach((axis) => axis.removable(this.#axes.length > 1));
    this.#rows.replaceChildren(...this.#axes.map((axis) => axis.element));
    this.#more.hidden = this.#axes.length > 1;
    this.#tell();
  }

  #tell() {
    const runs = this.value.reduce((product, {count}) => product * count, 1);
    this.#total.textContent = Number.isFinite(runs) ? `${runs} runs` : '';
  }

  /** @returns {Axis[]} NaN for what is no number */
  get value() { return this.#axes.map((axis) => axis.value); }

  /**
   * @param {string} path of a refusal
   * @param {string} text
   * @returns {boolean} whether it is about one of the fields
   */
  refuse(path, text) {
    const place = /^axes\W?(\d)/.exec(path)?.[1];
    const row = this.#axes[Number(place ?? NaN)]
      ?? this.#axes.find(({value: {field}}) => path === field || path.endsWith(`.${field}`));
    row?.refuse(text);
    return row !== undefined;
  }

  /** Take every refusal back. */
  clear() { for (const axis of this.#axes) axis.refuse(''); }
}

/** A field and its values. */
class AxisRow {
  element;
  #select;
  #low;
  #high;
  #count;
  #log;
  #remove;
  #unit = element('span', {class: 'unit'});
  #alert = element('p', {class: 'control-alert', role: 'alert'});
  /** @type {Tunable[]} */ #fields = [];

  /**
   * @param {() => void} changed
   * @param {() => void} remove
   */
  constructor(changed, remove) {
    const edited = () => { this.refuse(''); changed(); };
    const box = (/** @type {string} */ name) => numberBox({'aria-label': name, on: {input: edited}});
    [this.#low, this.#high, this.#count] = ['From', 'To', 'Values'].map(box);
    this.#select = element('select', {
      class: 'select', 'aria-label': 'Field', on: {change: () => { this.#usual(); edited(); }},
    });
    this.#log = element('input', {type: 'checkbox', on: {change: edited}});
    this.#remove = element('button', {
      class: 'button small', type: 'button', 'aria-label': 'Remove this field', on: {click: remove},
    }, 'Remove');
    this.element = element('fieldset', {class: 'study-axis'},
      element('legend', {class: 'visually-hidden'}, 'A field and its values'),
      element('div', {class: 'study-row'}, this.#select, this.#remove),
      element('div', {class: 'study-row'}, element('span', {}, 'from'), this.#low,
        element('span', {}, 'to'), this.#high, this.#unit, element('span', {}, 'in'), this.#count,
        element('span', {}, 'values'),
        element('label', {class: 'study-tick', title: 'Their ratio is even, not their distance'},
          this.#log, 'logarithmic')),
      this.#alert);
  }

  /** @param {Tunable[]} fields */
  offer(fields) {
    this.#fields = fields;
    const before = this.#select.value;
    const groups = Map.groupBy(fields, ({group}) => group);
    this.#select.replaceChildren(...[...groups].map(([label, some]) => element(
      'optgroup', {label}, ...some.map(({id, field}) => element('option', {value: id}, nameOf(field))),
    )));
    if (fields.some(({id}) => id === before)) this.#select.value = before;
    else this.#usual();
  }

  /** @param {string} id */
  choose(id) {
    this.#select.value = id;
    this.#usual();
  }

  /** @param {number} count */
  set count(count) { this.#count.value = String(count); }

  focus() { this.#select.focus(); }

  /** @param {boolean} can */
  removable(can) { this.#remove.hidden = !can; }

  #usual() {
    const chosen = this.#fields.find(({id}) => id === this.#select.value);
    if (!chosen) return;
    const [low, high] = usualRange(chosen).map((end) => Number(end.toPrecision(DIGITS)));
    this.#low.value = written(low);
    this.#high.value = written(high);
    this.#log.checked = spansDecade(low, high);
    this.#unit.textContent = chosen.field.unit;
  }

  /** @returns {Axis} */
  get value() {
    const {unit = ''} = this.#fields.find(({id}) => id === this.#select.value)?.field ?? {};
    return {
      field: this.#select.value, low: read(this.#low.value, unit), high: read(this.#high.value, unit),
      count: read(this.#count.value, ''), logarithmic: this.#log.checked,
    };
  }

  /** @param {string} text */
  refuse(text) { for (const box of [this.#low, this.#high, this.#count]) refuse(box, this.#alert, text); }
}

/** @param {import('../fields/schema.js').Field} field */
function nameOf({symbol, title, unit}) {
  return `${symbol ? `${symbol.replace('_', '')} · ` : ''}${title}${unit ? ` [${unit}]` : ''}`;
}
