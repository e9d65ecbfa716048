// @ts-check
/** Where lanes stood still: those that do, and earlier stops of those that were reset since. */

/** @typedef {import('./ring.js').Ring} Ring */
/** @typedef {import('./panel_curves.js').Freeze} Freeze */
/** @typedef {Freeze & {lane: string}} Stop */

const DIGITS = 3;

/**
 * @param {number} time in [s]
 * @returns {string} of three digits
 */
export function shortTime(time) { return `${Number(time.toPrecision(DIGITS))} s`; }

/** Follows the states of the session. */
export class Freezes {
  /** @type {Map<string, Freeze>} the lanes that stand still */ now = new Map();
  /** @type {Stop[]} of lanes that were reset since */ #past = [];

  /** @returns {Stop[]} in order of time */
  get stops() {
    const now = [...this.now].map(([lane, freeze]) => ({...freeze, lane}));
    return [...this.#past, ...now].sort((one, other) => one.time - other.time);
  }

  /** @returns {number|null} when the last of some lanes stopped in [s], null while one runs */
  lastOf(/** @type {string[]} */ lanes) {
    const times = lanes.map((lane) => this.now.get(lane)?.time ?? Infinity);
    const last = Math.max(...times);
    return Number.isFinite(last) ? last : null;
  }

  /** Forget what has been. */
  clear() { this.#past = []; }

  /**
   * @param {string} before
   * @param {string} after
   */
  rename(before, after) {
    const named = (/** @type {string} */ lane) => (lane === before ? after : lane);
    this.#past = this.#past.map((stop) => ({...stop, lane: named(stop.lane)}));
    this.now = new Map([...this.now].map(([lane, freeze]) => [named(lane), freeze]));
  }

  /**
   * Take note of a state; what a lane held until it was reset is no curve.
   *
   * @param {import('../api/api.js').State} session
   * @param {Ring} ring
   * @returns {boolean} whether something is new
   */
  note(session, ring) {
    const before = this.now;
    this.now = freezesOf(session);
    for (const [lane, freeze] of before) {
      const began = session.lanes[lane]?.began ?? 0;
      if (began <= freeze.time) continue;
      this.#past.push({...freeze, lane});
      ring.forget({lane, after: freeze.time, before: began});
    }
    return JSON.stringify([...before]) !== JSON.stringify([...this.now]);
  }
}

/**
 * @param {import('../api/api.js').State} session
 * @returns {Map<string, Freeze>}
 */
function freezesOf(session) {
  /** @type {Map<string, Freeze>} */ const freezes = new Map();
  for (const [lane, {status, time, cause}] of Object.entries(session.lanes ?? {})) {
    if (status !== 'frozen' || time === null) continue;
    freezes.set(lane, {time, text: cause || `Frozen at ${time.toFixed(3)} s.`});
  }
  return freezes;
}

/**
 * @param {Ring} ring
 * @param {Freeze|undefined} freeze
 * @param {number} from first row
 * @param {number} to one past the last row
 * @returns {number} one past the last row in which a lane still ran
 */
export function rowsUntil(ring, freeze, from, to) {
  if (!freeze) return to;
  if (from >= to || ring.timeOf(from) > freeze.time + ring.dt / 2) return from;
  return Math.min(to, ring.rowAt(freeze.time) + 1);
}
