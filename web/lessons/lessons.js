// @ts-check
/** Lessons: the list, the one that is under way, and the way back out of it. */

import {isBeginningAnew} from '../api/arm.js';
import {Course, presentState} from './course.js';
import {LessonFigures} from './figures.js';
import {LessonPanel} from './panel.js';
import {noteOpenLesson, noteProgress, openLesson, progressOf} from './progress.js';
import {tellWithUndo} from '../dom/undo_notice.js';

/** @typedef {import('../api/api.js').Api} Api */

/**
 * @param {HTMLElement} workspace where the panel goes; it has the class `has-lesson` meanwhile
 * @param {Api} api the event `learn` opens the list
 * @param {import('../api/undo.js').History} history
 * @param {import('../dom/notices.js').Tell} tell
 */
export function mount(workspace, api, history, tell) { new Lessons(workspace, api, history, tell); }

class Lessons {
  #workspace;
  #api;
  #history;
  #tell;
  /** @type {Course|null} */ #course = null;
  /** @type {Element|null} what had the focus before the panel was opened */ #former = null;
  #busy = false;
  #panel;

  /**
   * @param {HTMLElement} workspace
   * @param {Api} api
   * @param {import('../api/undo.js').History} history
   * @param {import('../dom/notices.js').Tell} tell
   */
  constructor(workspace, api, history, tell) {
    this.#workspace = workspace;
    this.#api = api;
    this.#history = history;
    this.#tell = tell;
    this.#panel = new LessonPanel({
      begin: (name) => this.#begin(name),
      move: (way) => this.#move(way),
      answer: (choice) => this.#answer(choice),
      retry: () => this.#enter(this.#course?.index ?? 0),
      list: () => this.#leave({restore: true}),
      keep: () => this.#leave({restore: false}),
      close: () => this.#close(),
    }, new LessonFigures(api));
    api.addEventListener('learn', () => this.#toggle());
    if (openLesson()) api.addEventListener('hello', () => this.#resume(), {once: true});
  }

  get #isOpen() { return this.#panel.element.isConnected; }

  #toggle() {
    if (this.#course) this.#panel.focus();
    else if (this.#isOpen) this.#close();
    else this.#list();
  }

  #show() {
    if (this.#isOpen) return;
    this.#former = document.activeElement;
    this.#workspace.append(this.#panel.element);
    this.#workspace.classList.add('has-lesson');
  }

  async #list() {
    this.#show();
    await this.#guarded(async () => {
      const lessons = await this.#api.lessons();
      this.#panel.showList(lessons.map((lesson) => ({...lesson, ...progressOf(lesson.name)})));
    });
  }

  /** @param {string} name */
  async #begin(name) {
    await this.#guarded(async () => {
      const lesson = await this.#api.lesson(name);
      const before = presentState(this.#api);
      const {furthest, done} = progressOf(name);
      const index = done ? 0 : Math.max(0, Math.min(furthest, lesson.steps.length) - 1);
      this.#course = new Course(this.#api, this.#history, lesson, {
        name, index, guesses: {}, before,
      });
    });
    if (this.#course) await this.#enter(this.#course.index);
  }

  /** Go on where the page was left; the server has kept the experiment. */
  async #resume() {
    const standing = openLesson();
    if (!standing || this.#course) return;
    try {
      const lesson = await this.#api.lesson(standing.name);
      const index = Math.min(standing.index, lesson.steps.length - 1);
      const {entering = false, ...kept} = standing;
      this.#course = new Course(this.#api, this.#history, lesson, {...kept, index});
      this.#show();
      this.#panel.showStep(this.#course);
      if (entering) await this.#enter(index);
    } catch {
      noteOpenLesson(null);
    }
  }

  /** @param {1|-1} way */
  async #move(way) {
    const course = this.#course;
    if (!course || this.#busy) return;
    if (way === 1 && course.isAsking) { this.#panel.ask(); return; }
    if (way === 1 && course.isLast) { await this.#finish(); return; }
    if (course.index + way >= 0) await this.#enter(course.index + way);
  }

  /** @param {number} index */
  async #enter(index) {
    const course = this.#course;
    if (!course) return;
    // Where the step has another arm the page begins anew, and comes back to here.
    noteOpenLesson({...course.standing, index, entering: true});
    await this.#guarded(() => course.enter(index), () => this.#panel.showStep(course));
    noteOpenLesson(course.standing);
    noteProgress(course.lesson.name, index + 1);
  }

  /** @param {number|null} choice */
  async #answer(choice) {
    const course = this.#course;
    if (!course) return;
    await this.#guarded(async () => {
      await course.answer(choice);
      this.#panel.reveal(course);
    });
    noteOpenLesson(course.standing);
  }

  async #finish() {
    if (!this.#course) return;
    noteProgress(this.#course.lesson.name, this.#course.lesson.steps.length, true);
    await this.#leave({restore: true});
  }

  /** @param {{restore: boolean}} how */
  async #leave(how) { if (await this.#end(how)) await this.#list(); }

  async #close() {
    if (!await this.#end({restore: true})) return;
    this.#panel.element.remove();
    this.#workspace.classList.remove('has-lesson');
    if (this.#former instanceof HTMLElement) this.#former.focus();
  }

  /**
   * @param {{restore: boolean}} how whether the former experiment comes back
   * @returns {Promise<boolean>} whether no lesson is under way any more
   */
  async #end({restore}) {
    const course = this.#course;
    if (!course) return true;
    noteOpenLesson(null);  // first: with another arm the page begins anew
    if (restore && !await this.#guarded(() => course.restore()) && !isBeginningAnew()) {
      noteOpenLesson(course.standing);
      return false;
    }
    course.end();
    this.#course = null;
    const text = 'Your experiment is back as it was before the lesson.';
    if (restore) tellWithUndo(this.#tell, this.#history, text);
    return true;
  }

  /**
   * Do something that may be refused; the panel tells of it.
   *
   * @param {() => Promise<void>} action
   * @param {() => void} [after] done in any case, before a refusal is told
   * @returns {Promise<boolean>} whether it was done
   */
  async #guarded(action, after = () => {}) {
    if (this.#busy) return false;
    this.#busy = true;
    this.#panel.wait(true);
    try {
      await action();
      after();
      return true;
    } catch (error) {
      after();
      this.#panel.refuse(/** @type {Error} */ (error).message);
      return false;
    } finally {
      this.#busy = false;
      this.#panel.wait(false);
    }
  }
}
