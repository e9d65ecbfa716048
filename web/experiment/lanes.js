// @ts-check
/** The lanes: which there are, how they fare, and what can be done with them. */

import {laneOfItsSize} from '../api/requests/arms.js';
import {BOUNDS} from '../api/schema_document.js';
import {ask} from '../dom/dialog.js';
import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {openMenu} from '../dom/menu.js';
import {handOver} from './hand_over.js';

/** @typedef {import('../api/api.js').Lane} Lane */

const MEANING = 'A lane is one controller in a closed loop of its own. All lanes run in lockstep '
  + 'against the same trajectory and disturbance.';
const RESET_LANE = 'Restarts this lane where the trajectory is now, with the initial error and '
  + 'velocity of the simulation and zero weights. Time and the other lanes continue.';

/**
 * @param {HTMLElement} place
 * @param {import('../api/api.js').Api} api
 * @param {import('../api/undo.js').History} history
 * @param {import('../fields/schema.js').Schema} schema
 * @param {import('../dom/notices.js').Tell} tell
 */
export function mount(place, api, history, schema, tell) {
  new LaneList(place, api, history, schema.mostLanes, tell).mount();
}

/** A list to choose one lane from. */
class LaneList {
  #place;
  #api;
  #history;
  #most;
  #tell;
  /** @type {Map<string, {radio: HTMLInputElement, status: HTMLElement, cause: HTMLElement}>} */
  #rows = new Map();
  #list = element('div', {class: 'lane-list', role: 'radiogroup', 'aria-label': 'Lane to tune'});
  #add;

