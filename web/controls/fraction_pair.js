// @ts-check
/** One fraction: a list of pairs, and two boxes for any other, which are taken together. */

import {element} from '../dom/element.js';
import {isTravel} from '../screen/keys.js';
import {read, written} from '../fields/quantity.js';

/** @typedef {[number, number]} Pair numerator and denominator */
/**
 * @typedef {object} PairOptions
 * @property {readonly Pair[]} pairs to choose from
 * @property {string} name
 * @property {[string, string]} parts names of numerator and denominator
 * @property {string} [id] of the list, for a label
 * @property {string} [describedBy]
 * @property {(pair: Pair) => void} choose
 * @property {(text: string) => void} refuse
 */

const OTHER = 'other';
const SEVERAL = 'several';

/** While a person types in a box, what the server says doesn't change it. */
export class FractionPair {
  /** @type {Pair} */ value = [NaN, NaN];
  select;
  boxes;
  #options;
  #several;
  #place;
  #typed = false;
  /** Whether the boxes were asked for. */
  #asked = false;

  /** @param {PairOptions} options */
  constructor(options) {
    this.#options = options;
    const {pairs, name, parts, id, describedBy} = options;
    this.#several = element('option', {value: SEVERAL, hidden: true, disabled: true}, 'joint by joint');
    this.select = element('select', {
      class: 'select', id, 'aria-label': id ? null : name, 'aria-describedby': describedBy,
      on: {change: () => this.#chosen()},
    }, this.#several, ...pairs.map((pair) => (
      element('option', {value: keyOf(pair)}, inWords(pair))
    )), element('option', {value: OTHER}, 'other …'));
    this.boxes = parts.map((part) => element('input', {
      type: 'text', inputmode: 'numeric', class: 'number-box', 'aria-label': `${name}, ${part}`,
      'aria-describedby': describedBy, autocomplete: 'off', spellcheck: 'false',
      on: {
        focus: ({target}) => target.select(),
        input: ({inputType}) => {
          if (inputType.startsWith('history')) this.#revert();
          else this.#typed = true;
        },
        keydown: (event) => this.#key(event),
      },
    }));
    this.#place = element('span', {class: 'fraction-boxes', hidden: true, on: {
      focusout: ({relatedTarget}) => { if (!this.boxes.includes(relatedTarget)) this.#accept(); },
    }}, this.boxes[0], element('span', {'aria-hidden': 'true'}, '/'), this.boxes[1]);
  }

  /** What belongs side by side. */
  get elements() { return [this.select, this.#place]; }

  get held() { return this.#typed; }

  /**
   * Show the server's value, unless a person types another.
   *
   * @param {Pair|null} value null where there are several
   */
  set(value) {
    const key = value ? keyOf(value) : SEVERAL;
    const isNews = value !== null && key !== keyOf(this.value);
    if (value) this.value = value;
    this.#several.hidden = value !== null;
    if (this.held) return;
    const listed = value === null || this.#options.pairs.some((pair) => keyOf(pair) === key);
    // A refusal leaves the boxes open: what it says is to be mended there.
    if (!listed) this.#asked = true;
    else if (isNews) this.#asked = false;
    this.#place.hidden = !this.#asked;
    this.select.value = this.#asked ? OTHER : key;
    this.boxes.forEach((box, index) => { box.value = written(this.value[index]); });
  }

  #chosen() {
    const {pairs, choose, refuse} = this.#options;
    refuse('');
    const pair = pairs.find((one) => keyOf(one) === this.select.value);
    this.#asked = !pair;
    this.#place.hidden = !this.#asked;
    if (pair) choose(pair);
    else this.boxes[0].focus();
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (isTravel(event) && this.#typed) {
      event.preventDefault();
      this.#revert();
    }
    if (event.key === 'Enter') this.#accept();
    if (event.key === 'Escape') this.#forget();
  }

  /** Show what is, in place of what was typed. */
  #revert() {
    this.#typed = false;
    this.set(this.value);
  }

  /** Take both boxes at once. */
  #accept() {
    if (!this.#typed) return;
    this.#typed = false;
    const numbers = this.boxes.map((box) => read(box.value, ''));
    const wrong = numbers.findIndex((number) => !Number.isFinite(number));
    if (wrong >= 0) {
      this.#options.refuse(`“${this.boxes[wrong].value}” is not a number`);
      this.set(this.value);
      return;
    }
    this.#options.choose([numbers[0], numbers[1]]);
  }

  #forget() {
    this.#typed = false;
    this.#asked = false;
    this.set(this.value);
    this.select.focus();
  }
}

/** @param {Pair} pair */
function keyOf([above, below]) { return `${above}/${below}`; }

/** @param {Pair} pair */
function inWords([above, below]) {
  return `${above}/${below} = ${written(Number((above / below).toPrecision(3)))}`;
}
