// @ts-check
/** The last minute of telemetry, and what happened meanwhile: stops, edits, a new beginning. */

import {Freezes} from '../curves/freezes.js';
import {RevisionMarks} from '../plots/revision_marks.js';
import {Ring} from '../curves/ring.js';

/** @typedef {import('../api/api.js').Api} Api */

/**
 * Events: `restarted`: time began anew, or its lanes are others; `changed`: lanes came, went, stopped
 * or go on; `frame`: the first row that is new, as `detail`.
 */
export class Telemetry extends EventTarget {
  ring = new Ring();
  freezes = new Freezes();
  #api;
  #marks = new RevisionMarks();
  /** @type {string[]} */ #lanes = [];
  /** @type {number|null} */ #epoch = null;
  #restarts = 0;
  #restartsAtState = 0;

  /** @param {Api} api */
  constructor(api) {
    super();
    this.#api = api;
    api.addEventListener('hello', () => this.#hello());
    api.addEventListener('patch', (event) => {
      const {revision, experiment} = /** @type {CustomEvent} */ (event).detail;
      this.#marks.note(revision, experiment ?? api.experiment);
    });
    api.addEventListener('state', () => this.#state());
    api.addEventListener('frame', (event) => this.#frame(/** @type {CustomEvent} */ (event).detail));
    if (api.channels.length) this.#hello();
  }

  /** Edits within what is kept. */
  get marks() { return this.#marks.of(this.ring); }

  /** @returns {number|null} when the last lane stopped in [s], null while one runs */
  get still() { return this.freezes.lastOf(this.#lanes); }

  #hello() {
    const {lanes, channels, revision, experiment} = this.#api;
    const names = lanes.map(({name}) => name);
    const gone = this.#lanes.filter((name) => !names.includes(name));
    const come = names.filter((name) => !this.#lanes.includes(name));
    if (gone.length === 1 && come.length === 1) {
      this.ring.rename(gone[0], come[0]);
      this.freezes.rename(gone[0], come[0]);
    }
    this.#lanes = names;
    this.ring.configure(channels);
    this.#marks.note(revision, experiment);
    this.#state();
    this.#emit('changed');
  }

  #state() {
    const session = this.#api.session;
    if (!session) return;
    // Frames of the new epoch may have come first, and have emptied the ring then.
    const restarted = this.ring.restarts !== this.#restartsAtState;
    if (this.#epoch !== null && session.epoch !== this.#epoch && !restarted) this.ring.clear();
    this.#epoch = session.epoch;
    this.#restartsAtState = this.ring.restarts;
    this.#noticeRestart();
    if (this.freezes.note(session, this.ring)) this.#emit('changed');
  }

  /** @param {import('../api/api.js').Frame} frame */
  #frame(frame) {
    const first = this.ring.end;
    this.ring.append(frame);
    this.#noticeRestart();
    this.#emit('frame', first);
  }

  #noticeRestart() {
    if (this.ring.restarts === this.#restarts) return;
    this.#restarts = this.ring.restarts;
    this.#marks.clear();
    this.freezes.clear();
    this.#emit('restarted');
  }

  /**
   * @param {string} type
   * @param {any} [detail]
   */
  #emit(type, detail) { this.dispatchEvent(new CustomEvent(type, {detail})); }
}
