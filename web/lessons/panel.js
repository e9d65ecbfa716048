// @ts-check
/** The panel of the lessons: the list of them, or one step. */

import {element, freshId} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {changes} from './changes.js';
import {LessonQuestion} from './question.js';

/** @typedef {import('./course.js').Course} Course */
/** @typedef {import('./lesson_document.js').LessonSummary & import('./progress.js').Progress} Row */
/**
 * @typedef {object} Actions what the panel asks for
 * @property {(name: string) => void} begin a lesson
 * @property {(way: 1|-1) => void} move one step on or back
 * @property {(choice: number|null) => void} answer the question
 * @property {() => void} retry what was refused
 * @property {() => void} list end the lesson and choose another
 * @property {() => void} keep end the lesson with its experiment
 * @property {() => void} close
 */

/** One panel; `element` goes wherever it is to be seen. */
export class LessonPanel {
  #actions;
  #figures;
  #head = element('header', {class: 'lesson-head'});
  #body = element('div', {class: 'lesson-body'});
  #alert = element('div', {class: 'lesson-alert', role: 'alert'});
  #foot = element('footer', {class: 'lesson-foot'});
  /** A sheet on a small screen is in the way of what it talks about. */
  #fold = element('button', {
    class: 'button icon-only small lesson-fold', type: 'button', 'aria-expanded': 'true',
    'aria-label': 'Text of the lesson',
    on: {click: () => this.#folded(this.#fold.getAttribute('aria-expanded') === 'true')},
  }, icon('down'));
  /** @type {LessonQuestion|null} */ #question = null;
  /** @type {Course|null} */ #course = null;
  /** @type {HTMLButtonElement|null} */ #next = null;

  /**
   * @param {Actions} actions
   * @param {import('./figures.js').LessonFigures} figures
   */
  constructor(actions, figures) {
    this.#actions = actions;
    this.#figures = figures;
    this.element = element('section', {
      class: 'lesson', 'aria-label': 'Lessons', on: {keydown: (event) => this.#pressed(event)},
    }, this.#head, this.#body, this.#alert, this.#foot);
  }

  /** Put the focus on what is to be read first. */
  focus() {
    const first = /** @type {HTMLElement|null} */ (
      this.#body.querySelector('.lesson-title, .lesson-row')
    );
    first?.focus();
  }

  /** @param {boolean} folded */
  #folded(folded) {
    this.#fold.setAttribute('aria-expanded', String(!folded));
    this.element.classList.toggle('is-folded', folded);
  }

  /** Lead to the question. */
  ask() {
    this.#folded(false);
    this.#question?.focus();
  }

  /** @param {boolean} waiting whether the server is being asked */
  wait(waiting) { this.element.toggleAttribute('data-waiting', waiting); }

  /** @param {string} message */
  refuse(message) {
    const retry = element('button', {
      class: 'button small', type: 'button',
      on: {click: () => { this.#alert.replaceChildren(); this.#actions.retry(); }},
    }, 'Try again');
    this.#alert.replaceChildren(element('span', {}, `That did not work: ${message}`),
      ...(this.#course ? [retry] : []));
  }

  /** @param {Row[]} rows */
  showList(rows) {
    this.#course = null;
    this.#question = null;
    this.#alert.replaceChildren();
    this.#head.replaceChildren(element('h2', {class: 'lesson-name'}, 'Lessons'),
      this.#fold, this.#close());
    this.#body.replaceChildren(
      element('p', {class: 'lesson-hint'}, 'Each sets up its own experiment, asks what you '
        + 'expect and shows what happens. Yours is restored afterwards.'),
      element('ol', {class: 'lesson-list'}, ...rows.map((row) => this.#row(row))),
    );
    this.#foot.replaceChildren();
    this.#folded(false);
    this.#body.scrollTop = 0;
    this.focus();
  }

  /** @param {Row} row */
  #row({name, title, summary, minutes, steps, furthest, done}) {
    const begun = furthest > 0 ? `step ${furthest} of ${steps}` : `${minutes} min`;
    const state = element('span', {class: 'lesson-state'}, done && icon('check'), done ? 'done' : begun);
    return element('li', {}, element('button', {
      class: 'lesson-row', type: 'button', 'data-lesson': name,
      on: {click: () => this.#actions.begin(name)},
    }, element('strong', {}, title), state, element('span', {class: 'lesson-summary'}, summary)));
  }

  /** @param {Course} course */
  showStep(course) {
    const {lesson, step, index} = course;
    this.#course = course;
    this.#alert.replaceChildren();
    const back = element('button', {
      class: 'button icon-only small lesson-back', type: 'button',
      'aria-label': 'All lessons: ends this one and restores your experiment',
      title: 'All lessons (restores your experiment)', on: {click: () => this.#actions.list()},
    }, icon('chevron'));
    this.#head.replaceChildren(back, element('span', {class: 'lesson-name'}, lesson.title),
      this.#fold, this.#close());
    const id = freshId('lesson-step');
    const count = `Step ${index + 1} of ${lesson.steps.length}`;
    // What is quoted before the answer stands above the question, and what it shows below it.
    const asked = course.isAsking;
    this.#figures.show((asked ? null : step.question?.figures) ?? step.figures);
    this.#question = step.question && new LessonQuestion(step.question, this.#actions.answer);
    this.#body.replaceChildren(
      element('div', {class: 'lesson-text'},
        element('h2', {id, class: 'lesson-title', tabindex: -1},
          element('small', {}, count), element('span', {}, step.title)),
        ...step.text.map((paragraph) => element('p', {}, paragraph)),
        step.question ? null : changes(step.changes)),
      ...(asked ? [this.#figures.element] : []), this.#question?.element ?? '',
      ...(asked ? [] : [this.#figures.element]),
    );
    if (this.#question && !course.isAsking) this.#question.reveal(course.guess ?? null, step.changes);
    this.#foot.replaceChildren(...this.#buttons(course));
    this.#folded(false);
    this.#body.scrollTop = 0;
    this.focus();
  }

  /**
   * Show what the change has done, and whether it was foreseen.
   *
   * @param {Course} course
   */
  reveal(course) {
    this.#alert.replaceChildren();
    this.#question?.reveal(course.guess ?? null, course.step.changes);
    this.#figures.show(course.step.question?.figures ?? []);
    this.#body.append(this.#figures.element);
    this.#foot.replaceChildren(...this.#buttons(course));
    this.#next?.focus();
    this.#question?.show();
  }

  /** @param {Course} course */
  #buttons(course) {
    const {index, isLast, isAsking, lesson} = course;
    const back = element('button', {
      class: 'button', type: 'button', disabled: index === 0,
      on: {click: () => this.#actions.move(-1)},
    }, 'Back');
    this.#next = element('button', {
      class: isAsking ? 'button' : 'button primary', type: 'button', disabled: isAsking,
      title: isAsking ? 'Guess first, or skip the guess' : null,
      on: {click: () => this.#actions.move(1)},
    }, isLast ? 'Finish' : 'Next');
    const keep = element('button', {
      class: 'button', type: 'button', title: 'End the lesson and keep the experiment as it is now',
      on: {click: () => this.#actions.keep()},
    }, 'Keep this experiment');
    const bar = element('progress', {max: lesson.steps.length, 'aria-label': 'Progress'});
    bar.value = index + (isAsking ? 0 : 1);
    return [back, isLast && !isAsking ? keep : bar, this.#next];
  }

  #close() {
    const hint = this.#course ? 'Close: ends the lesson and restores your experiment' : 'Close';
    return element('button', {
      class: 'button icon-only small', type: 'button', 'aria-label': hint, title: hint,
      on: {click: () => this.#actions.close()},
    }, icon('close'));
  }

  /** @param {KeyboardEvent} event */
  #pressed(event) {
    const {key, target} = event;
    const way = new Map([['ArrowRight', 1], ['ArrowLeft', -1]]).get(key);
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    // A group of radio buttons has its own use for arrows.
    const isChoice = /** @type {Element} */ (target).matches('input');
    if (key.startsWith('Arrow')) event.stopPropagation();
    if (way && this.#course && !isChoice) {
      event.preventDefault();
      this.#actions.move(/** @type {1|-1} */ (way));
    } else if (key === 'Escape' && !this.#course) {
      event.stopPropagation();
      this.#actions.close();
    }
  }
}
