// @ts-check
/** One field of the form: a number, a choice or a tick, its meaning, and why it was refused. */

import {element, freshId} from '../dom/element.js';
import {read, written} from '../fields/quantity.js';

/** @typedef {import('../fields/schema.js').Field} Field */

/** A labelled input. */
export class FormField {
  element;
  name;
  #field;
  #input;
  #edited = false;
  #alert = element('p', {class: 'control-alert', role: 'alert'});

  /**
   * @param {Field} field
   * @param {() => void} changed
   */
  constructor(field, changed) {
    const [id, meaning] = [freshId('study-field'), freshId('study-meaning')];
    this.#field = field;
    this.name = field.path[field.path.length - 1];
    const edited = () => {
      this.#edited = true;
      this.refuse('');
      changed();
    };
    this.#input = inputOf(field, {id, 'aria-describedby': meaning, on: {input: edited}});
    this.suggest(field.default);
    this.element = element('div', {class: 'study-field', 'data-field': this.name},
      element('label', {for: id, title: field.description}, field.title), this.#input,
      element('small', {id: meaning, class: 'study-meaning'}, field.description), this.#alert);
  }

  /** @returns {any} NaN for what is no number */
  get value() {
    const {kind} = this.#field;
    if (kind === 'switch') return /** @type {HTMLInputElement} */ (this.#input).checked;
    return kind === 'choice' ? this.#input.value : read(this.#input.value, '');
  }

  /** @param {any} value what it is as long as nobody edits it */
  suggest(value) {
    if (this.#edited) return;
    const {kind} = this.#field;
    if (kind === 'switch') /** @type {HTMLInputElement} */ (this.#input).checked = value;
    else this.#input.value = kind === 'choice' ? value : written(value);
  }

  /** @param {string} text why, or '' */
  refuse(text) { refuse(this.#input, this.#alert, text); }
}

/**
 * @param {Field} field
 * @param {import('../dom/element.js').Attributes} shared
 */
function inputOf({kind, options}, shared) {
  if (kind === 'switch') return element('input', {type: 'checkbox', ...shared});
  if (kind !== 'choice') return numberBox(shared);
  return element('select', {class: 'select', ...shared},
    ...options.map((option) => element('option', {value: option}, option)));
}

/**
 * A box for one number.
 *
 * @param {import('../dom/element.js').Attributes} attributes
 */
export function numberBox(attributes) {
  return element('input', {
    class: 'number-box', inputmode: 'decimal', autocomplete: 'off', spellcheck: 'false', ...attributes,
  });
}

/**
 * @param {HTMLElement} input
 * @param {HTMLElement} alert
 * @param {string} text why, or ''
 */
export function refuse(input, alert, text) {
  if (alert.textContent !== text) alert.textContent = text;
  if (text) input.setAttribute('aria-invalid', 'true');
  else input.removeAttribute('aria-invalid');
}
