// @ts-check
/** What a sweep shows: figures and the score over one field or two; a click goes there. */

import {element, freshId} from '../dom/element.js';
import {SCHEMA} from '../api/schema_document.js';
import {isWatching} from '../api/watch_only.js';
import {FieldNames} from '../fields/field_names.js';
import {valueAt} from '../fields/merge_patch.js';
import {written} from '../fields/quantity.js';
import {Schema} from '../fields/schema.js';
import {figureNumber, figureText} from '../figures/columns.js';
import {ratioText} from '../goals/words.js';
import {LensCard} from '../lenses/card.js';
import {LensFigure} from '../lenses/figure.js';
import {goThere} from './go_there.js';
import {STUDIED, colorOf, failureOf} from './outcome_words.js';
import {curveFigure, mapFigure} from './sweep_figures.js';

/** @typedef {import('../api/requests/studies.js').Study} Study */
/** @typedef {import('../api/requests/studies.js').Point} Point */
/** @typedef {import('../api/requests/studies.js').Outcome} Outcome */
/** @typedef {import('./sweep_figures.js').Swept} Swept */
/** @typedef {{id: string, title: string, value: (outcome: Outcome) => number|null, words: (outcome: Outcome) => string}} Measure */

const HEIGHT = 170;
const MAP_HEIGHT = 340;
const DIGITS = 4;

/** @type {Measure[]} */
const FIGURE_MEASURES = STUDIED.map((figure) => ({
  id: figure.name, title: `${figure.short} [${figure.shown_unit}]`,
  value: ({figures}) => (typeof figures[figure.name] === 'number' ? Number(figures[figure.name]) * figure.factor : null),
  words: ({figures}) => `${figure.short} ${figureText(figure, figures[figure.name])}`,
}));
/** @type {Measure} */
const SCORE = {
  id: 'score', title: 'score', value: ({score}) => score,
  words: ({score}) => `score ${ratioText(score)}`,
};

