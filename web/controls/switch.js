// @ts-check
/** On or off. */

import {Control} from './control.js';
import {element} from '../dom/element.js';

/** A field that is a boolean. */
export class SwitchControl extends Control {
  #box;

  /**
   * @param {import('../fields/schema.js').Field} field
   * @param {import('./control.js').Context} context
   */
  constructor(field, context) {
    super(field, context);
    this.#box = element('input', {
      type: 'checkbox', role: 'switch', class: 'switch', id: this.id,
      'aria-describedby': this.describedBy, on: {change: () => this.#choose()},
    });
    this.place.append(this.#box);
  }

  /** @param {boolean} value */
  show(value) { this.#box.checked = value; }

  #choose() {
    this.refuse('');
    this.set(this.#box.checked);
  }
}
