// @ts-check
/** The baselines as a row of chips: shown or hidden, a name that can be edited, a way out. */

import {MOST_BASELINES} from './baseline_store.js';
import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';

/** @typedef {import('./baselines.js').Baseline} Baseline */
/** @typedef {import('./baselines.js').Baselines} Baselines */

const LONGEST_NAME = 40;
const LEAST_WIDTH = 8;

/** @typedef {{chip: HTMLElement, eye: HTMLElement, box: HTMLInputElement, failed: HTMLElement, remove: HTMLElement}} Chip */

/** Chips are filled in place: one that is rebuilt under the pointer would lose its click. */
export class BaselineList {
  element = element('div', {class: 'response-baselines', role: 'group', 'aria-label': 'Baselines'});
  #baselines;
  #pin;
  #list = element('ul', {class: 'response-chips'});
  /** @type {Map<number, Chip>} */ #chips = new Map();

  /**
   * @param {Baselines} baselines
   * @param {() => void} pin
   */
  constructor(baselines, pin) {
    this.#baselines = baselines;
    this.#pin = element('button', {
      type: 'button', class: 'plots-button response-pin', on: {click: pin},
      'aria-label': 'Pin as baseline', title: 'Pin as baseline: compare later responses with this one',
    }, icon('pin'), element('span', {}, 'Pin'));
    this.element.append(this.#pin, this.#list);
  }

  /** @param {boolean} ready whether there is a response to pin */
  show(ready) {
    const {list, full} = this.#baselines;
    this.#pin.disabled = !ready || full;
    this.#pin.title = full ? `${MOST_BASELINES} baselines at most: remove one first.`
      : 'Keep this response to compare with; it survives a reload.';
    const ids = new Set(list.map(({id}) => id));
    for (const [id, {chip}] of [...this.#chips]) {
      if (ids.has(id)) continue;
      if (chip.contains(document.activeElement)) this.#pin.focus({preventScroll: true});
      chip.remove();
      this.#chips.delete(id);
    }
    for (const baseline of list) this.#fill(this.#chips.get(baseline.id) ?? this.#add(baseline), baseline);
  }

  /**
   * @param {Baseline} baseline
   * @returns {Chip}
   */
  #add(baseline) {
    const eye = element('button', {
      type: 'button', class: 'response-eye',
      on: {click: () => this.#baselines.edit(baseline, {shown: !baseline.shown})},
    }, element('span', {class: 'response-line', 'aria-hidden': 'true'}));
    const remove = element('button', {
      type: 'button', class: 'button icon-only small',
      on: {click: () => this.#baselines.remove(baseline)},
    }, icon('close'));
    const box = this.#nameBox(baseline);
    const failed = element('span', {class: 'response-failed', role: 'alert'});
    const chip = element('li', {class: 'response-chip'}, eye, box, failed, remove);
    this.#list.append(chip);
    const parts = {chip, eye, box, failed, remove};
    this.#chips.set(baseline.id, parts);
    return parts;
  }

  /**
   * @param {Chip} chip
   * @param {Baseline} baseline
   */
  #fill({chip, eye, box, failed, remove}, {name, shown, failure}) {
    chip.classList.toggle('is-hidden', !shown);
    eye.setAttribute('aria-pressed', String(shown));
    eye.setAttribute('aria-label', `Show ${name}`);
    eye.title = `${shown ? 'Hide' : 'Show'} ${name}`;
    remove.setAttribute('aria-label', `Remove ${name}`);
    remove.title = `Remove ${name}`;
    if (failed.textContent !== failure) failed.textContent = failure;
    if (box === document.activeElement || box.dataset.name === name) return;
    box.dataset.name = name;
    box.value = name;
    box.size = Math.max(LEAST_WIDTH, name.length);
  }

  /** @param {Baseline} baseline */
  #nameBox(baseline) {
    const box = element('input', {
      type: 'text', class: 'response-name', maxlength: LONGEST_NAME, spellcheck: 'false',
      autocomplete: 'off', 'aria-label': 'Name of the baseline', title: 'Click to rename',
      on: {
        change: () => {
          const name = box.value.trim();
          if (name) this.#baselines.edit(baseline, {name});
          else box.value = baseline.name;
        },
        keydown: ({key}) => {
          if (key === 'Escape') box.value = baseline.name;
          if (key === 'Enter' || key === 'Escape') box.blur();
        },
        input: () => { box.size = Math.max(LEAST_WIDTH, box.value.length); },
      },
    });
    return box;
  }
}