/** Shows points of a sweep. */
export class SweepResult {
  element;
  #api;
  #desk;
  #names;
  #card;
  #chosen = element('div', {class: 'study-chosen'});
  #measure = element('select', {
    id: freshId('study-measure'), class: 'select', on: {change: () => this.#draw()},
  });
  #which = element('label', {class: 'study-which', for: this.#measure.id, hidden: true}, 'Figure ');
  #places = element('div', {class: 'study-curves'});
  /** @type {Map<string, LensFigure>} */ #figures = new Map();
  /** @type {HTMLSelectElement[]} */ #selects = [];
  #numbers = element('output', {class: 'study-numbers'});
  #go = element('button', {class: 'button small', type: 'button', on: {click: () => this.#goTo(this.#place)}}, 'Go there');
  /** @type {Study|null} */ #study = null;
  /** @type {Point[]} */ #points = [];
  /** @type {Swept[]} */ #axes = [];
  /** @type {number|null} the value that is marked */ #marked = null;
  #listening = new AbortController();

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../page/right_panel.js').Desk} desk
   */
  constructor(api, desk) {
    this.#api = api;
    this.#desk = desk;
    this.#names = new FieldNames(new Schema(SCHEMA), api);
    this.#which.append(this.#measure);
    this.#card = new LensCard({title: 'Over the values', equation: '', words: ''},
      this.#which, this.#places, this.#chosen);
    this.element = element('div', {class: 'study-result', hidden: true}, this.#card.element);
    const {signal} = this.#listening;
    for (const type of ['hello', 'patch']) api.addEventListener(type, () => this.#mark(), {signal});
  }

  /** The study is left. */
  close() { this.#listening.abort(); }

  /**
   * @param {Study} study
   * @param {import('../api/requests/studies.js').Entry[]} entries
   */
  update(study, entries) {
    this.#points = /** @type {Point[]} */ (entries);
    this.element.hidden = !entries.length || !study.result.axes;
    if (this.element.hidden) return;
    if (!this.#axes.length) this.#lay(study);
    this.#study = study;
    const gone = this.#points.filter(({outcome}) => failureOf(outcome)).length;
    this.#card.finding = gone ? `${gone} of ${entries.length} runs left their bounds or were refused: a cross each.` : '';
    this.#draw();
    this.#tell();
  }

  /** @param {Study} study what doesn't change: its axes */
  #lay(study) {
    /** @type {{field: string, values: number[]}[]} */ const {axes} = study.result;
    this.#axes = axes.map(({field, values}, index) => ({
      ...this.#nameOf(study, field), values, log: Boolean(study.wanted.axes[index].logarithmic),
    }));
    const go = isWatching() ? '' : `A click on a ${axes.length > 1 ? 'cell' : 'point'} goes there: the live `
      + 'experiment gets these values, and undo takes them back.';
    const now = axes.length > 1 ? '' : 'Dotted line: the value that the live experiment has.';
    this.#card.words = [go, now].filter(Boolean).join(' ');
    const goals = Object.keys(study.experiment.goals ?? {}).length > 0;
    this.#measure.replaceChildren(...[...FIGURE_MEASURES, ...(goals ? [SCORE] : [])].map(({id, title}) => (
      element('option', {value: id}, title)
    )));
    this.#which.hidden = axes.length < 2;
    this.#selects = this.#axes.map(({name, values}) => element('select', {
      class: 'select', 'aria-label': name, on: {change: () => this.#tell()},
    }, ...values.map((value, place) => element('option', {value: place}, inDigits(value)))));
    this.#go.hidden = isWatching();
    this.#chosen.replaceChildren(...this.#axes.flatMap(({name}, index) => (
      [element('span', {}, name), this.#selects[index]]
    )), this.#numbers, this.#go);
  }

  /**
   * @param {Study} study
   * @param {string} field
   */
  #nameOf({lane}, field) {
    const path = field.includes('.') ? field.split('.') : ['lanes', lane, field];
    const {symbol, title, unit} = this.#names.of(path);
    const short = symbol && !symbol.includes('_') ? symbol : title;
    return {short, unit, path, name: unit ? `${short} [${unit}]` : short};
  }

  /** Draw anew where the live experiment has another value than the one that is marked. */
  #mark() {
    const [along, up] = this.#axes;
    if (along && !up && this.#now(along) !== this.#marked) this.#draw();
  }

  #draw() {
    const study = this.#study;
    if (!study) return;
    const measures = [...this.#measure.options].map(({value}) => (
      [...FIGURE_MEASURES, SCORE].find(({id}) => id === value) ?? SCORE
    ));
    const [along, up] = this.#axes;
    const map = Boolean(up);
    const now = this.#marked = map || !along ? null : this.#now(along);
    const shown = map ? measures.filter(({id}) => id === this.#measure.value) : measures;
    const figures = shown.map((measure) => {
      const id = map ? 'map' : measure.id;
      let figure = this.#figures.get(id);
      if (!figure) {
        figure = new LensFigure({height: map ? MAP_HEIGHT : HEIGHT, click: ({customdata}) => this.#goTo(customdata)});
        this.#figures.set(id, figure);
      }
      figure.element.dataset.panel = measure.id;
      const drawn = {title: measure.title, points: this.#points.map((point) => this.#shown(measure, point))};
      figure.draw(`${measure.title} over ${this.#axes.map(({name}) => name).join(' and ')}`, (colors) => (
        map ? mapFigure(colors, [along, up], drawn) : curveFigure(colors, along, drawn, colorOf(this.#api, study, colors), now)
      ));
      return figure.element;
    });
    if ([...this.#places.children].some((one, index) => one !== figures[index]) || this.#places.children.length !== figures.length) {
      this.#places.replaceChildren(...figures);
    }
    this.#places.classList.toggle('is-map', map);
  }

  /**
   * @param {Swept} axis
   * @returns {number|null} what the live experiment has there; of the gains of six joints the greatest
   */
  #now({path}) {
    const numbers = [valueAt(this.#api.experiment, path)].flat();
    if (!numbers.every((one) => typeof one === 'number')) return null;
    if (numbers.every((one) => one === numbers[0])) return numbers[0];
    return path[0] === 'lanes' ? Math.max(...numbers.map(Math.abs)) : null;
  }

  /**
   * @param {Measure} measure
   * @param {Point} point
   */
  #shown(measure, {values, outcome}) {
    const failure = failureOf(outcome);
    return {
      value: measure.value(outcome), gone: Boolean(failure),
      words: `${this.#where(values)}: ${failure || measure.words(outcome)}`,
    };
  }

  /**
   * @param {number[]} values of the axes
   * @returns {string} such as `ν = 7 1/s, Lag of the drives = 0.002 s`
   */
  #where(values) {
    return values.map((value, index) => (
      `${this.#axes[index].short} = ${inDigits(value)} ${this.#axes[index].unit}`.trim()
    )).join(', ');
  }

  /** Which point the lists say; the last axis is the fastest. */
  get #place() {
    return this.#selects.reduce((place, select, index) => (
      place * this.#axes[index].values.length + Number(select.value)
    ), 0);
  }

  /** Say what came of the chosen point. */
  #tell() {
    const point = this.#points[this.#place];
    this.#go.disabled = !point;
    const failure = point ? failureOf(point.outcome) : 'not run yet';
    const text = failure || STUDIED.map((figure) => (
      `${figure.short} ${figureNumber(figure, point.outcome.figures[figure.name])} ${figure.shown_unit}`
    )).join(', ');
    if (this.#numbers.textContent !== text) this.#numbers.textContent = text;
  }

  /** @param {number} place */
  #goTo(place) {
    const [study, point] = [this.#study, this.#points[place]];
    if (!study || !point || isWatching()) return;
    let rest = place;
    for (const [index, select] of [...this.#selects.entries()].reverse()) {
      const {length} = this.#axes[index].values;
      select.value = String(rest % length);
      rest = Math.floor(rest / length);
    }
    this.#tell();
    goThere(this.#api, this.#desk, study, place, this.#where(point.values));
  }
}

/** @param {number} value */
function inDigits(value) { return written(Number(value.toPrecision(DIGITS))); }
