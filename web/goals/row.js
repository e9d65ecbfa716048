// @ts-check
/** One goal in the list: its words, which are moved with the arrow keys, and every lane's ratio. */

import {JOINTS} from '../api/arm.js';
import {element} from '../dom/element.js';
import {isWatching} from '../api/watch_only.js';
import {boundedBy, goalWords, ratioText} from './words.js';

/** @typedef {import('./words.js').Goal} Goal */
/** @typedef {import('../api/preview_message.js').Verdict} Verdict */
/** @typedef {import('./edits.js').GoalPatch} GoalPatch */
/**
 * @typedef {{goal: Goal, horizon: number, lanes: import('../api/api.js').Lane[],
 *   verdicts: (Verdict|null)[]}} Shown `verdicts` of the lanes, in their order
 */

/** Of a bound, by one key press; ten of them with Shift or a page key. Ours. */
const SHARE = 0.02;
const WIDE = 10;
/** Of an instant in [s]. Ours. */
const INSTANT = 0.1;
const DIGITS = 3;
const UP = new Map([['ArrowUp', 1], ['ArrowDown', -1], ['PageUp', WIDE], ['PageDown', -WIDE]]);
const ALONG = new Map([['ArrowRight', INSTANT], ['ArrowLeft', -INSTANT]]);
const KEYS = '↑ ↓ move its bound, ← → its beginning, Shift ← → its end';

/** A row; it is filled in place, so that the focus and the keys held down stay. */
export class GoalRow {
  element;
  #name;
  #edits;
  #words;
  #joint = element('select', {class: 'select goal-joint'}, ...jointOptions());
  #priority = element('button', {class: 'goal-priority', type: 'button'});
  #remove = element('button', {class: 'goal-remove', type: 'button', title: 'Remove'}, '×');
  #ratios = element('span', {class: 'goal-ratios'});
  #keyed = false;
  /** @type {Shown|null} */ #shown = null;

  /**
   * @param {string} name
   * @param {import('./edits.js').GoalEdits} edits
   * @param {() => void} moved it reads differently now
   */
  constructor(name, edits, moved) {
    this.#name = name;
    this.#edits = edits;
    this.#words = element('span', {class: 'goal-words', on: isWatching() ? {} : {
      keydown: (event) => this.#pressed(event, moved),
      keyup: () => this.#end(),
      blur: () => this.#end(),
    }});
    this.#remove.setAttribute('aria-label', `Remove ${name}`);
    this.#joint.setAttribute('aria-label', `Joint of ${name}`);
    this.#joint.addEventListener('change', () => {
      edits.change(name, {joint: Number(this.#joint.value)}, `joint of ${name}`);
    });
    this.#remove.addEventListener('click', () => edits.change(name, null, `remove ${name}`));
    this.#priority.addEventListener('click', () => {
      const other = otherPriority(this.#shown?.goal);
      edits.change(name, {priority: other}, `${name} ${other}`);
    });
    const buttons = isWatching() ? [] : [this.#priority, this.#remove];
    this.element = element('li', {class: 'goal', 'data-goal': name},
      element('div', {class: 'goal-head'}, this.#words, ...buttons),
      element('div', {class: 'goal-foot'}, isWatching() ? null : this.#joint, this.#ratios));
  }

  /** @param {Shown} shown */
  show(shown) {
    this.#shown = shown;
    const {goal, horizon, lanes, verdicts} = shown;
    const words = goalWords(goal, horizon);
    const {joints, factor} = boundedBy(goal);
    if (this.#words.textContent !== words) this.#words.textContent = words;
    this.#words.title = `${this.#name}${isWatching() ? '' : `: ${KEYS}`}`;
    if (!isWatching()) {
      for (const [attribute, value] of Object.entries({
        role: 'spinbutton', tabindex: 0, 'aria-label': `Bound of ${this.#name}`,
        'aria-valuenow': goal.bound * factor, 'aria-valuetext': words,
      })) this.#words.setAttribute(attribute, String(value));
    }
    this.#joint.hidden = !joints;
    this.#joint.value = String(goal.joint);
    const other = otherPriority(goal);
    this.#priority.textContent = goal.priority;
    this.#priority.title = `Make it ${other}`;
    this.#priority.setAttribute('aria-label', `${this.#name} is ${goal.priority}: make it ${other}`);
    this.#ratios.replaceChildren(...lanes.map((lane, index) => (
      chip(lane, verdicts[index]?.ratios[this.#name])
    )));
  }

  /**
   * @param {KeyboardEvent} event
   * @param {() => void} moved
   */
  #pressed(event, moved) {
    const {key, shiftKey, ctrlKey, metaKey, altKey} = event;
    const goal = this.#edits.all[this.#name];
    if (!goal || ctrlKey || metaKey || altKey) return;
    const change = changeBy(goal, key, shiftKey, this.#shown?.horizon ?? 0);
    if (!change) return;
    event.preventDefault();
    // The page has another use for arrows.
    event.stopPropagation();
    this.#keyed = true;
    this.#edits.move(this.#name, change);
    moved();
  }

  #end() {
    if (!this.#keyed) return;
    this.#keyed = false;
    this.#edits.end();
  }
}

/**
 * @param {Goal} goal
 * @param {string} key
 * @param {boolean} wide
 * @param {number} horizon in [s]
 * @returns {GoalPatch|null}
 */
function changeBy(goal, key, wide, horizon) {
  const steps = UP.get(key);
  const along = ALONG.get(key);
  if (steps) {
    const {factor} = boundedBy(goal);
    const shown = goal.bound * factor * (1 + SHARE) ** (steps * (wide ? WIDE : 1));
    return {bound: exact(Number(shown.toPrecision(DIGITS)) / factor)};
  }
  if (!along || goal.kind !== 'response') return null;
  const {start = 0, end = horizon} = goal;
  const last = Math.min(end, horizon);
  if (!wide) return {start: exact(Math.min(Math.max(0, start + along), Math.max(start, last - INSTANT)))};
  const to = exact(Math.max(last + along, start + INSTANT));
  return {end: to >= horizon ? null : to};
}

/** @param {number} value without the rounding error of a sum or a factor */
function exact(value) { return Number(value.toPrecision(12)); }

/** @param {Goal} [goal] */
function otherPriority(goal) { return goal?.priority === 'hard' ? 'soft' : 'hard'; }

/** @returns {HTMLOptionElement[]} every joint, or one of them */
export function jointOptions() {
  return [0, ...JOINTS].map((joint) => (
    element('option', {value: joint}, joint ? `joint ${joint}` : 'every joint')
  ));
}

/**
 * One lane's ratio: green where it keeps to the bound, red where it does not.
 *
 * @param {import('../api/api.js').Lane} lane
 * @param {number|null|undefined} ratio null where the run can't tell, undefined before there is one
 */
export function chip({name, color}, ratio) {
  const known = ratio !== undefined;
  const kept = known && typeof ratio === 'number' && ratio <= 1;
  const words = known ? kept ? 'kept' : 'missed' : 'not computed yet';
  const dot = element('span', {class: 'metrics-dot', 'aria-hidden': 'true'});
  dot.style.setProperty('--lane', color);
  return element('span', {
    class: `goal-chip${known ? kept ? ' is-kept' : ' is-missed' : ''}`, title: `${name}: ${words}`,
    'aria-label': `${name}: ${ratioText(ratio)}, ${words}`, role: 'img',
  }, dot, known ? ratioText(ratio) : '…');
}
