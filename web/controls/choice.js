// @ts-check
/** One of a few words: side by side where they fit, else a list. */

import {Control} from './control.js';
import {element, freshId} from '../dom/element.js';

const MOST_BESIDE = 4;
const LONGEST_BESIDE = 24;

/** A field that is one of its options. */
export class ChoiceControl extends Control {
  /** @type {(value: string) => void} */ #mark;

  /**
   * @param {import('../fields/schema.js').Field} field
   * @param {import('./control.js').Context} context
   */
  constructor(field, context) {
    super(field, context);
    const {options} = field;
    const short = options.length <= MOST_BESIDE && options.join('').length <= LONGEST_BESIDE;
    this.#mark = short ? this.#segments() : this.#list();
  }

  /** @param {string} value */
  show(value) { this.#mark(value); }

  /** @param {string} value */
  #choose(value) {
    this.refuse('');
    this.set(value);
  }

  #segments() {
    const group = freshId('choice');
    const radios = this.field.options.map((option) => element('input', {
      type: 'radio', name: group, value: option, 'aria-describedby': this.describedBy,
      on: {change: () => this.#choose(option)},
    }));
    this.label.removeAttribute('for');
    this.label.id = this.id;
    this.place.append(element(
      'div', {class: 'segments', role: 'radiogroup', 'aria-labelledby': this.id},
      ...radios.map((radio) => element('label', {}, radio, element('span', {}, radio.value))),
    ));
    return (/** @type {string} */ value) => {
      for (const radio of radios) radio.checked = radio.value === value;
    };
  }

  #list() {
    const options = this.field.options.map((option) => element('option', {value: option}, option));
    const select = element('select', {
      id: this.id, class: 'select', 'aria-describedby': this.describedBy,
      on: {change: () => this.#choose(select.value)},
    }, ...options);
    this.place.append(select);
    return (/** @type {string} */ value) => { select.value = value; };
  }
}
