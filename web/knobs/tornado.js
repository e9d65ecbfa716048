// @ts-check
/** Which knob next: every gain of a lane a little down and a little up, ranked by its effect. */

import {versionOf} from '../fields/law_versions.js';
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
const PERCENT = Math.round(CHANGE * 100);
const STALE = 'The experiment has changed since.';

/** The card below the head of the gains. */
export class Tornado {
  button;
  card;
  #desk;
  #title = freshId('tornado');
  #now = element('p', {class: 'tornado-now'});
  #progress = element('progress', {class: 'tornado-progress', 'aria-label': 'Runs done'});
  #sides = element('p', {class: 'tornado-sides', 'aria-hidden': 'true', hidden: true},
    element('span', {}, 'better'), element('span', {}, 'worse'));
  #list = element('ol', {class: 'tornado-list'});
  #idle = element('p', {class: 'tornado-idle'});
  #foot = element('p', {class: 'tornado-foot'});
  #alert = element('p', {class: 'control-alert', role: 'alert'});
  #aloud = element('p', {class: 'visually-hidden', role: 'status'});
  /** @type {AbortController|null} */ #run = null;
  /** @type {StudyRow[]} */ #rows = [];
  #isDue = false;
  /** What the rows were computed from, and for which lane. */
  #key = '';
  #lane = '';
  #isRunning = false;
  /** Whether a hand has a slider, which may lie below: the card keeps its height as long as that. */
  #isPressed = false;
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
    this.#now, this.#progress, this.#alert, this.#sides, this.#list, this.#idle, this.#foot, this.#aloud);
    this.#foot.append(
      element('span', {class: 'tornado-fresh'}, `Each gain ${PERCENT} % lower and higher.`),
      element('span', {class: 'tornado-stale'}, STALE),
      element('button', {
        class: 'button small', type: 'button', on: {click: () => this.#start()},
      }, icon('reset'), 'Try again'),
    );
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
    desk.api.addEventListener('moving', () => this.#follow());
    document.addEventListener('pointerdown', ({target}) => this.#press(target), true);
    for (const type of ['pointerup', 'pointercancel']) {
      document.addEventListener(type, () => this.#press(null), true);
    }
  }

  /** @param {EventTarget|null} target */
  #press(target) {
    const isPressed = target instanceof Element && target.matches('.slider');
    if (isPressed === this.#isPressed) return;
    this.#isPressed = isPressed;
    this.#follow();
  }

  get #isDragged() { return this.#isPressed || this.#desk.api.moving; }

  /** Draw what a drag has held back. */
  #follow() {
    if (this.card.hidden || this.#isDragged) return;
    if (this.#isDue) this.#draw();
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
    this.#isRunning = true;
    this.#progress.removeAttribute('value');
    this.#draw();
    try {
      const body = {lane: this.#lane, change: CHANGE};
      await api.runs.study('sensitivity', body, (row) => this.#add(/** @type {StudyRow} */ (row)), run.signal);
    } catch (error) {
      if (run.signal.aborted) return;
      this.#alert.textContent = /** @type {Error} */ (error).message;
    }
    this.#isRunning = false;
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
    if (this.#isRunning && !fresh) {
      this.#run?.abort();
      this.#isRunning = false;
    }
    if (fresh && this.#taken.size) {
      this.#taken.clear();
      this.#draw();
    }
    this.#showState();
  }

  get #present() { return this.#rows.find((row) => row.present); }

  #depends() {
    const {lanes, title, description, ...world} = this.#desk.api.experiment;
    const lane = this.#desk.api.selected;
    return JSON.stringify([lane, lanes[lane], versionOf(lanes[lane]?.law), world]);
  }

  /** Whether the rows still hold: said in a line that is always there, as is the progress's. */
  #showState() {
    const isStale = this.#depends() !== this.#key || this.#run?.signal.aborted === true;
    this.#progress.classList.toggle('is-over', !this.#isRunning);
    if (this.#foot.classList.contains('is-stale') === isStale) return;
    this.#foot.classList.toggle('is-stale', isStale);
    if (isStale) this.#aloud.textContent = STALE;
  }

  #draw() {
    this.#isDue = this.#isDragged;
    if (this.#isDue) return;
    const metric = this.#desk.metric.chosen;
    const now = this.#present?.[metric.name] ?? null;
    this.#now.textContent = wordsOfNow(this.#present, metric, this.#lane);
    // Nothing changes its place before all is known: a bar must not slip from under the pointer.
    const knobs = knobsOf(this.#rows, metric, now, !this.#isRunning);
    const strong = knobs.filter(({reach}) => reach > LEAST);
    const idle = knobs.filter(({reach}) => reach <= LEAST);
    const greatest = Math.max(...strong.map(({reach}) => reach).filter(Number.isFinite), 0.001);
    this.#sides.hidden = !strong.length;
    const focused = document.activeElement?.getAttribute('data-trial');
    this.#list.replaceChildren(...strong.map((knob) => this.#item(knob, now, greatest)));
    const same = focused && this.#list.querySelector(`[data-trial="${focused}"]`);
    if (same) /** @type {HTMLElement} */ (same).focus();
    const done = !this.#isRunning && this.#rows.length > 1;
    const names = idle.flatMap(({name}) => [', ', this.#sign(name)]).slice(1);
    this.#idle.replaceChildren(...(done && names.length ? ['No effect: ', ...names, '.'] : []));
    this.#showState();
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
    const percent = `${row.factor && row.factor < 1 ? '−' : '+'}${PERCENT} %`;
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
