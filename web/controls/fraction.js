// @ts-check
/** Two fields that only make sense together: a numerator and a denominator. */

import {Control, disclosure} from './control.js';
import {element} from '../dom/element.js';
import {FractionPair} from './fraction_pair.js';
import {patchAt} from '../fields/merge_patch.js';
import {written} from '../fields/quantity.js';

/** @typedef {import('../fields/schema.js').Field} Field */
/** @typedef {import('./fraction_pair.js').Pair} Pair */
/** @typedef {number|number[]} Part a number for all joints, or one each */

/** One edit sets both fields, for all joints or for one. */
export class FractionControl extends Control {
  #parts;
  #all;
  /** @type {FractionPair[]} */ #each;

  /**
   * @param {Field} above the numerator
   * @param {Field} below the denominator
   * @param {import('./control.js').Context} context
   */
  constructor(above, below, context) {
    const {title, symbol, pairs} = /** @type {NonNullable<Field['fraction']>} */ (above.fraction);
    super({...above, title, symbol}, context);
    this.#parts = [above, below];
    this.element.classList.add('is-fraction');
    const names = Array.from({length: above.length}, (_, index) => `J${index + 1}`);
    const pair = (/** @type {string} */ name, /** @type {(pair: Pair) => void} */ choose,
      /** @type {string} */ id = '') => new FractionPair({
      pairs,
      name,
      parts: [above.title, below.title],
      id: id || undefined,
      describedBy: this.describedBy,
      choose,
      refuse: (text) => this.refuse(text),
    });
    this.#all = pair(this.name, (value) => this.set(value), this.id);
    this.#each = names.map((name, index) => pair(`${this.name}, ${name}`, (value) => {
      const values = this.#each.map((one, at) => (at === index ? value : one.value));
      this.set([values.map(([over]) => over), values.map(([, under]) => under)]);
    }));
    const rows = this.#each.map((one, index) => element('div', {class: 'joint-row'},
      element('span', {class: 'joint-name'}, names[index]), ...one.elements));
    const list = element('div', {class: 'joint-list', role: 'group', 'aria-label': this.name}, ...rows);
    const {button} = disclosure(`${this.name}: each joint`, list);
    button.hidden = names.length === 1;
    this.place.append(...this.#all.elements, button);
    this.element.append(list);
  }

  get fields() { return this.#parts; }

  get current() {
    const values = this.fields.map((field) => this.currentOf(field));
    return values.includes(undefined) ? undefined : values;
  }

  get baseline() { return this.fields.map((field) => this.baselineOf(field)); }

  get held() { return [this.#all, ...this.#each].some((pair) => pair.held); }

  /** @param {[Part, Part]} value */
  show([above, below]) {
    const alike = !Array.isArray(above) && !Array.isArray(below);
    this.#all.set(alike ? [above, below] : null);
    this.#each.forEach((pair, index) => pair.set([at(above, index), at(below, index)]));
  }

  /** @param {[Part, Part]} value */
  inText([above, below]) {
    if (!Array.isArray(above) && !Array.isArray(below)) return `${written(above)}/${written(below)}`;
    return this.#each.map((_, index) => (
      `${written(at(above, index))}/${written(at(below, index))}`
    )).join(', ');
  }

  /**
   * @protected
   * @param {[Part, Part]} value
   */
  set([above, below]) {
    const keys = this.fields.map(({path}) => path[path.length - 1]);
    return this.setAll(this.field.path.slice(0, -1), {
      ...patchAt([keys[0]], above), ...patchAt([keys[1]], below),
    });
  }
}

/**
 * @param {Part} part
 * @param {number} index
 */
function at(part, index) { return Array.isArray(part) ? part[index] : part; }
