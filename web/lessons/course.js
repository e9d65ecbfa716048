// @ts-check
/** A lesson under way: where it stands, and the experiment that belongs there. */

import {difference} from '../fields/merge_patch.js';

/** @typedef {import('./lesson_document.js').Lesson} Lesson */
/** @typedef {import('./lesson_document.js').LessonStep} LessonStep */
/** @typedef {import('../fields/merge_patch.js').Document} Document */
/**
 * What there was before the lesson.
 * @typedef {{preset: string, experiment: Document, lane: string, exaggeration: number,
 *   playing: boolean}} Before
 */
/**
 * All that it takes to go on after the page was loaded again. A guess of null is a skipped one.
 * `entering`: its step is not reached yet.
 * @typedef {{name: string, index: number, guesses: {[index: number]: number|null},
 *   before: Before, entering?: boolean}} Standing
 */

/** For so long the lanes of a loaded preset may take to arrive. */
const ARRIVAL_MS = 5000;

/**
 * @param {import('../api/api.js').Api} api
 * @returns {Before}
 */
export function presentState(api) {
  return {
    preset: api.preset,
    experiment: api.experiment,
    lane: api.selected,
    exaggeration: api.drawn.exaggeration,
    playing: api.session?.playing ?? true,
  };
}

/** One lesson. */
export class Course {
  #api;
  #history;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../api/undo.js').History} history
   * @param {Lesson} lesson
   * @param {Standing} standing
   */
  constructor(api, history, lesson, standing) {
    this.#api = api;
    this.#history = history;
    this.lesson = lesson;
    this.standing = standing;
  }

  /** @returns {number} the step, from 0 */
  get index() { return this.standing.index; }

  /** @returns {LessonStep} */
  get step() { return this.lesson.steps[this.index]; }

  get isLast() { return this.index === this.lesson.steps.length - 1; }

  /** @returns {boolean} whether the step waits for a prediction */
  get isAsking() { return this.#isAsking(this.index); }

  /** @returns {number|null|undefined} the choice, null for a skipped one */
  get guess() { return this.standing.guesses[this.index]; }

  /**
   * Go to a step; what it shows is on the screen when the promise is kept.
   *
   * @param {number} index
   * @throws {import('../api/api.js').ApiError} when the server refuses; `enter` may be tried again
   */
  async enter(index) {
    this.standing = {...this.standing, index};
    // Until it is answered, a question is about what there was before.
    await this.#apply(this.#isAsking(index) ? index - 1 : index, !this.#isAsking(index));
    this.#look();
  }

  /**
   * Answer the step's question, upon which its change is made.
   *
   * @param {number|null} choice null to skip the guess
   * @throws {import('../api/api.js').ApiError} when the server refuses; the question stays open
   */
  async answer(choice) {
    await this.#apply(this.index, true);
    this.#look();
    const guesses = {...this.standing.guesses, [this.index]: choice};
    this.standing = {...this.standing, guesses};
  }

  /** @param {number} samples that the plots hold; 0: they follow the newest */
  #closeUp(samples) { this.#api.dispatchEvent(new CustomEvent('samples', {detail: samples})); }

  /** Leave the screen as anybody wants it who is in no lesson. */
  end() { this.#closeUp(0); }

  /** Bring back the experiment that there was before the lesson. */
  async restore() {
    const {preset, experiment, lane, exaggeration, playing} = this.standing.before;
    const back = () => this.#history.restore(preset, experiment);
    // Before: with another arm the page begins anew.
    this.#api.view({exaggeration});
    if (!playing) this.#api.pause();
    await this.#history.replace('return from the lesson', back);
    await this.#lanesOf(experiment);
    if (lane in experiment.lanes) this.#api.select(lane);
  }

  /** @param {number} index */
  #isAsking(index) {
    return this.lesson.steps[index].question !== null && !(index in this.standing.guesses);
  }

  /**
   * @param {number} index the step whose experiment is wanted
   * @param {boolean} anew whether its reset counts
   */
  async #apply(index, anew) {
    const {preset, experiment, reset} = this.lesson.steps[index];
    const label = `lesson, step ${index + 1}`;
    const changed = await this.#reach(preset, experiment, label);
    await this.#lanesOf(experiment);
    if (changed && preset !== this.standing.before.preset) this.#api.view({exaggeration: 1});
    if (!reset || !(anew || changed)) return;
    this.#api.reset();
    if (!this.#api.session?.playing) this.#api.play();
  }

  /**
   * @param {string} preset
   * @param {Document} experiment
   * @param {string} label
   * @returns {Promise<boolean>} whether there was anything to change
   */
  async #reach(preset, experiment, label) {
    if (this.#api.preset === preset) {
      const patch = difference(this.#api.experiment, experiment);
      if (!Object.keys(patch).length) return false;
      await this.#history.change(patch, label);
      return true;
    }
    await this.#history.replace(label, async () => {
      const loaded = await this.#api.loadPreset(preset);
      const rest = difference(loaded.experiment, experiment);
      if (Object.keys(rest).length) await this.#api.change(rest);
      return loaded;
    });
    return true;
  }

  /** Lane, tab or lens, and scale of the step. */
  #look() {
    const {lane, view, lens, exaggeration, samples} = this.step;
    if (lane && lane in this.#api.experiment.lanes) this.#api.select(lane);
    if (exaggeration !== null) this.#api.view({exaggeration});
    const shown = lens ? {view: 'lenses', lens} : view && {tab: view};
    if (shown) this.#api.dispatchEvent(new CustomEvent('show', {detail: shown}));
    this.#closeUp(samples);
  }

  /**
   * Wait until the lanes of an experiment are there: a loaded one comes over the live connection.
   *
   * @param {Document} experiment
   * @returns {Promise<void>}
   */
  #lanesOf(experiment) {
    const wanted = Object.keys(experiment.lanes).sort().join('\n');
    const there = () => this.#api.lanes.map(({name}) => name).sort().join('\n') === wanted;
    if (there()) return Promise.resolve();
    return new Promise((resolve) => {
      const done = () => {
        clearTimeout(timer);
        this.#api.removeEventListener('hello', check);
        resolve();
      };
      const check = () => { if (there()) done(); };
      const timer = setTimeout(done, ARRIVAL_MS);
      this.#api.addEventListener('hello', check);
    });
  }
}