  /**
   * @param {HTMLElement} place
   * @param {import('../api/api.js').Api} api
   * @param {import('../api/undo.js').History} history
   * @param {number} most
   * @param {import('../dom/notices.js').Tell} tell
   */
  constructor(place, api, history, most, tell) {
    this.#place = place;
    this.#api = api;
    this.#history = history;
    this.#most = most;
    this.#tell = tell;
    this.#add = element('button', {
      class: 'button subtle lane-add', type: 'button', 'aria-haspopup': 'menu',
      on: {click: () => this.#chooseNew()},
    }, icon('plus'), 'Add lane');
  }

  mount() {
    this.#place.append(
      element('p', {class: 'lanes-meaning', title: MEANING},
        element('b', {}, 'Lanes'), ': one controller each, run in lockstep'),
      this.#list, this.#add,
    );
    this.#build();
    this.#api.addEventListener('hello', () => this.#build());
    this.#api.addEventListener('patch', () => this.#laws());
    this.#api.addEventListener('select', () => this.#mark());
    for (const type of ['state', 'moving']) this.#api.addEventListener(type, () => this.#states());
  }

  #build() {
    const focused = document.activeElement?.closest('.lane')?.getAttribute('data-lane');
    this.#rows.clear();
    this.#list.replaceChildren(...this.#api.lanes.map((lane) => this.#row(lane)));
    const full = this.#api.lanes.length >= this.#most;
    this.#add.disabled = full;
    this.#add.title = full ? `${this.#most} lanes at most` : 'Another controller, side by side';
    this.#mark();
    this.#laws();
    this.#states();
    if (focused) this.#rows.get(focused)?.radio.focus();
  }

  /** @param {Lane} lane */
  #row({name, color}) {
    const radio = element('input', {
      type: 'radio', name: 'lane', value: name, class: 'visually-hidden',
      on: {change: () => this.#api.select(name)},
    });
    const status = element('span', {class: 'lane-status'});
    const cause = element('div', {class: 'lane-cause', role: 'status'});
    const more = element('button', {
      class: 'button icon-only small', type: 'button', 'aria-label': `Actions of ${name}`,
      'aria-haspopup': 'menu', on: {click: () => this.#menu(name, more)},
    }, icon('more'));
    const pick = element('label', {class: 'lane-pick'}, radio, element('span', {class: 'lane-dot'}),
      element('span', {class: 'lane-name', title: name}, name),
      element('span', {class: 'lane-law'}), status);
    this.#rows.set(name, {radio, status, cause});
    const row = element('div', {class: 'lane', 'data-lane': name}, pick, more, cause);
    row.style.setProperty('--fill', color);
    return row;
  }

  #mark() {
    for (const [name, {radio}] of this.#rows) radio.checked = name === this.#api.selected;
  }

  #laws() {
    for (const [name, {radio}] of this.#rows) {
      const law = radio.parentElement?.querySelector('.lane-law');
      const title = this.#title(this.#api.experiment.lanes[name]?.law);
      if (law) law.textContent = title === name ? '' : title;
    }
  }

  #states() {
    const {session} = this.#api;
    for (const [name, {status, cause}] of this.#rows) {
      const lane = session?.lanes[name];
      if (!session || !lane) continue;
      const frozen = lane.status === 'frozen';
      const running = session.playing ? 'running' : 'paused';
      const text = frozen ? 'frozen' : running;
      if (status.textContent !== text) status.textContent = text;
      status.classList.toggle('is-frozen', frozen);
      const why = frozen ? lane.cause ?? 'It left its bounds.' : lane.remark ?? '';
      // The slider in the hand lies below: it is said when that is let go.
      if (!this.#api.moving) this.#explain(name, cause, frozen, why, lane.trace);
    }
  }

  /**
   * @param {string} name
   * @param {HTMLElement} cause
   * @param {boolean} frozen
   * @param {string} text
   * @param {string} trace lines of the law's own file
   */
  #explain(name, cause, frozen, text, trace) {
    if (cause.dataset.text === text + trace) return;
    cause.dataset.text = text + trace;
    if (!text) { cause.replaceChildren(); return; }
    const why = element('span', {class: 'lane-why', title: text}, text);
    if (!frozen) { cause.replaceChildren(why); return; }
    const reset = element('button', {
      class: 'button small', type: 'button', title: RESET_LANE, on: {click: () => this.#api.reset(name)},
    }, icon('reset'), 'Reset lane');
    const way = trace && element('pre', {class: 'law-trace', tabindex: '0'}, trace);
    cause.replaceChildren(why, reset, ...(way ? [way] : []));
  }

  /** @param {string} law */
  #title(law) { return this.#api.laws.find(({name}) => name === law)?.title ?? law; }

  /**
   * @param {string} name
   * @param {HTMLElement} anchor
   */
  #menu(name, anchor) {
    const {laws, lanes, experiment} = this.#api;
    openMenu(anchor, [
      {label: 'Rename…', run: () => this.#rename(name)},
      {label: 'Duplicate', hint: 'same gains, same state', icon: 'plus',
        disabled: lanes.length >= this.#most, run: () => this.#duplicate(name)},
      {label: 'Reset', hint: 'this lane only; time continues', icon: 'reset',
        run: () => this.#api.reset(name)},
      {label: 'Hand over…', hint: 'code, gains and conditions for a real controller', icon: 'download',
        run: () => handOver(this.#api, name)},
      {label: 'Remove', icon: 'trash', danger: true, disabled: lanes.length < 2,
        run: () => this.#change(`removal of ${name}`, {[name]: null})},
      {heading: 'Law'},
      ...laws.map((law) => ({
        label: law.title,
        checked: law.name === experiment.lanes[name].law,
        run: () => this.#take(`law of ${name}`, name, law.name),
      })),
    ]);
  }

  /**
   * A law's published gains are for the arm that ships: another one has gains of its own size.
   *
   * @param {string} label
   * @param {string} name of a lane
   * @param {string} law
   */
  async #take(label, name, law) {
    try {
      await this.#change(label, {[name]: await laneOfItsSize(law)});
    } catch (error) {
      this.#tell(/** @type {Error} */ (error).message, {error: true});
    }
  }

  /**
   * @param {string} label
   * @param {{[lane: string]: any}} lanes
   */
  async #change(label, lanes) {
    try {
      await this.#history.change({lanes}, label);
    } catch (error) {
      this.#tell(/** @type {Error} */ (error).message, {error: true});
    }
  }

  #chooseNew() {
    openMenu(this.#add, this.#api.laws.map((law) => ({
      label: law.title,
      hint: law.summary,
      run: async () => {
        const name = this.#free(law.title);
        await this.#take(`new lane ${name}`, name, law.name);
        if (name in this.#api.experiment.lanes) this.#api.select(name);
      },
    })));
  }

  /** @param {string} origin */
  async #duplicate(origin) {
    const name = this.#free(origin);
    const copy = () => this.#api.duplicateLane(origin, name);
    try {
      await this.#history.perform(`copy of ${origin}`, copy, {lanes: {[name]: null}});
      this.#api.select(name);
    } catch (error) {
      this.#tell(/** @type {Error} */ (error).message, {error: true});
    }
  }

  /** @param {string} old */
  #rename(old) {
    const question = {
      name: 'name', label: 'Name', value: old, required: true, length: BOUNDS.lane_name,
    };
    ask(`Rename ${old}`, [question], 'Rename', async ({name}) => {
      const {lanes} = this.#api.experiment;
      const wanted = name.trim();
      if (wanted === old) return;
      if (wanted in lanes) throw new Error(`A lane ${wanted} already exists.`);
      const patch = {lanes: {[old]: null, [wanted]: lanes[old]}};
      await this.#history.change(patch, `name of ${wanted}`);
    });
  }

  /**
   * @param {string} stem
   * @returns {string} a name that no lane has, such as `NFTSM 2`
   */
  #free(stem) {
    const base = stem.replace(/ \d+$/, '');
    for (let number = 1; ; number += 1) {
      const name = number === 1 ? base : `${base} ${number}`;
      if (!(name in this.#api.experiment.lanes)) return name;
    }
  }
}
