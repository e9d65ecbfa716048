// @ts-check
/** The response as it was before the last change: what a drag, an edit or an undo did to it. */

import {leaves, same} from '../fields/merge_patch.js';
import {recall, remember} from '../screen/remembered.js';
import {isWatching} from '../api/watch_only.js';

/** @typedef {import('../fields/merge_patch.js').Document} Document */
/** @typedef {import('../api/preview_message.js').Response} Response */
/** @typedef {{patch: Document, author: string, time: number}} Patched */

/** Somebody else's patches of the same fields this close are one drag, as in the list of edits. */
const TOGETHER_MS = 1500;
/** What may change without any run becoming another one. */
const NO_RUN = new Set(['title', 'description', 'goals', 'uncertainty']);

/** Event `change`: another response is the one before, or it is to be seen or not. */
export class ResponseBefore extends EventTarget {
  #api;
  #preview;
  /** @type {Response|null} */ #response = null;
  /** @type {Document|null} the newest experiment */ #experiment = null;
  /** @type {Document|null} as it was loaded */ #baseline = null;
  #revision = 0;
  /** @type {Document|null} the experiment before, while its response isn't known */ #owed = null;
  #computing = false;
  /** @type {Set<string>|null} lanes that the change is about; null: all */ #lanes = null;
  /** Whether the movement under way has begun to change something. */
  #moves = false;
  #isShown = recall('response.before') !== '0';
  /** @type {Patched|null} */ #last = null;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../api/preview.js').Preview} preview
   */
  constructor(api, preview) {
    super();
    this.#api = api;
    this.#preview = preview;
    api.addEventListener('moving', () => { this.#moves = false; });
    api.addEventListener('patch', (event) => this.#patched(/** @type {CustomEvent} */ (event).detail));
    api.addEventListener('hello', () => this.#hello());
  }

  /**
   * @returns {Response|null} of those lanes that the change is about and that are still there;
   *   null before the first change
   */
  get response() {
    if (!this.#response) return null;
    const present = new Set(this.#api.lanes.map(({name}) => name));
    const lanes = [...this.#response.lanes].filter(([name]) => (
      present.has(name) && (this.#lanes?.has(name) ?? true)
    ));
    return {...this.#response, lanes: new Map(lanes)};
  }

  /** Whether its curves are to be seen. */
  get isShown() { return this.#isShown; }

  set isShown(shown) {
    this.#isShown = shown;
    remember('response.before', shown ? null : '0');
    this.dispatchEvent(new Event('change'));
  }

  /** Compute the response where it isn't known; nobody pays for what isn't seen. */
  async complete() {
    const owed = this.#owed;
    // A page that watches gets the owner's last response, whichever it is: not the one before.
    if (!owed || this.#computing || isWatching()) return;
    this.#computing = true;
    try {
      const response = await this.#preview.respond(owed);
      if (owed === this.#owed) this.#take(response, null);
    } catch {
      // The server refuses to run it: the present response has the reason beside it.
      if (owed === this.#owed) this.#take(null, null);
    }
    this.#computing = false;
    if (this.#owed) this.complete();
  }

  /** A whole experiment came: another one, or the same after the connection was lost. */
  #hello() {
    const {experiment, baseline, revision} = this.#api;
    const before = this.#experiment;
    if (before && !same(before, experiment)) {
      // One that was loaded is no change of the one before it.
      if (!same(this.#baseline, baseline) || same(experiment, baseline)) this.#take(null, null);
      else this.#begin(before, null);
      this.#last = null;
    }
    this.#baseline = baseline;
    this.#note(experiment, revision);
  }

  /** @param {{patch: Document, author: string, revision: number}} message */
  #patched({patch, author, revision}) {
    // Where lanes come or go, a fresh start has told of it already.
    if (!this.#experiment || revision <= this.#revision) return;
    const parts = Object.keys(patch).filter((key) => !NO_RUN.has(key));
    if (parts.length) {
      if (!this.#goesOn(patch, author)) this.#begin(this.#experiment, new Set());
      this.#last = {patch, author, time: performance.now()};
      if (author === this.#api.client) this.#moves = this.#api.moving;
      if (parts.some((key) => key !== 'lanes')) this.#lanes = null;
      for (const lane of Object.keys(patch.lanes ?? {})) this.#lanes?.add(lane);
    }
    this.#note(this.#api.experiment, revision);
  }

  /**
   * @param {Document} patch
   * @param {string} author
   * @returns {boolean} whether it belongs to the change before: a drag is one change
   */
  #goesOn(patch, author) {
    if (author === this.#api.client) return this.#moves && this.#api.moving;
    const last = this.#last;
    return last !== null && last.author === author
      && performance.now() - last.time < TOGETHER_MS && same(leaves(patch), leaves(last.patch));
  }

  /**
   * @param {Document} before
   * @param {Set<string>|null} lanes
   */
  #begin(before, lanes) {
    this.#lanes = lanes;
    const {latest} = this.#preview;
    const known = latest?.revision === this.#revision ? latest : null;
    this.#take(known, known ? null : before);
    if (this.#preview.isNeeded) this.complete();
  }

  /**
   * @param {Response|null} response
   * @param {Document|null} owed
   */
  #take(response, owed) {
    this.#response = response;
    this.#owed = owed;
    this.dispatchEvent(new Event('change'));
  }

  /**
   * @param {Document} experiment
   * @param {number} revision
   */
  #note(experiment, revision) {
    this.#experiment = experiment;
    this.#revision = revision;
  }
}
