// @ts-check
/** What a search for gains has found: plots of its trials, one of them looked at, and what to do. */

import {Compromises} from './compromises.js';
import {FATES, bestSoFar, fateOf, wordsOf} from '../trials/trials.js';
import {FieldNames} from '../fields/field_names.js';
import {Importance} from './importance.js';
import {Parallel} from '../trials/parallel.js';
import {PlotTabs} from '../dom/tab_row.js';
import {PointPlot} from '../trials/point_plot.js';
import {SCHEMA} from '../api/schema_document.js';
import {Schema} from '../fields/schema.js';
import {TrialActions} from './trial_actions.js';
import {TrialPreview} from './trial_preview.js';
import {TrialTable} from './trial_table.js';
import {element, freshId} from '../dom/element.js';
import {progressSheet} from './progress.js';
import {triedStill} from './tried_gains.js';

/** @typedef {import('../trials/trials.js').Study} Study */
/** @typedef {import('../trials/trials.js').Trial} Trial */
/** @typedef {import('../trials/point_plot.js').PointSheet} PointSheet */
/** @typedef {'progress'|'compromises'|'parallel'|'importance'} Tab */

const TABS = /** @type {{id: Tab, title: string}[]} */ ([
  {id: 'progress', title: 'Progress'},
  {id: 'compromises', title: 'Compromises'},
  {id: 'parallel', title: 'Gains and score'},
  {id: 'importance', title: 'Importance'},
]);

const BEST = 'Best so far: goals are missed by fewer per cents, hard ones first; where that is the same, the mean '
  + 'error is smaller.';
const EDGE = 'What lies on the edge of the plot lies beyond it.';

