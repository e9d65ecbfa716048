// @ts-check
/**
 * Asks for whole responses: one request under way, the newest value next, and only if seen. A page
 * that watches gets the owner's last one, whenever there is another.
 */

import {decodedResponse, withKnownColumns} from './preview_message.js';
import {isWatching} from './watch_only.js';

/** @typedef {import('./api.js').Api} Api */
/** @typedef {import('../fields/merge_patch.js').Document} Document */
/** @typedef {import('./preview_message.js').Response} Response */
/** @typedef {'moving'|'estimated'} Kind `moving`: without the estimate of its error */
/**
 * @typedef {{experiment: Document, resolve: (response: Response) => void,
 *   reject: (error: Error) => void}} Other
 * @typedef {{kind: Kind|'other', revision: number, controller: AbortController}} Running
 *   `revision` is the live experiment's when it began
 */

/** A hand that rests on a slider for so long gets the estimate; ours. */
const REST_MS = 800;
/** So many runs wait in the server that one more was refused: asked again after so long; ours. */
const BUSY_MS = 3000;
const BUSY = 'busy';
/** The document of an answer is looked up by its revision, which is never much older. */
const KEPT_DOCUMENTS = 50;

/**
 * The live experiment's response. Events: `response`, a newer one is there; `busy`, a run began
 * or ended; `failed`, `failure` says why there is none, or that the reason is gone.
 */
export class Preview extends EventTarget {
  /** @type {Response|null} */ latest = null;
  /** Why the last run gave nothing, or ''. */
  failure = '';
  /**
   * Whether the 3D scene shows the flanges' paths of the whole response; null where this page
   * leaves them as they are.
   *
   * @type {boolean|null}
   */
  scene = null;

  #api;
  /** @type {Set<string>} */ #reasons = new Set();
  /** @type {Kind|null} */ #wanted = null;
  /** @type {Running|null} */ #running = null;
  /** @type {Other[]} */ #others = [];
  /** @type {Map<number, Document>} */ #documents = new Map();
  /** @type {number|undefined} which of the owner's responses was fetched */ #heard;
  /** @type {number|null} */ #epoch = null;
  /** @type {ReturnType<typeof setTimeout>|undefined} */ #rest;

