// @ts-check
/** Logs of the real arm as a row of chips: shown or hidden, shifted in time, opened, removed. */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {isWatching} from '../api/watch_only.js';
import {dashOf} from './look.js';

/** @typedef {import('./logs.js').Logs} Logs */
/** @typedef {import('./logs.js').ShownLog} ShownLog */
/**
 * @typedef {{chip: HTMLElement, eye: HTMLButtonElement, name: HTMLButtonElement, box: HTMLInputElement,
 *   find: HTMLButtonElement, failed: HTMLElement, remove: HTMLButtonElement}} Chip
 */

/** Digits after the point of a shift in [s]: a tenth of a row at 1 kHz. */
const DECIMALS = 4;

/** Chips are filled in place: one that is rebuilt under the pointer would lose its click. */
export class LogList {
  element = element('div', {class: 'log-list', role: 'group', 'aria-label': 'Logs of the real arm'});
  #logs;
  #bring;
  #list = element('ul', {class: 'log-chips'});
  /** @type {Map<number, Chip>} */ #chips = new Map();

  /** @param {Logs} logs */
  constructor(logs) {
    this.#logs = logs;
    this.#bring = element('button', {
      type: 'button', class: 'plots-button log-bring', on: {click: () => logs.bring()},
      'aria-label': 'Log of the real arm',
      title: 'A log of the real arm, CSV or MCAP, beside the lanes; dropping the file works too',
    }, icon('upload'), element('span', {}, 'Log'));
    this.element.append(this.#bring, this.#list);
  }

  show() {
    const {list} = this.#logs;
    this.#bring.hidden = isWatching();
    const numbers = new Set(list.map(({number}) => number));
    for (const [number, {chip}] of [...this.#chips]) {
      if (numbers.has(number)) continue;
      if (chip.contains(document.activeElement)) this.#bring.focus({preventScroll: true});
      chip.remove();
      this.#chips.delete(number);
    }
    const shown = list.filter((log) => log.shown).map(({number}) => number);
    for (const log of list) {
      fill(this.#chips.get(log.number) ?? this.#add(log), log, shown.indexOf(log.number));
    }
  }

  /**
   * @param {ShownLog} log
   * @returns {Chip}
   */
  #add({number, name: title}) {
    const logs = this.#logs;
    const now = () => logs.list.find((one) => one.number === number);
    const eye = element('button', {
      type: 'button', class: 'log-eye', 'aria-label': `Show ${title}`,
      on: {click: () => logs.show(number, !now()?.shown)},
    }, element('span', {class: 'log-line', 'aria-hidden': 'true'}));
    const name = element('button', {
      type: 'button', class: 'log-name', 'aria-haspopup': 'dialog', title: `${title}: what it holds, and what to do with it`,
      on: {click: () => { const log = now(); if (log) logs.open(log); }},
    }, title);
    const box = element('input', {
      type: 'number', class: 'log-shift', step: 0.01, 'aria-label': `Shift of ${title} in s`,
      title: 'Added to the log’s time, in s',
      on: {change: () => { if (box.value && Number.isFinite(box.valueAsNumber)) logs.shift(number, box.valueAsNumber); }},
    });
    const find = element('button', {
      type: 'button', class: 'log-find', on: {click: () => logs.shift(number, 'auto')},
      title: 'Find the shift by itself: where log and motion fit best',
    }, 'find');
    const failed = element('span', {class: 'log-failed', role: 'alert'});
    const remove = element('button', {
      type: 'button', class: 'button icon-only small', 'aria-label': `Remove ${title}`,
      on: {click: () => logs.remove(number)},
    }, icon('close'));
    for (const control of [eye, name, box, find, remove]) control.disabled = isWatching();
    const shift = element('span', {class: 'log-at'}, box, element('span', {}, 's'), find);
    const chip = element('li', {class: 'log-chip'}, eye, name, shift, failed, remove);
    this.#list.append(chip);
    const parts = {chip, eye, name, box, find, failed, remove};
    this.#chips.set(number, parts);
    return parts;
  }
}

/**
 * @param {Chip} chip
 * @param {ShownLog} log
 * @param {number} place among those that are shown, -1 for none of them
 */
function fill({chip, eye, box, find, failed}, {name, shown, shift, overlay, failure}, place) {
  chip.classList.toggle('is-hidden', !shown);
  chip.dataset.line = place < 0 ? '' : dashOf(place).name;
  eye.setAttribute('aria-pressed', String(shown));
  eye.title = `${shown ? 'Hide' : 'Show'} ${name}`;
  find.setAttribute('aria-pressed', String(shift === null));
  if (failed.textContent !== failure) failed.textContent = failed.title = failure;
  chip.title = overlay ? overlay.remarks.join('; ') : '';
  const at = shift ?? overlay?.shift;
  const text = at === undefined ? '' : String(Number(at.toFixed(DECIMALS)));
  if (box !== document.activeElement || shift === null) if (box.value !== text) box.value = text;
}
