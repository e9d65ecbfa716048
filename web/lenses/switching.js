// @ts-check
/** Sign, saturation, tanh and implicit side by side, everything else equal. */

import {element} from '../dom/element.js';
import {LensCard} from './card.js';
import {LensFigure} from './figure.js';
import {keyOf} from '../fields/response_key.js';
import {spectrumFigure} from './spectrum.js';
import {figureHeading, figureNumber, figureText, threeDigits} from '../figures/columns.js';
import {figureOf} from '../figures/figure.js';
import {RUNS_ARE_THE_OWNERS, isWatching} from '../api/watch_only.js';

/** @typedef {import('./card.js').Look} Look */
/** @typedef {{name: string, dash: string, seen?: any, refused?: string}} Trial */

const [ERROR, MOST, VARIATION, ABOVE] = [
  'mae', 'max_error', 'chattering', 'high_frequency_torque',
].map(figureOf);
const FUNCTIONS = /** @type {const} */ ([
  ['sign', 'dot'], ['saturation', 'dash'], ['tanh', 'solid'], ['implicit', 'dashdot'],
]);
/** A preset in whose sampled loop sign chatters. */
const SAMPLED_PRESET = 'chattering-tanh';

/** Runs each of them when asked. */
export class SwitchingCard {
  element;
  #api;
  #desk;
  #figure = new LensFigure({height: 260});
  #button;
  #note = element('p', {class: 'lens-note', role: 'status'});
  #body = element('tbody');
  #table;
  #way;
  #card;
  /** @type {Trial[]} */ #trials = [];
  #compared = '';
  /** @type {AbortController|null} */ #running = null;
  /** @type {Look|null} */ #look = null;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../page/right_panel.js').Desk} desk
   */
  constructor(api, desk) {
    this.#api = api;
    this.#desk = desk;
    this.#button = element('button', {
      class: 'button small', type: 'button', on: {click: () => this.#pressed()},
    });
    this.#table = element(
      'div', {class: 'lens-scroll', tabindex: 0, role: 'region', 'aria-label': 'Switching functions'},
      element('table', {class: 'lens-table'}, heading(), this.#body),
    );
    this.#way = element(
      'p', {class: 'lens-note'}, 'Nothing is sampled in continuous mode, so sign(S) holds S at zero '
        + 'and does not chatter. A real controller is sampled: ',
      element('button', {
        class: 'button small', type: 'button', on: {click: () => desk.presets.load(SAMPLED_PRESET)},
      }, `Load the preset ${SAMPLED_PRESET}`),
    );
    this.#card = new LensCard({
      title: 'Sign, saturation, tanh', equation: 'Eq. 10–13',
      words: 'sign(S) applies the full k₂ wherever S is not zero, so a sampled controller '
        + 'switches endlessly; saturation and tanh ease off within ε. implicit, for a law with a '
        + 'model, takes the sign at the end of the period. One run of each, all else equal.',
    }, element('div', {class: 'lens-row'}, this.#button, this.#note), this.#table, this.#way,
    this.#figure.element);
    this.element = this.#card.element;
  }

  /** @param {Look} look */
  show(look) {
    if (this.#look && this.#look.lane !== look.lane) {
      this.#running?.abort();
      this.#trials = [];
    }
    this.#look = look;
    this.#draw();
  }

  /** Those that the lane's law takes: implicit needs a model of the arm, and a term k₂. */
  #functions() {
    const gains = this.#api.experiment.lanes?.[this.#look?.lane ?? ''] ?? {};
    const law = this.#api.laws.find(({name}) => name === gains.law);
    const takes = law?.model_based && gains.reaching !== 'power';
    return FUNCTIONS.filter(([name]) => name !== 'implicit' || takes);
  }

  #key() { return keyOf(this.#api.experiment, this.#look?.lane ?? '', ['switching']); }

  async #pressed() {
    if (this.#running) {
      this.#running.abort();
      return;
    }
    const lane = this.#look?.lane;
    if (!lane) return;
    this.#running = new AbortController();
    const {signal} = this.#running;
    this.#trials = [];
    await this.#api.settled();
    this.#compared = this.#key();
    // All of the same experiment, whatever becomes of the live one meanwhile.
    const {experiment} = this.#api;
    for (const [name, dash] of this.#functions()) {
      if (!switchesIn(this.#api.experiment, lane)) break;
      this.#draw();
      const trial = await this.#run(experiment, lane, name, signal);
      if (signal.aborted) break;
      this.#trials.push({name, dash, ...trial});
    }
    this.#running = null;
    this.#draw();
  }

  /**
   * @param {{[section: string]: any}} experiment
   * @param {string} lane
   * @param {string} switching
   * @param {AbortSignal} signal
   */
  async #run(experiment, lane, switching, signal) {
    try {
      const patch = {lanes: {[lane]: {switching}}};
      const seen = await this.#api.runs.lens(lane, ['chattering'], {experiment, patch, signal});
      return {seen};
    } catch (error) {
      const {fields, message} = /** @type {import('../api/api.js').ApiError} */ (error);
      return {refused: fields?.[0]?.message ?? message};
    }
  }

  /** @param {string} switching */
  async #use(switching) {
    const lane = this.#look?.lane;
    if (!lane) return;
    try {
      await this.#desk.history.change({lanes: {[lane]: {switching}}}, `switching of ${lane}`);
    } catch (error) {
      this.#desk.tell(/** @type {Error} */ (error).message, {error: true});
    }
  }

  #draw() {
    const look = this.#look;
    if (!look) return;
    const {experiment} = this.#api;
    const gains = experiment.lanes?.[look.lane] ?? {};
    const switches = switchesIn(experiment, look.lane);
    const trials = this.#trials;
    const old = trials.length > 0 && this.#key() !== this.#compared;
    this.#button.disabled = !switches;
    const count = this.#functions().length;
    const all = count > 3 ? 'four' : 'three';
    this.#button.textContent = this.#running ? 'Stop' : `Compare the ${all}`;
    this.#note.textContent = isWatching() ? RUNS_ARE_THE_OWNERS : !switches ? 'This law has no switching function.'
      : this.#running ? `${trials.length} of ${count} runs …` : old ? 'Run before the last change.' : '';
    this.#table.hidden = !trials.length;
    this.#way.hidden = !trials.length || experiment.simulation?.mode !== 'continuous';
    this.#body.replaceChildren(...trials.map((trial) => this.#row(trial, gains.switching)));
    this.#card.finding = finding(trials);
    this.#drawSpectra(look);
  }

  /** @param {Look} look */
  #drawSpectra({joint, lane, color}) {
    const ran = this.#trials.filter(({seen}) => seen?.chattering.frequency.length);
    this.#figure.element.hidden = !ran.length;
    if (!ran.length) return;
    // A run that broke off early has other frequencies; they can't share an axis.
    const {frequency} = ran[0].seen.chattering;
    const alike = ran.filter(({seen}) => seen.chattering.frequency.length === frequency.length);
    const spectra = alike.map(({name, dash, seen}) => ({
      name, dash, color, density: seen.chattering.joints[joint - 1].density,
      width: dash === 'solid' ? 2 : 1.5,
    }));
    this.#figure.draw(`Joint ${joint}: spectra of the torque under each`, (colors) => (
      spectrumFigure(colors, ran[0].seen.chattering, spectra, {lane, joint})
    ));
  }

  /**
   * @param {Trial} trial
   * @param {string} present
   */
  #row({name, seen, refused}, present) {
    const head = element('th', {scope: 'row'}, name, name === present && ' (now)');
    if (!seen) return element('tr', {}, head, element('td', {colspan: 6, class: 'is-text'}, refused));
    const {mae, max_error: most, variation, above, switches} = seen.chattering;
    if (seen.frozen) {
      return element('tr', {}, head, element('td', {colspan: 6, class: 'is-text'}, seen.frozen.cause));
    }
    const figures = [[ERROR, mae], [MOST, most], [VARIATION, variation], [ABOVE, above]];
    const numbers = figures.map(([figure, value]) => figureNumber(figure, value));
    const use = name !== present && element('button', {
      class: 'button small', type: 'button', 'aria-label': `Switch by ${name}`,
      on: {click: () => this.#use(name)},
    }, 'use');
    return element('tr', {}, head, ...[...numbers, threeDigits(switches)].map((text) => element('td', {}, text)),
      element('td', {}, use));
  }
}

