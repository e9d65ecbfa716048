// @ts-check
/** The worst that was found: where it is, what came of it beside the nominal, what was tried. */

import {element} from '../dom/element.js';
import {replayEntry} from '../api/requests/studies.js';
import {isWatching} from '../api/watch_only.js';
import {withUnit} from '../fields/quantity.js';
import {figureHeading, figureNumber, threeDigits} from '../figures/columns.js';
import {goalWords, ratioText} from '../goals/words.js';
import {LensCard} from '../lenses/card.js';
import {LensFigure} from '../lenses/figure.js';
import {goThere} from './go_there.js';
import {STUDIED, QUANTITIES, classOf, colorOf, failureOf} from './outcome_words.js';
import {triesFigure} from './tries_figure.js';

/** @typedef {import('../api/requests/studies.js').Study} Study */
/** @typedef {import('../api/requests/studies.js').Draw} Draw */
/** @typedef {import('../api/preview_message.js').LaneResponse} LaneResponse */

const HEIGHT = 190;
const DIGITS = 4;
const CAUTION = 'Worst found, not guaranteed: of what was not tried it proves nothing.';
const REASON = 'studies';

/** Shows a search for the worst. */
export class WorstResult {
  element;
  #api;
  #desk;
  #where = element('ul', {class: 'study-ranges', 'aria-label': 'Values of the worst found'});
  #body = element('tbody');
  #found;
  #beside;
  #tried;
  #figure = new LensFigure({height: HEIGHT});
  #run;
  #replay;
  #shown = element('p', {class: 'study-words', role: 'status', hidden: true});
  /** @type {Study|null} */ #study = null;
  /** @type {Draw|null} */ #worst = null;
  /** @type {LaneResponse|null} */ #nominal = null;
  #asked = false;
  #refused = false;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../page/right_panel.js').Desk} desk
   */
  constructor(api, desk) {
    this.#api = api;
    this.#desk = desk;
    this.#run = element('button', {
      class: 'button small', type: 'button', hidden: true,
      title: 'The live experiment gets these values; undo brings the present ones back',
      on: {click: () => this.#go()},
    }, 'Run it here');
    this.#replay = element('button', {
      class: 'button small', type: 'button', hidden: true,
      title: 'The 3D view shows both runs once, in real time, in place of the live session',
      on: {click: () => this.#show()},
    }, 'Replay in 3D beside the nominal');
    this.#found = new LensCard({title: 'Worst found', equation: '', words: CAUTION}, this.#where,
      element('div', {class: 'lens-row'}, this.#replay, this.#run), this.#shown);
    const table = element('table', {class: 'lens-table'}, element('thead', {}, element('tr', {},
      ...['', 'nominal', 'worst found'].map((text) => element('th', {scope: 'col'}, text)))), this.#body);
    this.#beside = new LensCard({
      title: 'Beside the nominal', equation: '',
      words: 'The nominal is the study’s experiment as it is. Goals as ratios to their bounds: 1 is just met.',
    }, element('div', {class: 'lens-scroll', tabindex: 0, role: 'region', 'aria-label': 'Nominal and worst found'}, table));
    this.#tried = new LensCard({
      title: 'What was tried', equation: '',
      words: 'Each dot is one try: corners of the ranges first. The line is the worst found so far.',
    }, this.#figure.element);
    this.element = element('div', {class: 'study-result', hidden: true},
      this.#found.element, this.#beside.element, this.#tried.element);
  }

  /**
   * @param {Study} study
   * @param {import('../api/requests/studies.js').Entry[]} entries
   */
  update(study, entries) {
    const draws = /** @type {Draw[]} */ (entries);
    this.element.hidden = !draws.length;
    if (!draws.length) return;
    this.#study = study;
    const worst = draws.reduce((one, other) => (other.outcome.cost > one.outcome.cost ? other : one));
    this.#worst = worst;
    this.#ask(study);
    this.#locate(study, worst);
    this.#tabulate();
    this.#figure.draw(`Largest ratio of each of ${draws.length} tries`, (colors) => (
      triesFigure(colors, draws, colorOf(this.#api, study, colors))
    ));
  }

  /**
   * @param {Study} study
   * @param {Draw} worst
   */
  #locate({experiment}, {values, outcome, index}) {
    this.#run.hidden = this.#replay.hidden = isWatching();
    this.#where.replaceChildren(...Object.entries(values).map(([name, value]) => {
      const [low, high] = experiment.uncertainty[name];
      const {title = name, unit = ''} = QUANTITIES.get(name) ?? {};
      return rangeBar(title, unit, low, high, value);
    }));
    const failure = failureOf(outcome);
    this.#found.facts = [
      {name: 'try', value: String(index + 1)},
      ...(failure ? [] : [{name: 'score', value: ratioText(outcome.score)}]),
      ...(failure ? [] : [{name: 'hard goals', value: outcome.kept ? 'kept' : 'missed'}]),
    ];
    this.#found.finding = failure ? `There it ${failure}.` : '';
  }

  /** The nominal's run, once. @param {Study} study */
  async #ask({experiment, lane}) {
    if (this.#asked || isWatching()) return;
    this.#asked = true;
    const {preview} = this.#desk;
    preview.needed(REASON, true);
    try {
      const alone = {...experiment, lanes: {[lane]: experiment.lanes[lane]}};
      this.#nominal = (await preview.respond(alone)).lanes.get(lane) ?? null;
      this.#tabulate();
    } catch (error) {
      this.#refused = true;
      this.#tabulate();
      this.#beside.finding = `The nominal could not be run: ${/** @type {Error} */ (error).message}`;
    }
    preview.needed(REASON, false);
  }

  /** Both runs in 3D. */
  async #show() {
    const [study, worst] = [this.#study, this.#worst];
    if (!study || !worst) return;
    this.#shown.hidden = false;
    try {
      const {seconds} = await replayEntry(study.id, worst.index);
      this.#shown.textContent = `The 3D view shows, for ${threeDigits(seconds)} s, the nominal solid and the worst found as a red ghost.`;
    } catch (error) {
      this.#shown.textContent = /** @type {Error} */ (error).message;
    }
  }

  #tabulate() {
    const [study, worst] = [this.#study, this.#worst];
    if (!study || !worst) return;
    const {experiment} = study;
    const {outcome} = worst;
    const frozen = this.#nominal?.frozen;
    if (frozen) this.#beside.finding = `The nominal left its bounds as well, at ${threeDigits(frozen.time)} s.`;
    // What was measured until then is no figure of a whole run.
    const nominal = frozen ? null : this.#nominal;
    const goals = experiment.goals ?? {};
    const pending = this.#asked && !this.#nominal && !this.#refused && !isWatching() ? '…' : '–';
    const figures = STUDIED.map((figure) => row(figureHeading(figure), figure.meaning, [
      {text: nominal ? figureNumber(figure, reducedOf(figure, nominal.metrics)) : pending, tone: ''},
      {text: figureNumber(figure, outcome.figures[figure.name]), tone: ''},
    ]));
    const ratios = Object.keys(goals).map((name) => {
      const own = nominal?.goals?.ratios[name];
      return row(goalWords(goals[name], experiment.simulation.horizon), name, [
        {text: nominal ? ratioText(own) : pending, tone: nominal ? classOf(goals[name], own) : ''},
        {text: ratioText(outcome.ratios[name]), tone: classOf(goals[name], outcome.ratios[name])},
      ]);
    });
    this.#body.replaceChildren(...figures, ...ratios);
  }

  #go() {
    const [study, worst] = [this.#study, this.#worst];
    if (!study || !worst) return;
    goThere(this.#api, this.#desk, study, worst.index, `worst found of ${study.lane}`);
  }
}

