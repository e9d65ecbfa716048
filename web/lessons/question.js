// @ts-check
/** A question of a lesson: the guess first, then what happened, in words. */

import {element, freshId} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {changes} from './changes.js';

/** @typedef {import('./lesson_document.js').LessonQuestion} Question */

/** One question. */
export class LessonQuestion {
  #question;
  /** @type {HTMLInputElement[]} */ #radios = [];
  #guess;
  #skip;
  // Announced, because it is in the page before it has anything to say.
  #reveal = element('div', {class: 'lesson-reveal', 'aria-live': 'polite'});

  /**
   * @param {Question} question
   * @param {(choice: number|null) => void} answer null to skip the guess
   */
  constructor(question, answer) {
    this.#question = question;
    const name = freshId('lesson-choice');
    this.#guess = element('button', {class: 'button primary', type: 'submit', disabled: true},
      'See what happens');
    this.#skip = element('button', {class: 'button', type: 'button', on: {click: () => answer(null)}},
      'Skip the guess');
    this.#radios = question.choices.map((_, place) => element('input', {
      type: 'radio', name, value: place, on: {change: () => { this.#guess.disabled = false; }},
    }));
    const choices = question.choices.map((text, place) => (
      element('label', {class: 'lesson-choice'}, this.#radios[place], element('span', {}, text))
    ));
    this.element = element('form', {
      class: 'lesson-question',
      on: {submit: (event) => {
        event.preventDefault();
        const chosen = this.#radios.findIndex(({checked}) => checked);
        if (chosen >= 0) answer(chosen);
      }},
    }, element('fieldset', {}, element('legend', {}, question.text), ...choices),
    element('div', {class: 'lesson-guess'}, this.#guess, this.#skip), this.#reveal);
  }

  /** Put the focus on the first choice. */
  focus() { this.#radios[0].focus(); }

  /** Scroll to what was revealed. */
  show() { this.#reveal.scrollIntoView({block: 'nearest'}); }

  /**
   * @param {number|null} guess null for a skipped one
   * @param {import('./lesson_document.js').LessonChange[]} changed what the step has changed
   */
  reveal(guess, changed) {
    const {answer, choices, explanation} = this.#question;
    this.#guess.parentElement?.remove();
    this.#radios.forEach((radio, place) => {
      radio.checked = place === guess;
      radio.disabled = true;
      const label = /** @type {HTMLElement} */ (radio.parentElement);
      label.classList.toggle('is-answer', place === answer);
      const words = [place === guess && 'your guess', place === answer && 'what happens'];
      const tag = words.filter(Boolean).join(', ');
      if (tag) label.append(element('em', {class: 'lesson-tag'}, tag));
    });
    const right = guess === answer;
    const verdict = guess === null ? `What happens: ${choices[answer]}.`
      : right ? 'Right.' : `Not quite. What happens: ${choices[answer]}.`;
    this.#reveal.replaceChildren(
      element('p', {class: right ? 'lesson-verdict is-right' : 'lesson-verdict'},
        guess === null ? null : icon(right ? 'check' : 'close'), element('strong', {}, verdict)),
      ...explanation.map((paragraph) => element('p', {}, paragraph)),
      changes(changed) ?? '',
    );
  }
}
