// @ts-check
/** What is doubtful about the numbers, said beside the control that it concerns, with a way out. */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {proposalButton} from './proposal.js';

/** @typedef {import('../fields/merge_patch.js').Document} Document */
/**
 * `title`: what the patch is called, where its values are too many to say it.
 * @typedef {{level: 'info'|'warning', path: string, message: string, patch: Document|null,
 *   title: string}} Note
 */
/** @typedef {Note & {lanes: string[]}} Remark lanes that it is said of */
/**
 * @typedef {{api: import('../api/api.js').Api, history: import('../api/history.js').History,
 *   names: import('../fields/field_names.js').FieldNames, tell: import('../dom/notices.js').Tell}} Desk
 */

const WORDS = {info: 'Note', warning: 'Warning'};

/**
 * @param {HTMLElement} column with the lanes, the gains and the rest of the experiment
 * @param {Desk} desk
 */
export function mountGuard(column, desk) { new Guard(column, desk); }

/** Keeps the remarks in the column in step with the server's. */
class Guard {
  #column;
  #desk;
  /** @type {Map<string, {remark: Remark, line: HTMLElement}>} by what they said at first */
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
    const remarks = remarksOf(api);
    if (api.moving) { this.#follow(remarks); return; }
    if (this.#followed) this.#clear();
    const kept = new Map();
    for (const remark of remarks) {
      for (const [index, place] of this.#placesOf(remark).entries()) {
        const key = JSON.stringify([remark, api.selected, index]);
        const line = this.#lines.get(key)?.line ?? this.#line(remark);
        if (line.parentElement !== place) place.append(line);
        kept.set(key, {remark, line});
      }
    }
    for (const [key, {line}] of this.#lines) if (!kept.has(key)) line.remove();
    this.#lines = kept;
    this.#markGroups();
    this.#markLanes();
  }

  /**
   * Nothing may move under the hand that drags a slider: what stands there says in its own place
   * what is true by now.
   *
   * @param {Remark[]} remarks
   */
  #follow(remarks) {
    const left = [...remarks];
    for (const entry of this.#lines.values()) {
      const {remark: {path, level}, line} = entry;
      const index = left.findIndex((one) => one.path === path && one.level === level);
      // One that stands in two places is true in both.
      const [remark] = left[index]?.title ? [left[index]] : left.splice(index, index < 0 ? 0 : 1);
      line.style.minHeight = `${line.getBoundingClientRect().height}px`;
      line.style.visibility = remark ? '' : 'hidden';
      if (remark && remark.message !== entry.remark.message) {
        line.replaceChildren(...this.#line(remark).childNodes);
        entry.remark = remark;
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
   * @param {Remark} remark
   * @returns {Element[]} the control that it is about, and for a way out of all the lanes' trouble
   *   the lanes
   */
  #placesOf({path, title}) {
    const control = this.#column.querySelector(`.control[data-path="${CSS.escape(path)}"]`);
    const lanes = title ? this.#column.querySelector('.lanes') : null;
    return [control, lanes].flatMap((place) => place ?? []);
  }

  /** @param {Remark} remark */
  #line({level, path, message, patch, title, lanes}) {
    const {api} = this.#desk;
    const others = lanes.length < api.lanes.length && !path.startsWith('lanes.');
    const text = element('span', {class: 'guard-text'},
      element('span', {class: 'visually-hidden'}, `${WORDS[level]}: `),
      others && element('b', {}, `${lanes.join(', ')}: `), message);
    return element('div', {class: `guard is-${level}`},
      icon(level === 'warning' ? 'warning' : 'info'), text, patch && proposalButton(
        this.#desk, patch, title ? {title, done: () => thaw(api)} : {},
      ));
  }

  /** A closed group says that there is something in it. */
  #markGroups() {
    for (const group of this.#column.querySelectorAll('details.group')) {
      const notes = [...group.querySelectorAll('.guard')];
      const closed = !(/** @type {HTMLDetailsElement} */ (group).open);
      const grave = notes.some((note) => note.classList.contains('is-warning'));
      mark(group.querySelector('summary'), closed ? notes.length : 0, grave, '');
    }
  }

  /** What is said of gains that aren't on the screen. */
  #markLanes() {
    const {api} = this.#desk;
    for (const row of this.#column.querySelectorAll('.lane')) {
      const name = row.getAttribute('data-lane') ?? '';
      const own = notesOf(api, name).filter(({path}) => path.startsWith('lanes.'));
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
 * @returns {Note[]}
 */
function notesOf(api, lane) { return api.metrics?.lanes?.[lane]?.notes ?? []; }

/**
 * What is said of several lanes in the same words is one remark; the selected lane's come first,
 * and the grave ones before the others.
 *
 * @param {import('../api/api.js').Api} api
 * @returns {Remark[]}
 */
function remarksOf(api) {
  const names = api.lanes.map(({name}) => name);
  const order = [api.selected, ...names.filter((name) => name !== api.selected)];
  /** @type {Map<string, Remark>} */ const found = new Map();
  for (const lane of order) {
    for (const note of notesOf(api, lane)) {
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
  const old = place.querySelector('.guard-badge');
  if (!count) { old?.remove(); return; }
  if (old?.getAttribute('data-words') === words && old.getAttribute('title') === title) return;
  old?.remove();
  const badge = element('span', {
    class: `guard-badge ${grave ? 'is-warning' : 'is-info'}`, 'data-words': words, title,
  }, icon(grave ? 'warning' : 'info'), element('span', {class: 'visually-hidden'}, words),
  count > 1 && element('span', {'aria-hidden': 'true'}, String(count)));
  place.insertBefore(badge, before ? place.querySelector(before) : null);
}