/**
 * @param {{[section: string]: any}} experiment
 * @param {string} lane
 * @returns {boolean} whether it has such a lane, and its law a switching function
 */
function switchesIn({lanes}, lane) { return 'switching' in (lanes?.[lane] ?? {}); }

function heading() {
  const titles = [
    '', ...[ERROR, MOST, VARIATION, ABOVE].map(figureHeading), 'switches /s', '',
  ];
  return element('thead', {}, element('tr', {}, ...titles.map((text) => (
    element('th', {scope: 'col'}, text)
  ))));
}

/** @param {Trial[]} trials */
function finding(trials) {
  const of = (/** @type {string} */ name) => (
    trials.find((trial) => trial.name === name && trial.seen && !trial.seen.frozen)?.seen.chattering
  );
  const [sign, tanh] = [of('sign'), of('tanh')];
  if (!sign || !tanh) return '';
  const times = (/** @type {any} */ one) => (
    threeDigits(one.variation / Math.max(tanh.variation, 1e-9))
  );
  const implicit = of('implicit');
  return `sign moves the torque ${times(sign)} times as much as tanh, for ${figureNumber(ERROR, sign.mae)} `
    + `against ${figureText(ERROR, tanh.mae)} of ${ERROR.title}.`
    + (implicit ? ` implicit moves it ${times(implicit)} times as much, for ${figureText(ERROR, implicit.mae)}.` : '');
}
