// @ts-check
/** What is on its way to the server: patches joined while it is busy, and their answers. */

import {ApiError} from './http.js';
import {joined} from '../fields/merge_patch.js';
import {WATCH_ONLY, isWatching} from './watch_only.js';

/** @typedef {import('../fields/merge_patch.js').Document} Document */
/**
 * `refused`: the server didn't take a patch that nobody waits for.
 *
 * @typedef {{send: (message: Document) => boolean,
 *   refused: (refusal: {id: number, error: ApiError, patch: Document}) => void}} Line
 */

const NOT_CONNECTED = 'not connected: the change was not made';
const SETTLE_MS = 3000;
/** An answer may be lost: the server drops what a page that lags too far has missed. */
const ANSWER_MS = 10_000;
/** With more on the way a slow server would fall behind the hand; two hide the way there and back. */
const MOST_ON_THE_WAY = 2;

/** Messages that are answered, in order. */
export class Outbox {
  #line;
  /** @type {Document|null} */ #pending = null;
  #id = 0;
  /** @type {Map<number, {done: (error?: ApiError) => void,
   *   timer: ReturnType<typeof setTimeout>}>} */
  #sent = new Map();
  /** @type {(() => void)[]} */ #settling = [];

  /** @param {Line} line */
  constructor(line) { this.#line = line; }

  /**
   * Send a patch soon, joined with others that come meanwhile.
   *
   * @param {Document} patch JSON merge patch
   */
  add(patch) {
    const waiting = this.#pending !== null;
    this.#pending = joined(this.#pending ?? {}, patch);
    if (waiting) return;
    // A hidden page gets no animation frames.
    const later = document.hidden ? setTimeout : requestAnimationFrame;
    later(() => this.#flushIfIdle());
  }

  /**
   * Send a message at once, after the patches that wait.
   *
   * @param {Document} message
   * @returns {Promise<void>} kept when the server has accepted it, broken with an ApiError
   */
  deliver(message) {
    this.#flush();
    return new Promise((resolve, reject) => {
      this.#submit(message, (error) => (error ? reject(error) : resolve()));
    });
  }

  /**
   * Wait until every message is answered, or long enough.
   *
   * @returns {Promise<void>}
   */
  async settled() {
    this.#flush();
    if (!this.#sent.size) return;
    await new Promise((resolve) => {
      this.#settling.push(() => resolve(null));
      setTimeout(resolve, SETTLE_MS, null);
    });
  }

  /** The line was lost, and every answer with it. */
  lost() {
    const error = new ApiError(0, 'lost', NOT_CONNECTED);
    for (const id of [...this.#sent.keys()]) this.answered(id, error);
  }

  /**
   * The server takes messages in order, so that an answer covers all that were sent before it.
   *
   * @param {number} id
   * @param {ApiError} [error]
   * @returns {boolean} whether anything with this id was on its way
   */
  answered(id, error) {
    const known = this.#sent.has(id);
    for (const [older, {done, timer}] of [...this.#sent]) {
      if (older > id) continue;
      clearTimeout(timer);
      this.#sent.delete(older);
      done(older === id ? error : undefined);
    }
    this.#flushIfIdle();
    if (!this.#sent.size) for (const resolve of this.#settling.splice(0)) resolve();
    return known;
  }

  #flushIfIdle() { if (this.#sent.size < MOST_ON_THE_WAY) this.#flush(); }

  #flush() {
    const patch = this.#pending;
    if (!patch) return;
    this.#pending = null;
    const id = this.#id + 1;
    this.#submit({type: 'patch', patch}, (error) => {
      if (error) this.#line.refused({id, error, patch});
    });
  }

  /**
   * @param {Document} message
   * @param {(error?: ApiError) => void} done
   */
  #submit(message, done) {
    this.#id += 1;
    const id = this.#id;
    const give = (/** @type {string} */ text) => this.answered(id, new ApiError(0, 'lost', text));
    const timer = setTimeout(() => give('the server has not answered'), ANSWER_MS);
    this.#sent.set(id, {done, timer});
    if (!this.#line.send({...message, id})) give(isWatching() ? WATCH_ONLY : NOT_CONNECTED);
  }
}
