// @ts-check
/** A mark on the slider of ε: where the selected lane stops chattering. */

import {element} from '../dom/element.js';
import {fieldPath} from '../fields/field_path.js';
import {fraction, written} from '../fields/quantity.js';
import {thresholdKey} from '../fields/response_key.js';
import {isWatching} from '../api/watch_only.js';

/** @typedef {import('../fields/schema.js').Field} Field */
/**
 * Boundary layers in [rad/s] from which on a lane is silent: one for all joints, and one for each
 * where that is known; `key`: what they depend on.
 * @typedef {{lane: string, key: string, threshold: number|null, joints: (number|null)[]}} Silence
 */

/** So long in [ms] nothing may have changed before the server is asked: it has a drag to serve. */
const QUIET_MS = 500;

/**
 * @param {HTMLElement} place holds the controls of the selected lane
 * @param {import('../api/api.js').Api} api the lens tells of it, too, by its event `silence`
 * @param {(path: string) => Field|undefined} fieldAt by its dotted path
 */
export function mountSilenceMark(place, api, fieldAt) { new SilenceMark(place, api, fieldAt); }

class SilenceMark {
  #place;
  #api;
  #fieldAt;
  #note = element('p', {class: 'silence-note'});
  /** @type {Silence|null} */ #silence = null;
  #refused = '';
  #busy = false;
  /** @type {ReturnType<typeof setTimeout>|undefined} */ #timer;

  /**
   * @param {HTMLElement} place
   * @param {import('../api/api.js').Api} api
   * @param {(path: string) => Field|undefined} fieldAt
   */
  constructor(place, api, fieldAt) {
    this.#place = place;
    this.#api = api;
    this.#fieldAt = fieldAt;
    api.addEventListener('silence', (event) => this.#take(/** @type {CustomEvent} */ (event).detail));
    for (const type of ['select', 'hello', 'patch']) {
      api.addEventListener(type, () => { this.#show(); this.#askSoon(); });
    }
    document.addEventListener('visibilitychange', () => this.#askSoon());
    this.#askSoon();
  }

  /** What the present threshold depends on; empty where there is no such lane. */
  get #key() {
    const {experiment, selected} = this.#api;
    return experiment.lanes?.[selected] ? thresholdKey(experiment, selected) : '';
  }

  /** The selected lane's threshold, if it is known. */
  get #known() {
    if (this.#silence?.key !== this.#key) return null;
    return this.#each && !this.#silence.joints.length ? null : this.#silence;
  }

  /** Whether its joints have layers of their own. */
  get #each() {
    const {experiment, selected} = this.#api;
    return Array.isArray(experiment.lanes?.[selected]?.epsilon);
  }

  /** @param {Silence} silence of whatever lane, as it was when it was looked at */
  #take(silence) {
    if (silence.key !== this.#key) return;
    this.#silence = silence;
    this.#show();
  }

  #askSoon() {
    clearTimeout(this.#timer);
    const {connected, selected, experiment} = this.#api;
    const has = 'epsilon' in (experiment.lanes?.[selected] ?? {});
    if (!has || !connected || document.hidden || isWatching()) return;
    if (this.#known || this.#refused === this.#key) return;
    this.#timer = setTimeout(() => this.#ask(), QUIET_MS);
  }

  async #ask() {
    if (this.#busy || this.#known) return;
    const [lane, key, each] = [this.#api.selected, this.#key, this.#each];
    this.#busy = true;
    try {
      const {threshold} = await this.#api.runs.threshold(lane);
      // Of what only a run tells the lens may have told meanwhile.
      if (each === this.#each && (threshold || !this.#known)) {
        this.#take({lane, key, threshold: threshold?.common ?? null, joints: threshold?.joints ?? []});
      }
    } catch {
      // No mark, then: whatever is wrong is said where it is asked for. It isn't asked for again.
      this.#refused = key;
    }
    this.#busy = false;
    this.#askSoon();
  }

  #show() {
    const {selected, experiment} = this.#api;
    const path = fieldPath(['lanes', selected, 'epsilon']);
    const control = this.#place.querySelector(`.control[data-path="${CSS.escape(path)}"]`);
    const field = this.#fieldAt(path);
    if (!control || !field) { this.#note.remove(); return; }
    const known = this.#known;
    const {switching} = experiment.lanes?.[selected] ?? {};
    const each = this.#each;
    const sliders = /** @type {NodeListOf<HTMLInputElement>} */ (control.querySelectorAll('.slider'));
    for (const slider of sliders) {
      const joint = Number(slider.closest('.joint-row')?.getAttribute('data-joint') ?? 0);
      const own = known?.joints.length ? known.joints[joint - 1] : known?.threshold;
      const value = joint ? own : each ? null : known?.threshold;
      slider.classList.toggle('is-silence-marked', Boolean(value));
      if (value) slider.style.setProperty('--silence', String(fraction(value, field)));
    }
    const wanted = words(known?.threshold ?? null, {each, unit: field.unit, switching});
    if (this.#note.textContent !== wanted) this.#note.textContent = wanted;
    if (!wanted) this.#note.remove();
    else if (this.#note.parentElement !== control) control.append(this.#note);
  }
}

/**
 * @param {number|null} threshold
 * @param {{each: boolean, unit: string, switching: string}} of
 */
function words(threshold, {each, unit, switching}) {
  if (threshold === null) return '';
  if (each) return 'Marks: each joint is silent right of its own.';
  const from = `from ε* = ${written(Number(threshold.toPrecision(3)))} ${unit} on (mark)`;
  return ['sign', 'implicit'].includes(switching) ? `tanh would be silent ${from}.` : `Silent ${from}.`;
}
