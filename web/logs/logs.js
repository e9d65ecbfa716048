// @ts-check
/** Logs of the real arm: which there are, and those that are shown beside the lanes. */

import {ARM} from '../api/arm.js';
import {compareLog, forgetLog, keptCurves, listLogs, showLog} from '../api/requests/logs.js';
import {isWatching} from '../api/watch_only.js';

/** @typedef {import('../api/requests/logs.js').Log} Log */
/** @typedef {import('../api/requests/logs.js').Overlay} Overlay */
/**
 * `failure`: why it can't be compared, or ''.
 * @typedef {Log & {overlay: Overlay|null, failure: string}} ShownLog
 */
/** @typedef {number|'auto'|null} Shift in [s]; null: as it was last */

/** Sections of an experiment on which a log's curves depend. */
const SECTIONS = ['robot', 'trajectory', 'simulation'];

/**
 * Events: `change`, a log came, went or is different; `open`, its dialog is wanted, with the log as
 * `detail`; `bring`, another one is wanted; `failed`, with words as `detail`.
 */
export class Logs extends EventTarget {
  /** @type {ShownLog[]} of this page's arm, the oldest first */ list = [];
  #api;
  #heard = -1;
  #seen = false;
  /** @type {Map<number, Shift>} logs whose curves are to be asked for, and at which shift */ #due = new Map();
  /** @type {Set<number>} */ #busy = new Set();

  /** @param {import('../api/api.js').Api} api */
  constructor(api) {
    super();
    this.#api = api;
    api.addEventListener('hello', () => { this.#heard = -1; this.#hear(); this.#allDue(); });
    api.addEventListener('state', () => this.#hear());
    api.addEventListener('patch', (event) => {
      const {patch} = /** @type {CustomEvent} */ (event).detail;
      if (SECTIONS.some((name) => name in patch) && !isWatching()) this.#allDue();
    });
  }

  /** Those to draw. */
  get drawn() {
    return this.list.flatMap(({number, name, shown, overlay}) => (
      shown && overlay ? [{number, name, overlay}] : []
    ));
  }

  /** Nobody pays for what isn't seen. */
  set seen(/** @type {boolean} */ seen) {
    this.#seen = seen;
    if (seen) this.#work();
  }

  /**
   * Bring the list up to date at once; it follows the server's word by itself.
   *
   * @returns {Promise<void>}
   */
  async refresh() {
    const before = new Map(this.list.map((log) => [log.number, log]));
    this.list = (await listLogs()).filter(({arm}) => arm === ARM.name).map((log) => {
      const known = before.get(log.number);
      if (log.shown && (isWatching() || !known?.shown || known.shift !== log.shift)) this.#ask(log.number, null);
      return {...log, overlay: known?.overlay ?? null, failure: known?.failure ?? ''};
    });
    this.#emit('change');
    this.#work();
  }

  /**
   * @param {number} number
   * @param {boolean} shown
   */
  show(number, shown) { return this.#do(() => showLog(number, shown)); }

  /** @param {number} number */
  remove(number) { return this.#do(() => forgetLog(number)); }

  /**
   * @param {number} number
   * @param {number|'auto'} shift in [s]
   */
  shift(number, shift) {
    const log = this.list.find((one) => one.number === number);
    if (log) log.shift = shift === 'auto' ? null : shift;
    this.#due.set(number, shift);
    this.#emit('change');
    this.#work();
  }

  /** @param {Log} log whose dialog is wanted */
  open(log) { this.dispatchEvent(new CustomEvent('open', {detail: log})); }

  bring() { this.#emit('bring'); }

  /** @param {() => Promise<any>} request */
  async #do(request) {
    try {
      await request();
      await this.refresh();
    } catch (error) {
      this.#fail(error);
    }
  }

  #hear() {
    const changes = this.#api.session?.results.logs ?? 0;
    if (changes === this.#heard) return;
    this.#heard = changes;
    // Whoever is away for a moment hears again.
    this.refresh().catch(() => { this.#heard = -1; });
  }

  #allDue() {
    for (const {number, shown} of this.list) if (shown) this.#ask(number, null);
    this.#work();
  }

  /**
   * @param {number} number
   * @param {Shift} shift
   */
  #ask(number, shift) { if (!this.#due.has(number)) this.#due.set(number, shift); }

  #work() { if (this.#seen) for (const number of this.#due.keys()) this.#compare(number); }

  /** @param {number} number one request under way, the newest shift next */
  async #compare(number) {
    if (this.#busy.has(number)) return;
    this.#busy.add(number);
    while (this.#seen && this.#due.has(number)) {
      const shift = /** @type {Shift} */ (this.#due.get(number));
      this.#due.delete(number);
      if (!this.list.some((one) => one.number === number)) break;
      let [overlay, failure] = /** @type {[Overlay|null, string]} */ ([null, '']);
      try {
        overlay = isWatching() ? await keptCurves(number) : await compareLog(number, shift);
      } catch (error) {
        failure = /** @type {Error} */ (error).message;
      }
      const log = this.list.find((one) => one.number === number);
      if (log) Object.assign(log, {overlay, failure});
      if (log && shift === 'auto' && overlay?.remarks.length) {
        this.dispatchEvent(new CustomEvent('found', {detail: `${log.name}: ${overlay.remarks.join('; ')}.`}));
      }
      this.#emit('change');
    }
    this.#busy.delete(number);
  }

  /** @param {unknown} error */
  #fail(error) {
    this.dispatchEvent(new CustomEvent('failed', {detail: /** @type {Error} */ (error).message}));
  }

  /** @param {string} type */
  #emit(type) { this.dispatchEvent(new Event(type)); }
}
