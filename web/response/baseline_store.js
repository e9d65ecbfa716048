// @ts-check
/** The baselines that this browser keeps: all its pages share them, and none overwrites another's. */

import {isObject} from '../fields/merge_patch.js';
import {onRemembered, recall, remember} from '../screen/remembered.js';

/** @typedef {import('../fields/merge_patch.js').Document} Document */
/**
 * `key` tells a baseline from every other, in whichever page it was pinned.
 * @typedef {{key: string, name: string, experiment: Document, shown: boolean}} Kept
 */

const KEY = 'response.baselines';
/** More than that can't be told apart; ours. */
export const MOST_BASELINES = 6;

/** Reads what is kept before it writes, because another page may have written meanwhile. */
export class BaselineStore {
  /** @type {Kept[]} what this page last wrote */ #own = [];
  /** Storage may be switched off or full: then this page keeps its own. */
  #alone = false;

  /** @param {() => void} changed called when another page has changed what is kept */
  constructor(changed) { onRemembered(KEY, () => { if (!this.#alone) changed(); }); }

  /** @returns {Kept[]} */
  read() { return this.#alone ? this.#own : parsed(recall(KEY)); }

  /**
   * @param {(kept: Kept[]) => Kept[]} change
   * @returns {Kept[]} what is kept now
   */
  update(change) {
    this.#own = change(this.read());
    const text = this.#own.length ? JSON.stringify(this.#own) : null;
    remember(KEY, text);
    this.#alone = recall(KEY) !== text;
    return this.#own;
  }
}

/** @returns {string} that no other page comes upon */
export function freshKey() {
  return `${Date.now().toString(36)}-${Math.random().toString(36).slice(2)}`;
}

/**
 * @param {string|null} text
 * @returns {Kept[]} what can be read of it
 */
function parsed(text) {
  try {
    return JSON.parse(text ?? '[]').filter((/** @type {any} */ {name, experiment}) => (
      typeof name === 'string' && isObject(experiment)
    )).slice(0, MOST_BASELINES).map(keyed);
  } catch {
    // Somebody else wrote there; the next pin replaces it.
    return [];
  }
}

/**
 * Earlier versions kept no keys: the place stands in for one, alike in every page.
 *
 * @param {any} kept
 * @param {number} place
 * @returns {Kept}
 */
function keyed({key, name, experiment, shown}, place) {
  return {key: typeof key === 'string' ? key : `${place} ${name}`, name, experiment, shown: shown !== false};
}
