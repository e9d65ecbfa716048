// @ts-check
/**
 * The live lane with one set of gains or the other. A switch changes gains alone, so that the state
 * of the arm goes on; it is nothing to undo. What is accepted is one edit.
 */

import {acceptGains} from '../api/requests/studies.js';
import {difference, isObject, same} from '../fields/merge_patch.js';
import {keepTried, triedStill} from './tried_gains.js';

/** @typedef {import('../fields/merge_patch.js').Document} Document */
/** @typedef {import('./tried_gains.js').Origin} Origin */
/** @typedef {'A'|'B'} Side the present gains, the candidate's */

const CHANGED = 'The gains were changed by something else: the comparison has ended.';

/**
 * Take back the gains that were tried before the page was loaded anew.
 *
 * @param {import('../api/api.js').Api} api
 * @throws {import('../api/api.js').ApiError} when the server refuses
 */
export async function takeBack(api) {
  const tried = triedStill(api.experiment);
  if (!tried) return;
  await api.change(patchOf(tried.lane, tried.tried, tried.former));
  keepTried(null);
}

/** Event `change`: another side is in force, or the comparison has ended; `ended` says why. */
export class Comparison extends EventTarget {
  /** Why the comparison has ended by itself, or ''. */
  ended = '';
  #api;
  #history;
  #lane = '';
  /** @type {Document|null} the lane of side B */ #candidate = null;
  /** @type {Document|null} side A, once B was tried */ #former = null;
  /** @type {Document|null} side B as the server has it */ #tried = null;
  /** @type {Origin} */ #origin = {study: 0, trial: 0};
  #busy = 0;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../api/undo.js').History} history
   */
  constructor(api, history) {
    super();
    this.#api = api;
    this.#history = history;
    for (const type of ['patch', 'hello']) api.addEventListener(type, () => this.#check());
  }

  /** @returns {Document|undefined} the lane as it is */
  get #live() { return this.#api.experiment.lanes?.[this.#lane]; }

  /** @returns {Side} which gains are in force */
  get side() { return this.#tried ? 'B' : 'A'; }

  /** Whether the live lane is there, and differs from the candidate or may go back to its own. */
  get isPossible() {
    const live = this.#live;
    if (!this.#candidate || !live) return false;
    return this.#former !== null || !agrees(live, this.#candidate);
  }

  /**
   * Compare with another candidate; the former one's gains are taken back, those that were tried
   * before the page was loaded anew as well.
   *
   * @param {string} lane
   * @param {Document|null} candidate the whole lane
   * @param {Origin} origin
   */
  async begin(lane, candidate, origin) {
    this.#goOn(lane);
    if (lane === this.#lane && agrees(candidate, this.#candidate)) return;
    await this.to('A');
    this.#lane = lane;
    this.#origin = origin;
    this.#candidate = candidate;
    this.#end('');
  }

  /**
   * @param {Side} side
   * @throws {import('../api/api.js').ApiError} when the server refuses
   */
  async to(side) {
    const live = this.#live;
    if (side === this.side || !live || !this.#candidate) return;
    this.#busy += 1;
    if (side === 'A') keepTried(null);
    try {
      await this.#history.commit();
      if (side === 'B') {
        const former = this.#live ?? live;
        await this.#set(former, this.#candidate);
        this.#former = former;
        this.#tried = this.#live ?? null;
        if (this.#tried) {
          keepTried({lane: this.#lane, former, tried: this.#tried, origin: this.#origin});
        }
      } else {
        await this.#set(live, /** @type {Document} */ (this.#former));
        this.#tried = null;
      }
    } finally {
      this.#busy -= 1;
    }
    this.ended = '';
    this.dispatchEvent(new Event('change'));
  }

  /**
   * Keep the candidate's gains, as one edit that the server watches.
   *
   * @returns {Promise<import('../api/requests/studies.js').Accepted|null>} null where there is nothing to keep
   * @throws {import('../api/api.js').ApiError} when the server refuses
   */
  async accept() {
    // The server goes back to what it had before: that must be side A.
    await this.to('A');
    const [lane, former, candidate] = [this.#lane, this.#live, this.#candidate];
    if (!former || !candidate) return null;
    const patch = patchOf(lane, former, candidate);
    /** @type {import('../api/requests/studies.js').Accepted|null} */ let accepted = null;
    const accept = async () => {
      accepted = await acceptGains(lane, patch, this.#api.client);
      this.#api.made.add(accepted.revision);
    };
    this.#busy += 1;
    try {
      const back = patchOf(lane, candidate, former);
      await this.#history.perform(`accepted gains of ${lane}`, accept, back);
    } finally {
      this.#busy -= 1;
    }
    this.#end('');
    return accepted;
  }

  /** Back to the present gains. */
  async reject() {
    await this.to('A');
    this.#end('');
  }

  /**
   * @param {Document} from
   * @param {Document} to
   */
  #set(from, to) { return this.#api.change(patchOf(this.#lane, from, to)); }

  #check() {
    if (this.#busy) return;
    const live = this.#live;
    if (this.#former && (!live || !same(live, this.#tried ?? this.#former))) this.#end(CHANGED);
    else this.dispatchEvent(new Event('change'));
  }

  /**
   * Go on with what was tried before the page was loaded anew.
   *
   * @param {string} lane
   */
  #goOn(lane) {
    const kept = this.#tried ? null : triedStill(this.#api.experiment);
    if (kept?.lane !== lane) return;
    this.#lane = lane;
    this.#candidate = kept.tried;
    this.#former = kept.former;
    this.#tried = kept.tried;
    this.#origin = kept.origin;
    this.dispatchEvent(new Event('change'));
  }

  /** @param {string} why */
  #end(why) {
    if (this.#tried) keepTried(null);
    this.#former = null;
    this.#tried = null;
    this.ended = why;
    this.dispatchEvent(new Event('change'));
  }
}

/**
 * @param {string} lane
 * @param {Document} from its whole document
 * @param {Document} to
 * @returns {Document} merge patch of the experiment
 */
export function patchOf(lane, from, to) { return {lanes: {[lane]: difference(from, to)}}; }

/**
 * Whether a lane has the values of another: the server may spell them otherwise.
 *
 * @param {any} one
 * @param {any} other
 * @returns {boolean}
 */
export function agrees(one, other) {
  if (Array.isArray(one) !== Array.isArray(other)) {
    const [list, value] = Array.isArray(one) ? [one, other] : [other, one];
    return list.length > 0 && list.every((item) => same(item, value));
  }
  if (!isObject(one) || !isObject(other)) return same(one, other);
  const keys = new Set([...Object.keys(one), ...Object.keys(other)]);
  return [...keys].every((key) => agrees(one[key], other[key]));
}