  /** @param {Api} api */
  constructor(api) {
    super();
    this.#api = api;
    api.addEventListener('hello', () => { this.#meet(); this.#note(); this.#want('estimated'); });
    api.addEventListener('patch', () => {
      this.#note();
      if (!isWatching()) this.#follow();
    });
    api.addEventListener('connection', () => this.#emit('busy'));
    api.addEventListener('state', () => { this.#restarted(); this.#hear(); });
    api.addEventListener('moving', () => { if (!api.moving) this.#follow(); });
    if (api.connected) this.#note();
  }

  /** Whether a run of the live experiment is under way or about to be. */
  get busy() {
    const {connected} = this.#api;
    return connected && (this.#wanted !== null || (this.#running?.kind ?? 'other') !== 'other');
  }

  /** Whether anybody looks at responses. */
  get isNeeded() { return this.#reasons.size > 0; }

  /** Whether the response of the live experiment is there; it may come before the word of it. */
  get #isThere() { return this.latest !== null && this.latest.revision >= this.#api.revision; }

  /** Whether the response of the live experiment is there with its estimate, or under way. */
  get #settled() {
    if (this.latest?.estimated && this.latest.revision === this.#api.revision) return true;
    if (this.#running?.kind !== 'estimated') return false;
    const {revision, controller} = this.#running;
    return revision === this.#api.revision && !controller.signal.aborted;
  }

  /**
   * Nobody pays for what isn't seen: runs are made while there is a reason.
   *
   * @param {string} reason
   * @param {boolean} holds
   */
  needed(reason, holds) {
    if (holds === this.#reasons.has(reason)) return;
    if (holds) this.#reasons.add(reason);
    else this.#reasons.delete(reason);
    if (!this.#reasons.size) this.#wanted = null;
    else if (!this.#follow()) this.#next();
  }

  /**
   * Ask for the live experiment's response unless it is there or under way.
   *
   * @returns {boolean} whether it has to be asked for
   */
  #follow() {
    const {moving} = this.#api;
    if (this.#settled || (moving && this.#isThere)) return false;
    this.#want(moving ? 'moving' : 'estimated');
    return true;
  }

  /** Run the live experiment once more, whether or not it has changed. */
  again() { this.#want('estimated'); }

  /**
   * Run another experiment, when nothing more urgent is to be done.
   *
   * @param {Document} experiment
   * @returns {Promise<Response>}
   * @throws {import('./api.js').ApiError} when the server refuses the experiment
   */
  respond(experiment) {
    return new Promise((resolve, reject) => {
      this.#others.push({experiment, resolve, reject});
      this.#next();
    });
  }

  /**
   * @param {Response} response
   * @returns {Document|undefined} the experiment that it belongs to
   */
  documentOf({revision}) { return this.#documents.get(revision); }

  /** A revision that doesn't go on may be another server's: the same document alone is the same. */
  #meet() {
    const {latest} = this;
    const {revision, experiment} = this.#api;
    if (!latest || latest.revision < revision) return;
    const known = latest.revision === revision ? this.documentOf(latest) : undefined;
    if (JSON.stringify(known) === JSON.stringify(experiment)) return;
    this.#documents.clear();
    this.latest = null;
    this.#emit('response');
  }

  #note() {
    const {revision, experiment} = this.#api;
    this.#documents.set(revision, experiment);
    if (this.#documents.size <= KEPT_DOCUMENTS) return;
    this.#documents.delete(/** @type {number} */ (this.#documents.keys().next().value));
  }

  /** The owner has another response than the one here. */
  #hear() {
    if (isWatching() && this.#api.session?.results.response !== this.#heard) this.#want('estimated');
  }

  /** A reset takes the paths out of the scene. */
  #restarted() {
    const epoch = this.#api.session?.epoch ?? null;
    if (this.scene && this.#epoch !== null && epoch !== this.#epoch) this.#want('estimated');
    this.#epoch = epoch;
  }

  /** @param {Kind} kind */
  #want(kind) {
    clearTimeout(this.#rest);
    if (!this.#reasons.size) return;
    this.#wanted = kind;
    this.#next();
    this.#emit('busy');
  }

  #next() {
    if (!this.#api.connected) return;
    if (this.#running) { this.#makeWay(this.#running); return; }
    if (this.#wanted) this.#runLive(this.#wanted);
    else if (this.#others.length && this.#reasons.size) this.#runOther(this.#others[0]);
  }

  /**
   * Give up what is slower than what waits. A run of a drag goes on: were it given up for the next
   * one, none would ever end while the hand is fast.
   *
   * @param {Running} running
   */
  #makeWay({kind, controller}) {
    const hurry = kind === 'estimated' && this.#wanted === 'moving';
    if (hurry || (kind === 'other' && this.#wanted)) controller.abort();
  }

  /** @param {Kind} kind */
  async #runLive(kind) {
    this.#wanted = null;
    this.#heard = this.#api.session?.results.response;
    try {
      const response = await this.#run(kind, {estimate: kind === 'estimated', show: this.scene});
      if (response) this.#take(response);
      // Said once: another screen may want its paths to be seen.
      if (response && this.scene === false) this.scene = null;
    } catch (error) {
      this.#failed(/** @type {import('./api.js').ApiError} */ (error), kind);
    }
    this.#emit('busy');
    this.#next();
  }

  /** @param {Other} other */
  async #runOther(other) {
    try {
      const response = await this.#run('other', {experiment: other.experiment});
      if (response) {
        this.#others.shift();
        other.resolve(response);
      }
    } catch (error) {
      this.#others.shift();
      other.reject(/** @type {Error} */ (error));
    }
    this.#next();
  }

  /**
   * @param {Kind|'other'} kind
   * @param {{experiment?: Document, estimate?: boolean, show?: boolean|null}} body
   * @returns {Promise<Response|null>} null when it was given up
   * @throws {import('./api.js').ApiError}
   */
  async #run(kind, body) {
    const controller = new AbortController();
    this.#running = {kind, revision: this.#api.revision, controller};
    try {
      const buffer = await this.#api.runs.preview(body, controller.signal);
      return buffer && decodedResponse(buffer);
    } catch (error) {
      if (controller.signal.aborted) return null;
      throw error;
    } finally {
      this.#running = null;
    }
  }

  /** @param {Response} response */
  #take(response) {
    this.latest = withKnownColumns(response, this.latest);
    if (this.#wanted === 'moving' && this.#isThere) this.#wanted = null;
    this.#say('');
    this.#emit('response');
    // Other screens' drags end without a word, and a hand may rest on its slider.
    clearTimeout(this.#rest);
    if (response.estimated) return;
    this.#rest = setTimeout(() => { if (!this.#settled) this.#want('estimated'); }, REST_MS);
  }

  /**
   * @param {import('./api.js').ApiError} error
   * @param {Kind} kind
   */
  #failed(error, kind) {
    this.#say(error.message);
    if (error.code === BUSY) setTimeout(() => { if (!this.busy) this.#want(kind); }, BUSY_MS);
  }

  /** @param {string} failure */
  #say(failure) {
    if (failure === this.failure) return;
    this.failure = failure;
    this.#emit('failed');
  }

  /** @param {string} type */
  #emit(type) { this.dispatchEvent(new Event(type)); }
}
