// @ts-check
/** The studies that are kept, the newest first. */

import {element} from '../dom/element.js';
import {isUnderWay, listStudies} from '../api/requests/studies.js';
import {KINDS, nameOf, progressWords, stateWords, whenOf} from './words.js';

/** @typedef {import('../api/requests/studies.js').Summary} Summary */

/** While one is under way, so often in [ms]; ours. */
const LOOK_MS = 2000;

/** A list to open one from. */
export class StudyList {
  element;
  /** @type {Summary[]|null} */ studies = null;
  #open;
  #seen;
  #list = element('ul', {class: 'study-list', 'aria-label': 'Kept studies'});
  #alert = element('p', {class: 'control-alert', role: 'alert'});
  #none = element('p', {class: 'study-none'}, 'None yet. Studies are kept until you delete them.');
  /** @type {ReturnType<typeof setTimeout>|undefined} */ #again;
  #drawn = '';

  /**
   * @param {(summary: Summary) => void} open
   * @param {() => boolean} seen whether anybody can see it
   */
  constructor(open, seen) {
    this.#open = open;
    this.#seen = seen;
    this.element = element('section', {class: 'study-kept', 'aria-label': 'Kept studies'},
      element('h3', {}, 'Kept studies'), this.#alert, this.#none, this.#list);
    this.#none.hidden = true;
  }

  /** Ask for them. */
  async refresh() {
    clearTimeout(this.#again);
    try {
      this.studies = await listStudies();
      this.#alert.textContent = '';
    } catch (error) {
      this.#alert.textContent = /** @type {Error} */ (error).message;
    }
    this.#draw();
    if (!this.studies?.some(isUnderWay)) return;
    clearTimeout(this.#again);
    this.#again = setTimeout(() => { if (this.#seen()) this.refresh(); }, LOOK_MS);
  }

  #draw() {
    const studies = this.studies ?? [];
    const drawn = JSON.stringify(studies);
    if (drawn === this.#drawn && this.studies) return;
    this.#drawn = drawn;
    this.#none.hidden = !this.studies || studies.length > 0;
    const focused = document.activeElement?.closest?.('[data-study]');
    const back = focused instanceof HTMLElement && this.#list.contains(focused) ? focused.dataset.study : '';
    this.#list.replaceChildren(...studies.map((summary) => this.#row(summary)));
    const again = back && this.#list.querySelector(`[data-study="${back}"] button`);
    if (again instanceof HTMLElement) again.focus();
  }

  /** @param {Summary} summary */
  #row(summary) {
    const {id, kind, lane, title, state} = summary;
    const about = [title ? `${KINDS[kind].title} of ${lane}` : '', whenOf(summary), progressWords(summary)];
    return element('li', {'data-study': id}, element('button', {
      class: 'study-item', type: 'button', on: {click: () => this.#open(summary)},
    }, element('span', {class: 'study-name'}, nameOf(summary)),
    element('span', {class: 'study-state', 'data-state': state}, state),
    element('span', {class: 'study-about'}, about.filter(Boolean).join(' · ')),
    state === 'failed' && element('span', {class: 'study-about'}, stateWords(summary))));
  }
}
