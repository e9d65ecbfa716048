// @ts-check
/** A look back over the last minute: the 3D scene shows it, and a lane may branch off there. */

import {BOUNDS} from '../api/schema_document.js';
import {ask} from '../dom/dialog.js';
import {element, freshId} from '../dom/element.js';
import {icon} from '../dom/icons.js';

/** @typedef {{from: number|null, to: number|null}} Span */

const POLL_MS = 1000;
const STEP = 0.1;

/**
 * @param {HTMLElement} place the bar with play and pause
 * @param {import('../api/api.js').Api} api
 * @param {import('../api/undo.js').History} history
 * @param {import('../dom/notices.js').Tell} tell
 */
export function mountScrub(place, api, history, tell) { new Scrub(place, api, history, tell); }

class Scrub {
  #api;
  #history;
  #tell;
  #toggle;
  #row;
  #range;
  #ago = element('output', {class: 'scrub-ago'});
  #fork;
  #now;
  #polling = 0;
  /** @type {{from: number, to: number}|null} what is recorded */ #span = null;
  /** @type {number|null} the moment that is looked at */ #time = null;
  /** Whether the server is being asked for a moment, and which one comes next. */
  #asking = false;
  /** @type {number|null|undefined} */ #next;
  /** Whether time went on before, and whether it has been seen to stand still since. */
  #played = false;
  #stood = false;

  /**
   * @param {HTMLElement} place
   * @param {import('../api/api.js').Api} api
   * @param {import('../api/undo.js').History} history
   * @param {import('../dom/notices.js').Tell} tell
   */
  constructor(place, api, history, tell) {
    this.#api = api;
    this.#history = history;
    this.#tell = tell;
    const id = freshId('scrub');
    this.#toggle = element('button', {
      class: 'button', type: 'button', title: 'Look back over the last minute',
      'aria-label': 'Past', 'aria-expanded': 'false', 'aria-controls': id,
      on: {click: () => (this.#row.hidden ? this.#open() : this.#close())},
    }, icon('rewind'), element('span', {}, 'Past'));
    this.#range = element('input', {
      type: 'range', class: 'slider', 'aria-label': 'Moment to look at', step: STEP,
      on: {
        input: () => this.#look(this.#range.valueAsNumber),
        keydown: (event) => { if (event.key === 'Escape') this.#present(); },
      },
    });
    this.#fork = element('button', {
      class: 'button small', type: 'button', title: 'A new lane that continues from this moment',
      on: {click: () => this.#branch()},
    }, icon('fork'), 'Fork here…');
    this.#now = element('button', {
      class: 'button small', type: 'button', on: {click: () => this.#present()},
    }, 'Back to now');
    this.#row = element('div', {id, class: 'scrub', hidden: true, role: 'group', 'aria-label': 'The past'},
      this.#ago, this.#range, this.#fork, this.#now);
    place.querySelector('.spring')?.before(this.#toggle);
    place.append(this.#row);
    api.addEventListener('state', () => this.#state());
    addEventListener('pagehide', () => { if (this.#time !== null) this.#ask(null); });
  }

  #open() {
    this.#row.hidden = false;
    this.#toggle.setAttribute('aria-expanded', 'true');
    this.#poll();
    this.#polling = setInterval(() => this.#poll(), POLL_MS);
    this.#show();
  }

  #close() {
    this.#present();
    clearInterval(this.#polling);
    this.#row.hidden = true;
    this.#toggle.setAttribute('aria-expanded', 'false');
  }

  async #poll() {
    if (document.hidden) return;
    try {
      const {from, to} = await this.#api.past();
      this.#span = from === null || to === null || to - from < STEP ? null : {from, to};
    } catch {
      this.#span = null;
    }
    this.#show();
  }

  /** @param {number} time in [s] */
  #look(time) {
    const {session} = this.#api;
    if (this.#time === null) {
      this.#played = session?.playing ?? false;
      this.#stood = !this.#played;
    }
    this.#time = time;
    this.#show();
    this.#ask(time);
  }

  /**
   * One request at a time; of those that come meanwhile the last counts.
   *
   * @param {number|null} time
   */
  async #ask(time) {
    this.#next = time;
    if (this.#asking) return;
    this.#asking = true;
    while (this.#next !== undefined) {
      const wanted = this.#next;
      this.#next = undefined;
      try {
        await this.#api.look(wanted);
      } catch (error) {
        this.#tell(/** @type {Error} */ (error).message, {error: true});
      }
    }
    this.#asking = false;
  }

  /** Back to the present, as it was before. */
  async #present() {
    if (this.#time === null) return;
    this.#time = null;
    this.#show();
    await this.#ask(null);
    if (this.#played) this.#api.play();
  }

  #state() {
    if (this.#time === null) { if (!this.#row.hidden) this.#show(); return; }
    const playing = this.#api.session?.playing ?? false;
    if (!playing) { this.#stood = true; return; }
    // Someone pressed play: time goes on, and what is past is past.
    if (!this.#stood) return;
    this.#played = false;
    this.#present();
  }

  #show() {
    const looking = this.#time !== null;
    const end = looking ? this.#span?.to ?? 0 : this.#api.session?.time ?? this.#span?.to ?? 0;
    this.#range.disabled = !this.#span;
    this.#fork.disabled = !looking;
    this.#now.disabled = !looking;
    if (!this.#span) {
      this.#ago.textContent = 'nothing yet';
      return;
    }
    this.#range.min = String(this.#span.from);
    this.#range.max = String(this.#span.to);
    const time = this.#time ?? this.#span.to;
    this.#range.value = String(time);
    const text = looking ? `${Math.max(0, end - time).toFixed(1)} s ago` : 'now';
    this.#ago.textContent = text;
    this.#range.setAttribute('aria-valuetext', `${text}, t = ${time.toFixed(1)} s`);
    this.#range.title = `t = ${time.toFixed(1)} s`;
    const {min, max} = this.#range;
    const share = (time - Number(min)) / Math.max(Number(max) - Number(min), STEP);
    this.#range.style.setProperty('--to', String(share));
  }

  #branch() {
    const time = this.#time;
    const origin = this.#api.selected;
    if (time === null) return;
    const question = {
      name: 'name', label: `Name of the lane that continues from ${origin}`, required: true,
      length: BOUNDS.lane_name, value: this.#free(origin),
      hint: `All lanes go back to t = ${time.toFixed(1)} s and continue from there. The new one starts `
        + 'with the same gains; tune it as usual.',
    };
    ask('Fork here', [question], 'Fork', async ({name}) => {
      const wanted = name.trim();
      const action = () => this.#api.fork({time, origin, name: wanted});
      await this.#history.perform(`fork ${wanted}`, action, {lanes: {[wanted]: null}});
      // The server has left the past by itself.
      this.#time = null;
      this.#close();
      this.#select(wanted);
    });
  }

  /** @param {string} name of a lane that is on its way */
  #select(name) {
    const {lanes} = this.#api;
    if (lanes.some((lane) => lane.name === name)) { this.#api.select(name); return; }
    this.#api.addEventListener('hello', () => this.#select(name), {once: true});
  }

  /**
   * @param {string} origin
   * @returns {string} a name that no lane has, such as `NFTSM fork 2`
   */
  #free(origin) {
    const base = `${origin.replace(/ fork( \d+)?$/, '')} fork`.slice(0, 36);
    for (let number = 1; ; number += 1) {
      const name = number === 1 ? base : `${base} ${number}`;
      if (!(name in this.#api.experiment.lanes)) return name;
    }
  }
}
