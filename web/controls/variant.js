// @ts-check
/** Which variant of a section it is, such as the kind of trajectory. */

import {ChoiceControl} from './choice.js';
import {valueAt} from '../fields/merge_patch.js';
import {inWords} from '../fields/schema.js';

/** A choice whose reset brings the preset's whole section back. */
export class VariantControl extends ChoiceControl {
  #section;
  #api;

  /**
   * @param {import('../fields/schema.js').Schema} schema
   * @param {import('../fields/schema.js').Section} section
   * @param {import('./control.js').Context} context
   */
  constructor(schema, section, context) {
    const tag = schema.tag(section);
    const variants = schema.variants(section);
    super({
      kind: 'choice',
      path: [...section.path, tag],
      title: inWords(tag),
      description: variants.map(({name, description}) => `${name}: ${description}`).join(' '),
      symbol: '', unit: '', equation: '', group: '', applies: '', needs: {}, source: '',
      minimum: -Infinity, maximum: Infinity, step: 1, log: false, odd: false, integer: false,
      fraction: null, nullable: false, length: 1,
      options: variants.map(({name}) => name),
      default: variants[0].name,
    }, context);
    this.#section = section;
    this.#api = context.api;
  }

  get baseline() { return valueAt(this.#api.baseline, this.field.path); }

  reset() {
    this.refuse('');
    this.setAll(this.#section.path, valueAt(this.#api.baseline, this.#section.path));
  }
}
