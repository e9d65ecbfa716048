// @ts-check
/** The goals of the experiment: what each lane is held to, and how it keeps to it. */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {rememberOpen} from '../screen/remembered.js';
import {isWatching} from '../api/watch_only.js';
import {GoalEdits} from './edits.js';
import {NewGoal} from './new_goal.js';
import {GoalRow, chip} from './row.js';

/** @typedef {import('../api/api.js').Api} Api */

const HINT = 'A goal bounds a response or a figure. Hard ones must hold; of the soft ones the worst is '
  + 'what a search makes small. Each is shown as a ratio to its bound: 1 is just met.';

/** A group of the left column. */
export class Goals {
  element;
  #api;
  #edits;
  #preview;
  /** @type {Map<string, GoalRow>} */ #rows = new Map();
  #list = element('ul', {class: 'goal-list', 'aria-label': 'Goals'});
  #score = element('p', {class: 'goal-scores'});
  #count = element('span', {class: 'group-changed'});
  #shown = '';

  /**
   * @param {Api} api
   * @param {import('../api/undo.js').History} history
   * @param {import('../api/preview.js').Preview} preview
   */
  constructor(api, history, preview) {
    this.#api = api;
    this.#edits = new GoalEdits(api, history);
    this.#preview = preview;
    const form = new NewGoal((goal) => this.#edits.add(goal, 'add a goal'));
    const draw = element('button', {
      class: 'button small goal-draw', type: 'button', title: 'Draw a bound in the plots of the response',
      on: {click: () => {
        api.dispatchEvent(new CustomEvent('show', {detail: {view: 'response'}}));
        api.dispatchEvent(new CustomEvent('bound'));
      }},
    }, icon('bound'), 'Draw a bound');
    this.element = element('details', {class: 'group goals'},
      element('summary', {}, icon('chevron'), element('span', {}, 'Goals'), this.#count),
      element('div', {class: 'group-body'}, element('p', {class: 'goal-hint'}, HINT),
        this.#list, this.#score, ...(isWatching() ? [] : [draw]), form.element));
    rememberOpen(this.element, 'goals', false);
    this.element.addEventListener('toggle', () => this.#need());
    for (const type of ['hello', 'patch']) api.addEventListener(type, () => this.#show());
    api.addEventListener('patch', (event) => this.#reveal(/** @type {CustomEvent} */ (event).detail));
    api.addEventListener('goal', (event) => {
      this.element.open = true;
      form.fill(/** @type {CustomEvent} */ (event).detail);
    });
    for (const type of ['response', 'failed']) preview.addEventListener(type, () => this.#show());
    this.#show();
  }

  #need() {
    this.#preview.needed('goals', this.element.open && Object.keys(this.#edits.all).length > 0);
  }

  /**
   * Show a goal that this page has just added.
   *
   * @param {{author: string, patch: {goals?: {[name: string]: any}}}} message
   */
  #reveal({author, patch}) {
    const added = Object.keys(patch.goals ?? {}).find((name) => patch.goals?.[name]?.kind);
    const row = added && author === this.#api.client ? this.#rows.get(added) : null;
    if (!row) return;
    this.element.open = true;
    row.element.scrollIntoView({block: 'nearest'});
  }

  #show() {
    const goals = this.#edits.all;
    const names = Object.keys(goals);
    this.#count.textContent = names.length ? String(names.length) : '';
    this.#need();
    const {lanes, experiment} = this.#api;
    if (!experiment || (!names.length && !this.#rows.size)) return;
    const {latest} = this.#preview;
    const {horizon} = experiment.simulation;
    const verdicts = lanes.map(({name}) => latest?.lanes.get(name)?.goals ?? null);
    const shown = JSON.stringify([goals, lanes, horizon, verdicts]);
    if (shown === this.#shown) return;
    this.#shown = shown;
    this.#build(names);
    for (const [name, row] of this.#rows) row.show({goal: goals[name], horizon, lanes, verdicts});
    this.#score.replaceChildren(...(names.length ? [
      element('span', {class: 'goal-score-name'}, 'score'),
      ...lanes.map((lane, index) => chip(lane, scoreOf(verdicts[index], names))),
    ] : []));
  }

  /** @param {string[]} names */
  #build(names) {
    const known = this.#rows;
    if (names.join('\n') === [...known.keys()].join('\n')) return;
    this.#rows = new Map(names.map((name) => (
      [name, known.get(name) ?? new GoalRow(name, this.#edits, () => this.#show())]
    )));
    for (const [name, {element: row}] of known) if (!this.#rows.has(name)) row.remove();
    [...this.#rows.values()].forEach(({element: row}, index) => {
      // One that is moved would lose the focus.
      if (this.#list.children[index] !== row) this.#list.insertBefore(row, this.#list.children[index] ?? null);
    });
  }
}

/**
 * @param {import('../api/preview_message.js').Verdict|null} verdict
 * @param {string[]} names of the goals
 * @returns {number|null|undefined} nothing while it is the score of other goals
 */
function scoreOf(verdict, names) {
  const judged = Object.keys(verdict?.ratios ?? {});
  const same = judged.length === names.length && names.every((name) => judged.includes(name));
  return same ? verdict?.score : undefined;
}
