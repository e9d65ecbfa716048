// @ts-check
/** What is doubtful about the numbers, said beside the control that it concerns, with a way out. */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {proposalButton} from './proposal.js';

/** @typedef {import('../fields/merge_patch.js').Document} Document */
/**
 * `title`: what the patch is called, where its values are too many to say it.
 * @typedef {{level: 'info'|'warning', path: string, message: string, patch: Document|null,
 *   title: string}} Advice
 */
/** @typedef {Advice & {lanes: string[]}} LaneAdvice with the lanes that it is about */
/**
 * @typedef {{api: import('../api/api.js').Api, history: import('../api/undo.js').History,
 *   names: import('../fields/field_names.js').FieldNames, tell: import('../dom/notices.js').Tell}} Desk
 */

const WORDS = {info: 'Note', warning: 'Warning'};

/**
 * @param {HTMLElement} column with the lanes, the gains and the rest of the experiment
 * @param {Desk} desk
 */
export function mountAdvice(column, desk) { new AdviceList(column, desk); }

/** Keeps the advice in the column in step with the server's. */
class AdviceList {
  #column;
  #desk;
  /** @type {Map<string, {advice: LaneAdvice, line: HTMLElement}>} by what they said at first */
  #lines = new Map();
  /** Whether lines have followed a drag since. */
  #followed = false;

