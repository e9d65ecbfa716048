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
  show(value) {
    const text = this.inText(value);
    const lines = text.trim().split('\n').length;
    // A table, such as the waypoints of a recorded motion, is for its file.
    this.#text.textContent = lines > 1 ? `${lines} lines` : text;
  }
}
