// @ts-check
/** Responses to compare with: pinned, named, kept in this browser, computed anew after a reload. */

import {BaselineStore, MOST_BASELINES, freshKey} from './baseline_store.js';

/** @typedef {import('./baseline_store.js').Kept} Kept */
/** @typedef {import('../fields/merge_patch.js').Document} Document */
/** @typedef {import('../api/preview_message.js').Response} Response */
/**
 * `id` counts within this page; `response` is null until it has been computed; `failure` says why
 * it can't be.
 * @typedef {Kept & {id: number, response: Response|null, failure: string}} Baseline
 */

/** Event `change`: a baseline came, went, or is different. */
export class Baselines extends EventTarget {
  /** @type {Baseline[]} */ list = [];
  #preview;
  #next = 1;
  #store = new BaselineStore(() => {
    this.#adopt(this.#store.read());
    this.complete();
  });
  /** @type {Set<Baseline>} */ #computing = new Set();

  /** @param {import('../api/preview.js').Preview} preview */
  constructor(preview) {
    super();
    this.#preview = preview;
    this.#adopt(this.#store.read());
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
    const key = freshKey();
    const kept = this.#store.update((list) => (list.length >= MOST_BASELINES ? list
      : [...list, {key, name: freeName(list), experiment, shown: true}]));
    this.#adopt(kept, new Map([[key, response]]));
    this.complete();
  }

  /**
   * @param {Baseline} baseline
   * @param {{name?: string, shown?: boolean}} change
   */
  edit(baseline, change) {
    Object.assign(baseline, change);
    this.#adopt(this.#store.update((list) => list.map((kept) => (
      kept.key === baseline.key ? {...kept, ...change} : kept
    ))));
  }

  /** @param {Baseline} baseline */
  remove(baseline) {
    this.#adopt(this.#store.update((list) => list.filter(({key}) => key !== baseline.key)));
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
   * Show what is kept. Which are hidden each page decides for itself.
   *
   * @param {Kept[]} kept
   * @param {Map<string, Response|null>} [responses] of new ones, where they are known, by key
   */
  #adopt(kept, responses = new Map()) {
    const before = new Map(this.list.map((baseline) => [baseline.key, baseline]));
    this.list = kept.map((one) => {
      const known = before.get(one.key);
      if (known) return Object.assign(known, {name: one.name});
      const response = responses.get(one.key) ?? null;
      const id = this.#next;
      this.#next += 1;
      return {...one, id, response, failure: ''};
    });
    this.dispatchEvent(new Event('change'));
  }
}

/** @param {Kept[]} list */
function freeName(list) {
  const taken = new Set(list.map(({name}) => name));
  for (let number = 1; ; number += 1) {
    if (!taken.has(`Baseline ${number}`)) return `Baseline ${number}`;
  }
}
