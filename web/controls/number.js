// @ts-check
/** One number: slider, box and unit. */

import {Control} from './control.js';
import {element} from '../dom/element.js';
import {NumberPair} from './number_pair.js';

/** A field that is a single number. */
export class NumberControl extends Control {
  #pair;

  /**
   * @param {import('../fields/schema.js').Field} field
   * @param {import('./control.js').Context} context
   */
  constructor(field, context) {
    super(field, context);
    this.#pair = new NumberPair({
      field,
      name: this.name,
      id: this.id,
      describedBy: this.describedBy,
      move: (value) => this.move(value),
      commit: () => this.commit(),
      cancel: () => this.cancel(),
      watch: (interrupt) => this.watch(interrupt),
      settle: () => this.settle(),
      reset: () => this.reset(),
      refuse: (text) => this.refuse(text),
    });
    this.beside.append(element('span', {class: 'unit'}, field.unit));
    this.place.append(this.#pair.slider, this.#pair.box);
  }

  get held() { return this.#pair.held; }

  /**
   * @param {number} value
   * @param {number} baseline
   */
  show(value, baseline) { this.#pair.set(value, baseline); }
}
