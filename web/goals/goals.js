// @ts-check
/** The goals of the experiment: what each lane is held to, and how it keeps to it. */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {rememberOpen} from '../screen/remembered.js';
import {isWatching} from '../api/watch_only.js';
import {NewGoal} from './new_goal.js';
import {freeName, goalWords, ratioText} from './words.js';

/** @typedef {import('../api/api.js').Api} Api */
/** @typedef {import('./words.js').Goal} Goal */

const HINT = 'A goal bounds a response or a figure. hard ones must hold; of the soft ones the worst is '
  + 'what a search makes small. Each is shown as a ratio to its bound: 1 is just met.';

/** A group of the left column. */
export class Goals {
  element;
  #api;
  #history;
  #preview;
  #list = element('ul', {class: 'goal-list', 'aria-label': 'Goals'});
  #score = element('p', {class: 'goal-scores'});
  #count = element('span', {class: 'group-changed'});
  #built = '';

  /**
   * @param {Api} api
   * @param {import('../api/undo.js').History} history
   * @param {import('../api/preview.js').Preview} preview
   */
  constructor(api, history, preview) {
    this.#api = api;
    this.#history = history;
    this.#preview = preview;
    const form = new NewGoal((goal) => this.#add(goal));
    this.element = element('details', {class: 'group goals'},
      element('summary', {}, icon('chevron'), element('span', {}, 'Goals'), this.#count),
      element('div', {class: 'group-body'}, element('p', {class: 'goal-hint'}, HINT),
        this.#list, this.#score, form.element));
    rememberOpen(this.element, 'goals', false);
    this.element.addEventListener('toggle', () => this.#need());
    for (const type of ['hello', 'patch']) api.addEventListener(type, () => this.#show());
    for (const type of ['response', 'failed']) preview.addEventListener(type, () => this.#show());
    this.#show();
  }

  /** @returns {{[name: string]: Goal}} */
  get #goals() { return this.#api.experiment?.goals ?? {}; }

  #need() {
    this.#preview.needed('goals', this.element.open && Object.keys(this.#goals).length > 0);
  }

  #show() {
    const goals = this.#goals;
    const names = Object.keys(goals);
    this.#count.textContent = names.length ? String(names.length) : '';
    this.#need();
    const {lanes, experiment} = this.#api;
    if (!experiment) return;
    const {latest} = this.#preview;
    const {horizon} = experiment.simulation;
    const ratios = lanes.map(({name}) => latest?.lanes.get(name)?.goals ?? null);
    const built = JSON.stringify([goals, lanes, horizon, ratios, isWatching()]);
    if (built === this.#built) return;
    this.#built = built;
    const focused = document.activeElement?.closest?.('[data-goal]');
    const back = focused instanceof HTMLElement && this.#list.contains(focused) ? focused.dataset.goal : null;
    this.#list.replaceChildren(...names.map((name) => this.#row(name, goals[name], horizon, ratios)));
    if (back) {
      const button = this.#list.querySelector(`[data-goal="${CSS.escape(back)}"] button`);
      if (button instanceof HTMLElement) button.focus();
    }
    this.#score.replaceChildren(...(names.length ? [
      element('span', {class: 'goal-score-name'}, 'score'),
      ...lanes.map(({name, color}, index) => chip(name, color, ratios[index]?.score, ratios[index])),
    ] : []));
  }

  /**
   * @param {string} name
   * @param {Goal} goal
   * @param {number} horizon
   * @param {(import('../api/preview_message.js').Verdict|null)[]} verdicts of the lanes
   */
  #row(name, goal, horizon, verdicts) {
    const other = goal.priority === 'hard' ? 'soft' : 'hard';
    const words = goalWords(goal, horizon);
    const buttons = isWatching() ? [] : [
      element('button', {
        class: 'goal-priority', type: 'button', 'aria-label': `${name} is ${goal.priority}: make it ${other}`,
        title: `Make it ${other}`, on: {click: () => this.#change(name, {priority: other}, `${name} ${other}`)},
      }, goal.priority),
      element('button', {
        class: 'goal-remove', type: 'button', 'aria-label': `Remove ${name}`, title: 'Remove',
        on: {click: () => this.#change(name, null, `remove ${name}`)},
      }, '×'),
    ];
    return element('li', {class: 'goal', 'data-goal': name},
      element('div', {class: 'goal-head'}, element('span', {class: 'goal-words', title: name}, words), ...buttons),
      element('div', {class: 'goal-ratios'}, ...this.#api.lanes.map((lane, index) => (
        chip(lane.name, lane.color, verdicts[index]?.ratios[name], verdicts[index])
      ))));
  }

  /**
   * @param {Goal} goal
   * @returns {Promise<string>} why it was refused, or ''
   */
  async #add(goal) { return this.#change(freeName(this.#goals), goal, 'add a goal'); }

  /**
   * @param {string} name
   * @param {Partial<Goal>|null} change
   * @param {string} label
   */
  async #change(name, change, label) {
    try {
      await this.#history.change({goals: {[name]: change}}, label);
      return '';
    } catch (error) {
      return /** @type {Error} */ (error).message;
    }
  }
}

/**
 * One lane's ratio: green where it keeps to the bound, red where it does not.
 *
 * @param {string} lane
 * @param {string} color
 * @param {number|null|undefined} ratio
 * @param {object|null|undefined} verdict null where there is no response yet
 */
function chip(lane, color, ratio, verdict) {
  const known = Boolean(verdict);
  const kept = known && typeof ratio === 'number' && ratio <= 1;
  const words = known ? kept ? 'kept' : 'missed' : 'not computed yet';
  const dot = element('span', {class: 'metrics-dot', 'aria-hidden': 'true'});
  dot.style.setProperty('--lane', color);
  return element('span', {
    class: `goal-chip${known ? kept ? ' is-kept' : ' is-missed' : ''}`, title: `${lane}: ${words}`,
    'aria-label': `${lane}: ${ratioText(ratio)}, ${words}`, role: 'img',
  }, dot, known ? ratioText(ratio) : '…');
}