  /**
   * @param {HTMLElement} column
   * @param {Desk} desk
   */
  constructor(column, desk) {
    this.#column = column;
    this.#desk = desk;
    const {api} = desk;
    for (const type of ['metrics', 'select', 'hello', 'patch']) {
      api.addEventListener(type, () => this.#show());
    }
    api.addEventListener('moving', () => { if (!api.moving) this.#show(); });
    column.addEventListener('toggle', () => this.#markGroups(), true);
  }

  #show() {
    const {api} = this.#desk;
    const pieces = allAdvice(api);
    if (api.moving) { this.#follow(pieces); return; }
    if (this.#followed) this.#clear();
    const kept = new Map();
    for (const advice of pieces) {
      for (const [index, place] of this.#placesOf(advice).entries()) {
        const key = JSON.stringify([advice, api.selected, index]);
        const line = this.#lines.get(key)?.line ?? this.#line(advice);
        if (line.parentElement !== place) place.append(line);
        kept.set(key, {advice, line});
      }
    }
    for (const [key, {line}] of this.#lines) if (!kept.has(key)) line.remove();
    this.#lines = kept;
    this.#markGroups();
    this.#markLanes();
  }

  /**
   * Nothing may move under the hand that drags a slider: what stands there says in its own place
   * what is true by now, and is grey where it isn't any more.
   *
   * @param {LaneAdvice[]} pieces
   */
  #follow(pieces) {
    const left = [...pieces];
    for (const entry of this.#lines.values()) {
      const {advice: {path, level, title}, line} = entry;
      const index = left.findIndex((one) => (
        one.path === path && one.level === level && one.title === title
      ));
      // One that stands in two places is true in both.
      const [advice] = left[index]?.title ? [left[index]] : left.splice(index, index < 0 ? 0 : 1);
      line.classList.toggle('is-past', !advice);
      const button = line.querySelector('button');
      if (button) button.disabled = !advice;
      if (advice && advice.message !== entry.advice.message) {
        // Asked for only where the text changes: it makes the page lay everything out.
        line.style.minHeight = `${line.getBoundingClientRect().height}px`;
        line.replaceChildren(...this.#line(advice).childNodes);
        entry.advice = advice;
      }
    }
    this.#followed = true;
  }

  #clear() {
    for (const {line} of this.#lines.values()) line.remove();
    this.#lines.clear();
    this.#followed = false;
  }

  /**
   * @param {LaneAdvice} advice
   * @returns {Element[]} the control that it is about, and for a way out of all the lanes' trouble
   *   the lanes
   */
  #placesOf({path, title}) {
    const control = this.#column.querySelector(`.control[data-path="${CSS.escape(path)}"]`);
    const lanes = ofAllLanes(path, title) ? this.#column.querySelector('.lanes') : null;
    return [control, lanes].flatMap((place) => place ?? []);
  }

  /** @param {LaneAdvice} advice */
  #line({level, path, message, patch, title, lanes}) {
    const {api} = this.#desk;
    const others = lanes.length < api.lanes.length && !path.startsWith('lanes.');
    const text = element('span', {class: 'advice-text'},
      element('span', {class: 'visually-hidden'}, `${WORDS[level]}: `),
      others && element('b', {}, `${lanes.join(', ')}: `), message);
    return element('div', {class: `advice is-${level}`},
      icon(level === 'warning' ? 'warning' : 'info'), text, patch && proposalButton(
        this.#desk, patch, ofAllLanes(path, title) ? {title, done: () => thaw(api)} : {title},
      ));
  }

  /** A closed group says that there is something in it. */
  #markGroups() {
    for (const group of this.#column.querySelectorAll('details.group')) {
      const pieces = [...group.querySelectorAll('.advice')];
      const closed = !(/** @type {HTMLDetailsElement} */ (group).open);
      const grave = pieces.some((note) => note.classList.contains('is-warning'));
      mark(group.querySelector('summary'), closed ? pieces.length : 0, grave, '');
    }
  }

  /** What is said of gains that aren't on the screen. */
  #markLanes() {
    const {api} = this.#desk;
    for (const row of this.#column.querySelectorAll('.lane')) {
      const name = row.getAttribute('data-lane') ?? '';
      const own = adviceOf(api, name).filter(({path}) => path.startsWith('lanes.'));
      const shown = name === api.selected ? [] : own;
      const grave = shown.some(({level}) => level === 'warning');
      const title = shown.map(({message}) => message).join('\n');
      mark(row.querySelector('.lane-pick'), shown.length, grave, title, '.lane-status');
    }
  }
}

/**
 * @param {import('../api/api.js').Api} api
 * @param {string} lane
 * @returns {Advice[]}
 */
function adviceOf(api, lane) { return api.metrics?.lanes?.[lane]?.notes ?? []; }

/**
 * What is said of several lanes in the same words is one advice; the selected lane's come first,
 * and the grave ones before the others.
 *
 * @param {import('../api/api.js').Api} api
 * @returns {LaneAdvice[]}
 */
function allAdvice(api) {
  const names = api.lanes.map(({name}) => name);
  const order = [api.selected, ...names.filter((name) => name !== api.selected)];
  /** @type {Map<string, LaneAdvice>} */ const found = new Map();
  for (const lane of order) {
    for (const note of adviceOf(api, lane)) {
      if (note.path.startsWith('lanes.') && lane !== api.selected) continue;
      const key = JSON.stringify([note.level, note.path, note.message, note.patch]);
      const known = found.get(key);
      if (known) known.lanes.push(lane);
      else found.set(key, {...note, lanes: [lane]});
    }
  }
  return [...found.values()].sort((a, b) => (
    Number(b.level === 'warning') - Number(a.level === 'warning')
  ));
}

/**
 * @param {string} path
 * @param {string} title
 * @returns {boolean} whether it is a way out of all the lanes' trouble
 */
function ofAllLanes(path, title) { return title !== '' && !path.startsWith('lanes.'); }

/**
 * Let the lanes that stand still begin anew, all together where it is all of them.
 *
 * @param {import('../api/api.js').Api} api
 */
function thaw(api) {
  const frozen = api.lanes.filter(({name}) => api.session?.lanes[name]?.status === 'frozen');
  if (frozen.length === api.lanes.length) api.reset();
  else for (const {name} of frozen) api.reset(name);
}

/**
 * A small badge with a number, or none.
 *
 * @param {Element|null} place
 * @param {number} count
 * @param {boolean} grave
 * @param {string} title
 * @param {string} [before] what it stands before
 */
function mark(place, count, grave, title, before) {
  if (!place) return;
  const words = `${count} ${grave ? 'warning' : 'note'}${count > 1 ? 's' : ''}`;
  const old = place.querySelector('.advice-badge');
  if (!count) { old?.remove(); return; }
  if (old?.getAttribute('data-words') === words && old.getAttribute('title') === title) return;
  old?.remove();
  const badge = element('span', {
    class: `advice-badge ${grave ? 'is-warning' : 'is-info'}`, 'data-words': words, title,
  }, icon(grave ? 'warning' : 'info'), element('span', {class: 'visually-hidden'}, words),
  count > 1 && element('span', {'aria-hidden': 'true'}, String(count)));
  place.insertBefore(badge, before ? place.querySelector(before) : null);
}
