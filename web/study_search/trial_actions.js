// @ts-check
/** What can be done with a trial: a lane of its own, its gains in the live lane, a file, A or B. */

import {BOUNDS} from '../api/schema_document.js';
import {Comparison, agrees, patchOf} from './comparison.js';
import {element, freshId} from '../dom/element.js';
import {laneOf} from '../trials/trials.js';
import {studyFile} from '../api/requests/studies.js';
import {tellWithUndo} from '../dom/undo_notice.js';
import {WATCH_ONLY, isWatching} from '../api/watch_only.js';

/** @typedef {import('../trials/trials.js').Study} Study */
/** @typedef {import('../trials/trials.js').Trial} Trial */
/** @typedef {import('./comparison.js').Side} Side */

const OTHER = 'The experiment has changed since: goals and figures here are those of the experiment '
  + 'that was searched.';
/** What does not change how a lane is judged. */
const BESIDE = new Set(['title', 'description', 'lanes']);

/** Buttons and the switch between A and B. */
export class TrialActions {
  element;
  #api;
  #desk;
  #comparison;
  #keep;
  #reject;
  /** @type {Study|null} */ #study = null;
  /** @type {Trial|null} */ #trial = null;
  #new = element('button', {class: 'button small', type: 'button',
    on: {click: () => this.#try(() => this.#newLane())}}, 'Apply as a new lane');
  #use = element('button', {class: 'button small', type: 'button',
    on: {click: () => this.#try(() => this.#useGains())}}, 'Use these gains');
  #file = element('a', {class: 'button small', download: ''}, 'Download preset');
  #accept = element('button', {class: 'button small', type: 'button',
    title: 'Keep the gains. For ten seconds the lane goes back by itself if it leaves a hard goal.',
    on: {click: () => this.#try(() => this.#accepted())}}, 'Accept');
  #refuse = element('button', {class: 'button small', type: 'button',
    on: {click: () => this.#try(async () => { await this.#comparison.reject(); this.#reject(); })}},
  'Reject');
  #radios;
  #title = element('b', {class: 'search-title'});
  #words = element('p', {class: 'search-note', role: 'status'});
  #alert = element('p', {class: 'search-alert', role: 'alert', hidden: true});
  #acting = false;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../page/right_panel.js').Desk} desk
   * @param {{keep: () => void, reject: () => void}} on `keep`: the trial must stay the chosen one
   */
  constructor(api, desk, {keep, reject}) {
    this.#api = api;
    this.#desk = desk;
    this.#keep = keep;
    this.#reject = reject;
    this.#comparison = new Comparison(api, desk.history);
    this.#comparison.addEventListener('change', () => this.#show());
    const group = freshId('search-side');
    this.#radios = /** @type {Side[]} */ (['A', 'B']).map((side) => element('input', {
      type: 'radio', name: group, value: side, on: {change: () => this.#try(() => this.#to(side))},
    }));
    const [a, b] = this.#radios;
    this.element = element('div', {class: 'search-actions'},
      element('div', {class: 'search-row'}, this.#title, this.#use, this.#new, this.#file),
      element('div', {class: 'search-row'},
        element('div', {class: 'segments search-sides', role: 'radiogroup',
          'aria-label': 'Gains in force in the live lane'},
        element('label', {}, a, element('span', {}, 'A present')),
        element('label', {}, b, element('span', {}, 'B candidate'))),
        this.#accept, this.#refuse),
      this.#words, this.#alert);
  }

  /**
   * @param {Study} study
   * @param {Trial} trial
   */
  show(study, trial) {
    const other = study.id !== this.#study?.id || trial.number !== this.#trial?.number;
    this.#study = study;
    this.#trial = trial;
    if (!other) return;
    this.#explain('');
    this.#title.textContent = trial.number ? `Trial ${trial.number}` : 'Gains before';
    this.#file.setAttribute('href', studyFile(study.id, 'preset', trial.number));
    this.#try(() => this.#comparison.begin(
      study.lane, laneOf(study, trial), {study: study.id, trial: trial.number},
    ));
  }

  /** The study is left: its trial’s gains go with it, unless they were accepted. */
  close() { this.#try(() => this.#comparison.reject()); }

  #show() {
    const study = this.#study;
    const trial = this.#trial;
    if (!study || !trial) return;
    const {side, isPossible, ended} = this.#comparison;
    const live = this.#api.experiment.lanes?.[study.lane];
    const watching = isWatching();
    const ready = !watching && !this.#acting;
    const [a, b] = this.#radios;
    a.checked = side === 'A';
    b.checked = side === 'B';
    for (const radio of this.#radios) radio.disabled = !isPossible || watching;
    this.#new.disabled = !ready;
    this.#use.disabled = !ready || !live || agrees(live, laneOf(study, trial));
    this.#accept.disabled = !ready || !isPossible;
    this.#refuse.disabled = !ready || !isPossible;
    this.#accept.classList.toggle('primary', side === 'B');
    this.#say(watching ? WATCH_ONLY : this.#standing(side, ended, Boolean(live)));
  }

  /**
   * @param {Side} side
   * @param {string} ended
   * @param {boolean} there
   */
  #standing(side, ended, there) {
    const study = /** @type {Study} */ (this.#study);
    if (!there) return `There is no lane ${study.lane} any more: apply the gains as a new one.`;
    if (side === 'B') return `The live lane has the gains of trial ${this.#trial?.number}.`;
    const now = this.#api.experiment;
    const changed = [...new Set([...Object.keys(now), ...Object.keys(study.experiment)])]
      .some((part) => !BESIDE.has(part) && !agrees(now[part], study.experiment[part]));
    return [ended, changed ? OTHER : ''].filter(Boolean).join(' ');
  }

  /** @param {Side} side */
  async #to(side) {
    this.#keep();
    await this.#comparison.to(side);
  }

  async #accepted() {
    const study = /** @type {Study} */ (this.#study);
    this.#keep();
    const number = this.#trial?.number;
    const accepted = await this.#comparison.accept();
    if (accepted) this.#tell(`${study.lane} has the gains of trial ${number}. ${watchWords(accepted)}`);
  }

  async #useGains() {
    const [study, trial] = [/** @type {Study} */ (this.#study), /** @type {Trial} */ (this.#trial)];
    const {lane} = study;
    this.#keep();
    await this.#comparison.to('A');
    const patch = patchOf(lane, this.#api.experiment.lanes[lane], laneOf(study, trial));
    await this.#desk.history.change(patch, `gains of ${lane}`);
    this.#tell(`${lane} has the gains of trial ${trial.number}.`);
  }

  async #newLane() {
    const [study, trial] = [/** @type {Study} */ (this.#study), /** @type {Trial} */ (this.#trial)];
    this.#keep();
    const name = freeName(study.lane, this.#api.experiment.lanes);
    await this.#desk.history.change({lanes: {[name]: laneOf(study, trial)}}, `new lane ${name}`);
    this.#tell(`${name} has the gains of trial ${trial.number}.`);
  }

  /** @param {string} text */
  #tell(text) { tellWithUndo(this.#desk.tell, this.#desk.history, text); }

  /** @param {() => Promise<void>} action */
  async #try(action) {
    this.#explain('');
    this.#acting = true;
    try {
      await action();
    } catch (error) {
      this.#explain(/** @type {Error} */ (error).message);
    }
    this.#acting = false;
    this.#show();
  }

  /** @param {string} text */
  #explain(text) {
    this.#alert.hidden = !text;
    this.#alert.textContent = text;
  }

  /** @param {string} text */
  #say(text) { if (this.#words.textContent !== text) this.#words.textContent = text; }
}

/**
 * @param {import('../api/requests/studies.js').Accepted} accepted
 * @returns {string} what the server does from now on
 */
function watchWords({seconds, watched, unwatched}) {
  const unseen = unwatched.length
    ? ` The live session can’t measure ${unwatched.join(', ')}: that is not watched.` : '';
  if (!watched.length) return `No hard goal is watched.${unseen}`;
  return `For ${seconds} s it goes back by itself if it leaves ${watched.join(' or ')}.${unseen}`;
}

/**
 * @param {string} lane
 * @param {{[name: string]: any}} lanes
 * @returns {string} a name that no lane has, such as `NFTSM tuned 2`
 */
function freeName(lane, lanes) {
  for (let number = 1; ; number += 1) {
    const end = number === 1 ? ' tuned' : ` tuned ${number}`;
    const name = lane.slice(0, BOUNDS.lane_name - end.length) + end;
    if (!(name in lanes)) return name;
  }
}
