// @ts-check
/** Which knob next: every gain of a lane a little down and a little up, ranked by its effect. */

import {element, freshId, symbol} from '../dom/element.js';
import {valueText} from '../fields/field_names.js';
import {icon} from '../dom/icons.js';
import {LEAST, effectOf, keyOf, kindOf, knobsOf, wordsOf, wordsOfNow} from './tornado_words.js';

/** @typedef {import('../fields/field_names.js').FieldNames} FieldNames */
/** @typedef {import('./study_metric.js').StudyRow} StudyRow */
/**
 * @typedef {{api: import('../api/api.js').Api, history: import('../api/undo.js').History,
 *   metric: import('./study_metric.js').StudyMetric, names: FieldNames}} Desk
 */
/** @typedef {import('./tornado_words.js').Knob} Knob */

const CHANGE = 0.1;

/** The card below the head of the gains. */
export class Tornado {
  button;
  card;
  #desk;
  #title = freshId('tornado');
  #now = element('p', {class: 'tornado-now'});
  #progress = element('progress', {class: 'tornado-progress', 'aria-label': 'Runs done', hidden: true});
  #sides = element('p', {class: 'tornado-sides', 'aria-hidden': 'true', hidden: true},
    element('span', {}, 'better'), element('span', {}, 'worse'));
  #list = element('ol', {class: 'tornado-list'});
  #idle = element('p', {class: 'tornado-idle'});
  #stale = element('p', {class: 'tornado-stale', role: 'status'});
  #alert = element('p', {class: 'control-alert', role: 'alert'});
  #aloud = element('p', {class: 'visually-hidden', role: 'status'});
  /** @type {AbortController|null} */ #run = null;
  /** @type {StudyRow[]} */ #rows = [];
  /** What the rows were computed from, and for which lane. */
  #key = '';
  #lane = '';
  /** @type {Set<string>} bars whose value was taken */ #taken = new Set();

  /** @param {Desk} desk */
  constructor(desk) {
    this.#desk = desk;
    this.button = element('button', {
      class: 'button small', type: 'button', 'aria-expanded': 'false',
      title: 'Runs the whole response with each gain 10 % lower and 10 % higher',
      on: {click: () => this.#toggle()},
    }, icon('tune'), 'Which knob next?');
    const close = element('button', {
      class: 'button icon-only small', type: 'button', 'aria-label': 'Close',
      on: {click: () => { this.#toggle(); this.button.focus(); }},
    }, icon('close'));
    this.card = element('section', {
      class: 'tornado', hidden: true, 'aria-labelledby': this.#title,
    }, element('header', {class: 'tornado-head'},
      element('h3', {id: this.#title}, 'Which knob next?'), close),
    this.#now, this.#progress, this.#alert, this.#sides, this.#list, this.#idle, this.#stale, this.#aloud);
    this.card.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      event.preventDefault();
      this.#toggle();
      this.button.focus();
    });
    desk.metric.addEventListener('change', () => this.#draw());
    for (const type of ['patch', 'hello', 'select']) {
      desk.api.addEventListener(type, () => this.#check());
    }
  }

  #toggle() {
    const open = this.card.hidden;
    this.card.hidden = !open;
    this.button.setAttribute('aria-expanded', String(open));
    this.button.classList.toggle('is-open', open);
    this.#run?.abort();
    if (open) this.#start();
  }

  async #start() {
    const {api} = this.#desk;
    this.#run?.abort();
    const run = new AbortController();
    this.#run = run;
    this.#rows = [];
    this.#taken.clear();
    this.#lane = api.selected;
    this.#key = this.#depends();
    this.#alert.textContent = '';
    this.#progress.hidden = false;
    this.#progress.removeAttribute('value');
    this.#draw();
    try {
      const body = {lane: this.#lane, change: CHANGE};
      await api.runs.study('sensitivity', body, (row) => this.#add(/** @type {StudyRow} */ (row)), run.signal);
    } catch (error) {
      if (run.signal.aborted) return;
      this.#alert.textContent = /** @type {Error} */ (error).message;
    }
    this.#progress.hidden = true;
    this.#draw();
    this.#aloud.textContent = this.#summary();
  }

  /** @param {StudyRow} row */
  #add(row) {
    this.#rows.push(row);
    this.#progress.max = row.count;
    this.#progress.value = this.#rows.length;
    this.#draw();
  }

  /** What was found may be of an experiment that is no more. */
  #check() {
    if (this.card.hidden) return;
    if (this.#desk.api.selected !== this.#lane) { this.#start(); return; }
    const fresh = this.#depends() === this.#key;
    if (!this.#progress.hidden && !fresh) this.#run?.abort();
    if (fresh && this.#taken.size) {
      this.#taken.clear();
      this.#draw();
    }
    this.#showStale();
  }

  get #present() { return this.#rows.find((row) => row.present); }

  #depends() {
    const {lanes, title, description, ...world} = this.#desk.api.experiment;
    const lane = this.#desk.api.selected;
    return JSON.stringify([lane, lanes[lane], world]);
  }

  #showStale() {
    const fresh = this.#depends() === this.#key;
    const stopped = this.#run?.signal.aborted;
    if (fresh && !stopped) { this.#stale.replaceChildren(); return; }
    if (stopped) this.#progress.hidden = true;
    if (this.#stale.childElementCount) return;
    this.#stale.replaceChildren('The experiment has changed since. ', element('button', {
      class: 'button small', type: 'button', on: {click: () => this.#start()},
    }, icon('reset'), 'Try again'));
  }

  #draw() {
    const metric = this.#desk.metric.chosen;
    const now = this.#present?.[metric.name] ?? null;
    this.#now.textContent = wordsOfNow(this.#present, metric, this.#lane);
    // Nothing changes its place before all is known: a bar must not slip from under the pointer.
    const knobs = knobsOf(this.#rows, metric, now, this.#progress.hidden);
    const strong = knobs.filter(({reach}) => reach > LEAST);
    const idle = knobs.filter(({reach}) => reach <= LEAST);
    const greatest = Math.max(...strong.map(({reach}) => reach).filter(Number.isFinite), 0.001);
    this.#sides.hidden = !strong.length;
    const focused = document.activeElement?.getAttribute('data-trial');
    this.#list.replaceChildren(...strong.map((knob) => this.#item(knob, now, greatest)));
    const same = focused && this.#list.querySelector(`[data-trial="${focused}"]`);
    if (same) /** @type {HTMLElement} */ (same).focus();
    const done = this.#progress.hidden && this.#rows.length > 1;
    const names = idle.flatMap(({name}) => [', ', this.#sign(name)]).slice(1);
    this.#idle.replaceChildren(...(done && names.length ? ['No effect: ', ...names, '.'] : []));
    this.#showStale();
  }

  /** @param {string} name of a gain */
  #named(name) { return this.#desk.names.of(['lanes', this.#lane, name]); }

  /** @param {string} name of a gain */
  #symbol(name) {
    const {symbol: sign, title} = this.#named(name);
    return sign || title;
  }

  /** @param {string} name of a gain */
  #sign(name) {
    const {symbol: sign, title} = this.#named(name);
    return sign ? symbol(sign) : title;
  }

  /**
   * @param {Knob} knob
   * @param {number|null} now
   * @param {number} greatest
   */
  #item({name, rows}, now, greatest) {
    const {title} = this.#named(name);
    const head = element('span', {class: 'tornado-name', title}, this.#sign(name));
    return element('li', {class: 'tornado-knob'}, head, ...rows.map((row) => (
      this.#bar(row, now, greatest)
    )));
  }

  /**
   * @param {StudyRow} row
   * @param {number|null} now
   * @param {number} greatest
   */
  #bar(row, now, greatest) {
    const metric = this.#desk.metric.chosen;
    const effect = effectOf(row, metric, now);
    const percent = `${row.factor && row.factor < 1 ? '−' : '+'}${Math.round(CHANGE * 100)} %`;
    const words = wordsOf(row, metric, this.#present);
    const {unit} = this.#named(row.name);
    const bar = element('span', {class: `tornado-bar ${kindOf(row, effect)}`});
    const length = Number.isFinite(effect) ? Math.min(1, Math.abs(effect) / greatest) : 1;
    bar.style.setProperty('--length', String(length));
    const taken = this.#taken.has(keyOf(row));
    const to = valueText(row.value, unit);
    return element('button', {
      class: 'tornado-row', type: 'button', 'data-trial': keyOf(row), 'aria-pressed': String(taken),
      'aria-label': `${this.#named(row.name).title} ${percent}, to ${to}: ${words}`,
      title: `Set ${this.#symbol(row.name)} = ${to}`, on: {click: () => this.#take(row)},
    }, element('span', {class: 'tornado-percent'}, percent),
    element('span', {class: 'tornado-track'}, bar),
    element('span', {class: 'tornado-words'}, taken && icon('check'), words));
  }

  /** @param {StudyRow} row */
  async #take(row) {
    const {history} = this.#desk;
    this.#alert.textContent = '';
    try {
      await history.change(row.patch, `${this.#named(row.name).title} of ${this.#lane}`);
      this.#taken.add(keyOf(row));
    } catch (error) {
      this.#alert.textContent = /** @type {Error} */ (error).message;
    }
    this.#draw();
  }

  #summary() {
    const metric = this.#desk.metric.chosen;
    const now = this.#present?.[metric.name] ?? null;
    const better = this.#rows
      .filter((row) => !row.present && effectOf(row, metric, now) < -LEAST)
      .sort((a, b) => effectOf(a, metric, now) - effectOf(b, metric, now))[0];
    if (!better) return 'No ±10 % change of one gain improves it.';
    const percent = `${better.factor && better.factor < 1 ? 'down' : 'up'} 10 percent`;
    return `Largest improvement: ${this.#named(better.name).title} ${percent}: `
      + `${wordsOf(better, metric, this.#present)}.`;
  }
}
