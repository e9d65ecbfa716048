// @ts-check
/** The prediction lens: chattering by harmonic balance beside the measured one, and its end. */

import {unitAt, unitOfAll} from '../api/arm.js';
import {element} from '../dom/element.js';
import {LensCard, percent} from './card.js';
import {LensFigure} from './figure.js';
import {thresholdKey} from '../fields/response_key.js';
import {nyquistFigure} from './nyquist.js';
import {threeDigits} from '../figures/columns.js';
import {OFTEN, cautions, finding, proposal, reading, unlikeDrives, whyNothing} from './prediction_words.js';
import {isWatching} from '../api/watch_only.js';

/** @typedef {import('./card.js').Look} Look */

const HEIGHT = 270;
const HEADINGS = [
  ['joint', ''],
  ['predicted Hz', 'Frequency at which the torque comes back half a period late; – where there is no limit cycle'],
  ['measured Hz', 'In the second half of the run; – where S is silent'],
  [`predicted A [${unitOfAll('rad/s')}]`, 'Half of what S swings; – where there is no limit cycle'],
  [`measured A [${unitOfAll('rad/s')}]`, 'In the second half of the run; – where S is silent'],
  [`ε* [${unitOfAll('rad/s')}]`, 'Layers that silence the loop where each joint has its own; one ε for all is told below'],
  ['locked', 'Joints that swing at one frequency and push each other'],
];

/** Shows what the pencil says of a lane. */
export class PredictionLens {
  id = 'prediction';
  title = 'Prediction';
  element;
  #api;
  #desk;
  #figure = new LensFigure({height: HEIGHT});
  #table = element('tbody');
  #button;
  #card;
  #curve;
  /** @type {Look|null} */ #look = null;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../page/right_panel.js').Desk} desk
   */
  constructor(api, desk) {
    this.#api = api;
    this.#desk = desk;
    this.#button = element('button', {
      class: 'button small', type: 'button', on: {click: () => this.#silence()},
    });
    const table = element(
      'div', {class: 'lens-scroll', tabindex: 0, role: 'region', 'aria-label': 'Limit cycles of the joints'},
      element('table', {class: 'lens-table'}, heading(), this.#table),
    );
    this.#card = new LensCard({
      title: 'What the pencil says', equation: 'A = (4/π)|G| at arg G = −180°',
      words: 'A torque that comes late makes a switching loop swing. Frequency and amplitude of S '
        + 'follow from κ, the hold, the delay and the drives’ lag, without a run; beside them, the run.',
    }, table, element('div', {class: 'lens-row'}, this.#button));
    this.#curve = new LensCard({
      title: 'Where it balances', equation: 'G(jω) N(A) = −1', words: '',
    }, this.#figure.element);
    this.element = [this.#card.element, this.#curve.element];
  }

