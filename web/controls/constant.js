// @ts-check
/** What can be read and not chosen. */

import {Control} from './control.js';
import {element} from '../dom/element.js';

/** A field with one possible value, or of a kind that has no control. */
export class ConstantControl extends Control {
  #text = element('span', {class: 'constant'});

  /**
   * @param {import('../fields/schema.js').Field} field
   * @param {import('./control.js').Context} context
   */
  constructor(field, context) {
    super(field, context);
    this.label.removeAttribute('for');
    this.place.append(this.#text);
  }

  /** @param {any} value */
  show(value) { this.#text.textContent = this.inText(value); }
}
