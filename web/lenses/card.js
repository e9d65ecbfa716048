// @ts-check
/** The frame of one picture of a lens: title, equation, two lines of words, figures, a finding. */

import {element, freshId} from '../dom/element.js';

/** @typedef {import('../dom/element.js').Child} Child */
/** @typedef {{name: string, value: string, title?: string}} Fact */

/**
 * What is known of the chosen lane when a lens is shown.
 * @typedef {{seen: any, lane: string, color: string, joint: number, horizon: number,
 *   hold: number, gains: {[name: string]: any}, experiment: {[section: string]: any}}} Look
 *   `experiment`: that was run; `hold`: for so long in [s] a sampled
 *   controller holds a torque, 0 where nothing is sampled
 */

/** One picture with what it says. */
export class LensCard {
  /** @type {HTMLElement} */ element;
  #facts = element('dl', {class: 'lens-facts'});
  #finding = element('p', {class: 'lens-finding'});
  #words = element('p', {class: 'lens-words'});

  /**
   * @param {{title: string, equation: string, words: string}} text
   * @param {...Child} content the picture and what belongs to it
   */
  constructor({title, equation, words}, ...content) {
    const id = freshId('lens-card');
    this.#words.textContent = words;
    this.element = element(
      'section', {class: 'lens-card', 'aria-labelledby': id},
      element(
        'div', {class: 'lens-heading'}, element('h3', {id}, title),
        element('span', {class: 'lens-equation'}, equation),
      ),
      this.#words, ...content, this.#facts, this.#finding,
    );
  }

  /** @param {Fact[]} facts */
  set facts(facts) {
    this.#facts.replaceChildren(...facts.map(({name, value, title}) => element(
      'div', {title}, element('dt', {}, name), element('dd', {}, value),
    )));
  }

  /** @param {string} text what these very numbers say */
  set finding(text) {
    this.#finding.hidden = !text;
    if (this.#finding.textContent !== text) this.#finding.textContent = text;
  }

  /** @param {string} text */
  set words(text) {
    if (this.#words.textContent !== text) this.#words.textContent = text;
  }
}

/**
 * Two ways to see a picture; the chosen one is pressed.
 *
 * @param {string} label
 * @param {{id: string, title: string}[]} choices
 * @param {(id: string) => void} choose
 * @returns {HTMLElement}
 */
export function choice(label, choices, choose) {
  const buttons = choices.map(({id, title}, index) => element('button', {
    type: 'button', class: 'lens-choice', 'aria-pressed': String(index === 0),
    on: {click: (event) => {
      for (const button of buttons) {
        button.setAttribute('aria-pressed', String(button === event.currentTarget));
      }
      choose(id);
    }},
  }, title));
  return element('div', {class: 'lens-choices', role: 'group', 'aria-label': label}, ...buttons);
}

/** @param {number} share 0 to 1 */
export function percent(share) {
  const value = 100 * share;
  const text = value > 0 && value < 0.95 ? value.toPrecision(1) : value.toFixed(0);
  return `${text.replace('-', '−')} %`;
}