  /**
   * @param {Look} look
   * @returns {string|undefined} why there is nothing to see
   */
  show(look) {
    const {seen: {prediction}, lane, joint} = look;
    this.#look = look;
    this.#tell(look);
    if (!prediction) return whyNothing(lane, look.gains);
    this.#table.replaceChildren(...prediction.joints.map((/** @type {any} */ one, /** @type {number} */ index) => (
      row(one, index + 1, joint)
    )));
    const one = prediction.joints[joint - 1];
    const apart = unlikeDrives(look.experiment.robot.lag);
    this.#card.finding = [finding(prediction), apart].filter(Boolean).join(' ');
    const {epsilon} = prediction;
    this.#button.hidden = epsilon === null || isWatching();
    if (epsilon !== null) this.#button.textContent = proposal(prediction);
    this.#curve.facts = facts(one, prediction, unitAt('rad/s', joint));
    this.#curve.finding = cautions(one, joint, prediction);
    this.#curve.words = reading(one, joint, prediction);
    const drawn = one.curve[0].length > 0;
    this.#figure.element.hidden = !drawn;
    if (drawn) {
      this.#figure.draw(`Joint ${joint}: Nyquist curve against −1/N(A)`, (colors) => (
        nyquistFigure(colors, one, look)
      ));
    }
    return undefined;
  }

  /**
   * Tell the slider of ε of the threshold.
   *
   * @param {Look} look
   */
  #tell({seen: {prediction}, lane, experiment}) {
    const joints = prediction?.joints.map((/** @type {any} */ {threshold}) => threshold) ?? [];
    this.#api.dispatchEvent(new CustomEvent('silence', {detail: {
      lane, key: thresholdKey(experiment, lane), threshold: prediction?.threshold ?? null, joints,
    }}));
  }

  async #silence() {
    const {lane, seen} = this.#look ?? {};
    if (!lane) return;
    const {epsilon, switching} = seen.prediction;
    const gains = {epsilon, ...(['sign', 'implicit'].includes(switching) && {switching: 'tanh'})};
    try {
      await this.#desk.history.change({lanes: {[lane]: gains}}, `ε of ${lane}`);
    } catch (error) {
      this.#desk.tell(/** @type {Error} */ (error).message, {error: true});
    }
  }
}

function heading() {
  return element('thead', {}, element('tr', {}, ...HEADINGS.map(([text, title]) => (
    element('th', {scope: 'col', title: title || null}, text)
  ))));
}

/**
 * @param {any} one
 * @param {number} number
 * @param {number} chosen
 */
function row(one, number, chosen) {
  const silent = one.frequency === null || !one.amplitude;
  const cells = [
    silent ? '–' : range(one), figure(one.measured_frequency),
    silent ? '–' : figure(one.amplitude), figure(one.measured_amplitude), figure(one.threshold),
    one.locked.length > 1 ? one.locked.join(' ') : '–',
  ];
  return element('tr', {class: number === chosen ? 'is-chosen' : null, 'aria-current': number === chosen ? 'true' : null},
    element('th', {scope: 'row'}, String(number)), ...cells.map((text) => element('td', {}, text)));
}

/** @param {number|null} value */
function figure(value) { return value === null ? '–' : threeDigits(value); }

/** @param {any} one */
function range(one) {
  const {frequency, slowest, fastest, coarse} = one;
  return coarse ? `${threeDigits(slowest)} to ${threeDigits(fastest)}` : threeDigits(frequency);
}

/**
 * @param {any} one
 * @param {any} prediction
 * @param {string} speed unit of S
 */
function facts(one, {switching, adaptive}, speed) {
  const twisting = switching === 'twisting';
  const {kappa, frequency, crossing, alone, amplitude, locked, load, layer, gain} = one;
  const unit = twisting ? 's' : speed;
  return [
    ...(twisting ? [] : [
      {name: 'κ', value: `${threeDigits(kappa)} ${speed}²`, title: 'How fast its own switching torque moves S'},
    ]),
    ...(adaptive ? [{name: 'k₂', value: `${threeDigits(gain)} ${speed}²`, title: 'As it was where this joint needs the widest layer'}] : []),
    ...(switching === 'implicit' && layer ? [
      {name: 'T·k₂', value: `${threeDigits(layer)} ${speed}`, title: 'Layer of the implicit sign, of this joint alone'},
    ] : []),
    ...(frequency === null ? [] : [
      {name: 'crosses at', value: `${threeDigits(frequency)} Hz, ${threeDigits(Math.hypot(...crossing))} ${unit}`},
    ]),
    ...(locked.length > 1 && amplitude > 0 ? [
      {name: 'alone', value: `${threeDigits(alone)} ${speed}`, title: 'Amplitude if no other joint switched'},
    ] : []),
    ...(Math.abs(load) > OFTEN ? [
      {name: 'load', value: percent(Math.abs(load)), title: `Share of ${twisting ? 'z_max' : 'k₂'} that holds the joint on its surface`},
    ] : []),
  ];
}
