// @ts-check
/** Responses to compare with: pinned, named, kept in this browser, computed anew after a reload. */

import {isObject} from './merge_patch.js';
import {recall, remember} from './remembered.js';

/** @typedef {import('./merge_patch.js').Document} Document */
/** @typedef {import('./preview_message.js').Response} Response */
/**
 * `response` is null until it has been computed; `failure` says why it can't be.
 * @typedef {{id: number, name: string, experiment: Document, shown: boolean,
 *   response: Response|null, failure: string}} Baseline
 */

const KEY = 'response.baselines';
/** More than that can't be told apart; ours. */
export const MOST_BASELINES = 6;

/** Event `change`: a baseline came, went, or is different. */
export class Baselines extends EventTarget {
  /** @type {Baseline[]} */ list = [];
  #preview;
  #next = 1;
  /** @type {Set<Baseline>} */ #computing = new Set();

  /** @param {import('./preview.js').Preview} preview */
  constructor(preview) {
    super();
    this.#preview = preview;
    for (const {name, experiment, shown} of remembered()) this.#add(name, experiment, shown, null);
  }

  /** Those to draw. */
  get pinned() {
    return this.list.flatMap(({id, name, shown, response}) => (
      shown && response ? [{id, name, response}] : []
    ));
  }

  /** Whether there is room for another. */
  get full() { return this.list.length >= MOST_BASELINES; }

  /**
   * @param {Document} experiment
   * @param {Response|null} response its exact response, where it is known
   */
  pin(experiment, response) {
    if (this.full) return;
    this.#add(this.#freeName(), experiment, true, response);
    this.#changed();
    this.complete();
  }

  /**
   * @param {Baseline} baseline
   * @param {{name?: string, shown?: boolean}} change
   */
  edit(baseline, change) {
    Object.assign(baseline, change);
    this.#changed();
  }

  /** @param {Baseline} baseline */
  remove(baseline) {
    this.list = this.list.filter((each) => each !== baseline);
    this.#changed();
  }

  /** Compute the responses that are missing. */
  complete() {
    for (const baseline of this.list) {
      if (!baseline.response && !this.#computing.has(baseline)) this.#compute(baseline);
    }
  }

  /** @param {Baseline} baseline */
  async #compute(baseline) {
    this.#computing.add(baseline);
    try {
      baseline.response = await this.#preview.respond(baseline.experiment);
      baseline.failure = '';
    } catch (error) {
      baseline.failure = /** @type {Error} */ (error).message;
    }
    this.#computing.delete(baseline);
    this.dispatchEvent(new Event('change'));
  }

  /**
   * @param {string} name
   * @param {Document} experiment
   * @param {boolean} shown
   * @param {Response|null} response
   */
  #add(name, experiment, shown, response) {
    const id = this.#next;
    this.#next += 1;
    this.list = [...this.list, {id, name, experiment, shown, response, failure: ''}];
  }

  #freeName() {
    const taken = new Set(this.list.map(({name}) => name));
    for (let number = 1; ; number += 1) {
      if (!taken.has(`Baseline ${number}`)) return `Baseline ${number}`;
    }
  }

  #changed() {
    const kept = this.list.map(({name, experiment, shown}) => ({name, experiment, shown}));
    remember(KEY, kept.length ? JSON.stringify(kept) : null);
    this.dispatchEvent(new Event('change'));
  }
}

/** @returns {{name: string, experiment: Document, shown: boolean}[]} what can be read of it */
function remembered() {
  try {
    const kept = JSON.parse(recall(KEY) ?? '[]');
    return kept.filter((/** @type {any} */ {name, experiment}) => (
      typeof name === 'string' && isObject(experiment)
    )).slice(0, MOST_BASELINES);
  } catch {
    // Somebody else wrote there; the next pin replaces it.
    return [];
  }
}