/**
 * @param {import('../figures/figure.js').Figure} figure
 * @param {import('../figures/columns.js').Figures} metrics of a whole run
 * @returns {number|null} one number for all joints, as the server makes it
 */
function reducedOf({name, per_joint: perJoint, reduced}, metrics) {
  const value = metrics?.[name] ?? null;
  if (!perJoint || value === null) return value;
  if (value.includes(null)) return null;
  return reduced === 'mean'
    ? value.reduce((/** @type {number} */ sum, /** @type {number} */ one) => sum + one, 0) / value.length
    : Math.max(...value);
}

/**
 * @param {string} title
 * @param {string} unit
 * @param {number} low
 * @param {number} high
 * @param {number} value
 */
function rangeBar(title, unit, low, high, value) {
  const [from, to, at] = [low, high, Number(value.toPrecision(DIGITS))].map((one) => withUnit(one, unit));
  const bar = element('span', {class: 'study-range', 'aria-hidden': 'true'}, element('span'));
  bar.style.setProperty('--at', String(high > low ? (value - low) / (high - low) : 0.5));
  return element('li', {}, element('span', {class: 'study-range-name'}, title), bar,
    element('span', {class: 'study-range-value'}, at),
    element('span', {class: 'study-range-ends'}, `of ${from} to ${to}`));
}

/**
 * @param {string} heading
 * @param {string} title
 * @param {{text: string, tone: string}[]} cells
 */
function row(heading, title, cells) {
  return element('tr', {}, element('th', {scope: 'row', title}, heading),
    ...cells.map(({text, tone}) => element('td', {class: tone || null}, text)));
}