/** The result of one search after another; `update` says which. */
export class SearchResult {
  element;
  #api;
  #names;
  #points;
  #compromises;
  #parallel;
  #importance;
  #preview;
  #table;
  #actions;
  #tabs;
  /** @type {Tab} */ #tab = 'progress';
  #legend = element('div', {
    class: 'search-legend', role: 'group', 'aria-label': 'Meaning of the marks',
  });
  #slider = element('input', {
    id: freshId('search-trial'), type: 'range', class: 'search-slider', min: 0, max: 0, step: 1,
    on: {input: () => this.#chooses(Number(this.#slider.value))},
  });
  #follow = element('button', {
    class: 'button small', type: 'button', title: 'Speak of the best trial, whichever that is',
    on: {click: () => this.#chooses(null)},
  }, 'Best so far');
  #words = element('p', {class: 'search-words', role: 'status'});
  #empty = element('p', {class: 'search-empty'});
  #content;
  #pictures;
  /** @type {Study|null} */ #study = null;
  /** @type {Trial[]} */ #trials = [];
  #best = -1;
  /** @type {number|null} */ #chosen = null;
  /** @type {number|null} tried before the page was loaded anew, and not heard of yet */ #awaited = null;
  /** @type {number|null} */ #focused = null;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../page/right_panel.js').Desk} desk
   */
  constructor(api, desk) {
    this.#api = api;
    this.#names = new FieldNames(new Schema(SCHEMA), api);
    const on = {
      focus: (/** @type {number|null} */ number) => this.#focus(number),
      choose: (/** @type {number} */ number) => this.#chooses(number),
    };
    this.#points = new PointPlot(on);
    this.#compromises = new Compromises(() => this.#draw());
    this.#parallel = new Parallel(this.#names, {...on, brush: () => this.#draw()});
    this.#importance = new Importance(this.#names);
    this.#preview = new TrialPreview(api);
    this.#table = new TrialTable(this.#names);
    this.#actions = new TrialActions(api, desk, {
      keep: () => this.#chooses(this.#kept),
      reject: () => this.#chooses(null),
    });
    this.#pictures = element('div', {class: 'search-pictures', tabindex: -1},
      this.#compromises.element, this.#points.element, this.#legend, this.#parallel.element,
      this.#importance.element);
    this.#tabs = new PlotTabs(TABS, this.#pictures, (id) => this.#show(/** @type {Tab} */ (id)));
    this.#content = element('div', {hidden: true}, this.#tabs.element, this.#pictures,
      element('div', {class: 'search-row search-pick'},
        element('label', {class: 'search-label', for: this.#slider.id}, 'Trial'), this.#slider,
        this.#follow),
      this.#words, this.#preview.element, this.#actions.element, this.#table.element);
    this.element = element('div', {class: 'search-result'}, this.#empty, this.#content);
    this.#show('progress');
  }

  /**
   * @param {Study} study a search
   * @param {Trial[]} entries all of its trials so far, in their order
   */
  update(study, entries) {
    const other = study.id !== this.#study?.id;
    this.#study = study;
    this.#trials = entries;
    this.#best = bestSoFar(entries).at(-1) ?? -1;
    if (other) {
      this.#chosen = null;
      this.#focused = null;
      this.#awaited = this.#triedIn(study);
      this.#compromises.begin(study);
      this.#parallel.begin();
      this.#preview.begin(study);
    }
    if (this.#awaited !== null && this.#awaited < entries.length) {
      this.#chosen = this.#awaited;
      this.#awaited = null;
    }
    this.#empty.hidden = entries.length > 0;
    this.#empty.textContent = noneYet(study);
    this.#content.hidden = !entries.length;
    this.#slider.max = String(Math.max(entries.length - 1, 0));
    this.#draw();
    this.#look();
  }

  /** The study is left. */
  close() { this.#actions.close(); }

  /**
   * @param {Study} study
   * @returns {number|null} its trial whose gains the live lane was given before the page was loaded anew
   */
  #triedIn({id}) {
    const origin = triedStill(this.#api.experiment)?.origin;
    return origin?.study === id ? origin.trial : null;
  }

  /** @returns {number|null} the trial that is spoken of: the chosen one, or else the best so far */
  get #kept() { return this.#chosen ?? (this.#best < 0 ? null : this.#best); }

  /** @param {Tab} tab */
  #show(tab) {
    this.#tab = tab;
    this.#tabs.select(tab);
    const plot = tab === 'progress' || tab === 'compromises';
    this.#compromises.element.hidden = tab !== 'compromises';
    this.#points.element.hidden = !plot;
    this.#legend.hidden = !plot;
    this.#parallel.element.hidden = tab !== 'parallel';
    this.#importance.element.hidden = tab !== 'importance';
    this.#draw();
  }

  #draw() {
    const study = this.#study;
    const trials = this.#trials;
    if (!study || !trials.length) return;
    if (this.#tab === 'parallel') this.#parallel.draw(study, trials, this.#marked);
    else if (this.#tab === 'importance') {
      this.#importance.show(study, trials.length, Object.keys(trials[0].values).length);
    } else this.#drawPoints(study, trials);
  }

  /** @returns {PointSheet['marked']} */
  get #marked() {
    /** @type {[import('../trials/point_marks.js').Mark, number|null][]} */
    const marks = [['present', 0], ['best', this.#best < 0 ? null : this.#best],
      ['chosen', this.#chosen], ['focused', this.#focused]];
    return /** @type {PointSheet['marked']} */ (marks.filter(([, number]) => number !== null));
  }

  /**
   * @param {Study} study
   * @param {Trial[]} trials
   */
  #drawPoints(study, trials) {
    const {within} = this.#parallel;
    const passes = (/** @type {number} */ number) => !within || within.has(number);
    const marked = this.#marked;
    const sheet = this.#tab === 'progress'
      ? progressSheet(trials, study.total, {passes, marked})
      : this.#compromises.sheet(study, trials, {passes, marked});
    this.#points.draw(sheet);
    this.#tellMarks(new Set(sheet.fates), sheet.marked.some(([mark]) => mark === 'front'));
  }

  /**
   * @param {Set<import('../trials/trials.js').Fate>} fates
   * @param {boolean} front
   */
  #tellMarks(fates, front) {
    const known = /** @type {import('../trials/trials.js').Fate[]} */ (Object.keys(FATES));
    const marks = [
      ...known.filter((fate) => fates.has(fate)).map((fate) => [fate, FATES[fate]]),
      ['present', 'gains before'],
      ['best', 'best so far'],
      ...(front ? [['front', 'no other beats it in every soft goal']] : []),
    ];
    const built = marks.join();
    if (this.#legend.dataset.built === built) return;
    this.#legend.dataset.built = built;
    this.#legend.title = `${BEST} ${EDGE}`;
    this.#legend.replaceChildren(...marks.map(([mark, text]) => element('span', {},
      element('i', {class: `search-mark is-${mark}`, 'aria-hidden': 'true'}), text)));
  }

  /** Bring up to date what is said of the trial that is looked at. */
  #look() {
    const study = this.#study;
    const present = this.#trials[0] ?? null;
    if (!study || !present || this.#awaited !== null) return;
    const kept = this.#trials[this.#kept ?? 0];
    const trial = this.#trials[this.#focused ?? kept.number];
    this.#preview.show(trial, present);
    this.#table.show(study, trial, present);
    this.#actions.show(study, kept);
    this.#slider.value = String(kept.number);
    this.#slider.setAttribute('aria-valuetext', wordsOf(kept));
    this.#follow.disabled = this.#chosen === null;
    const text = `${wordsOf(trial)}${this.#standing(trial)}.`;
    if (this.#words.textContent !== text) this.#words.textContent = text;
    this.#words.dataset.fate = fateOf(trial);
  }

  /** @param {Trial} trial */
  #standing({number}) {
    return [
      number === 0 ? 'the gains before' : '', number === this.#best ? bestWords(this.#trials[number]) : '',
      number === this.#chosen ? 'chosen' : '',
    ].filter(Boolean).map((text) => `; ${text}`).join('');
  }

  /** @param {number|null} number */
  #focus(number) {
    if (number === this.#focused) return;
    this.#focused = number;
    this.#look();
    if (this.#tab !== 'importance') this.#draw();
  }

  /** @param {number|null} number null: whichever is the best */
  #chooses(number) {
    if (number === this.#chosen) return;
    this.#chosen = number;
    this.#focused = null;
    this.#draw();
    this.#look();
  }
}

/** @param {Trial} best */
function bestWords(best) {
  return fateOf(best) === 'missed' ? 'the best so far, as none keeps every hard goal' : 'the best so far';
}

/**
 * @param {Study} study without a trial
 * @returns {string} why nothing may be seen for a while
 */
function noneYet({wanted: {draws}}) {
  return `The gains before are run first${draws ? `, at ${draws} draws` : ''}.`;
}
