// @ts-check
/** The prediction lens: chattering by harmonic balance beside the measured one, and its end. */

import {element} from '../dom/element.js';
import {LensCard, percent} from './card.js';
import {LensFigure} from './figure.js';
import {keyOf} from './key.js';
import {nyquistFigure} from './nyquist.js';
import {threeDigits} from '../figures/columns.js';
import {written} from '../fields/quantity.js';
import {isWatching} from '../api/watch_only.js';

/** @typedef {import('./card.js').Look} Look */

const HEIGHT = 270;
/** Gains that the threshold does not depend on. */
const FREE = ['epsilon', 'switching'];
/** Share of the time from which on a limit or friction is worth a word (*ours*). */
const OFTEN = 0.05;
const HEADINGS = [
  ['joint', ''],
  ['predicted Hz', 'Frequency at which the torque comes back half a period late'],
  ['measured Hz', 'In the second half of the run; – where S is silent'],
  ['predicted A [rad/s]', 'Half of what S swings'],
  ['measured A [rad/s]', 'In the second half of the run'],
  ['ε* [rad/s]', 'Boundary layer from which on this joint is silent'],
  ['locked', 'Joints that swing at one frequency and push each other'],
];

/** How the picture is read: −1/N(A) has no beginning without a layer, and is turned by an integral. */
const BALANCE = {
  layer: 'The dots are −1/N(A): they begin at −ε and run left as S swings farther. Where they meet the '
    + 'curve, S keeps swinging; if they begin left of it, S is silent.',
  sign: 'The dots are −1/N(A): they begin at 0 and run left as S swings farther. Where they meet the '
    + 'curve, S keeps swinging.',
  twisting: 'The dots are −1/N(A): they run away from 0 as S swings farther, and the integral z turns '
    + 'them from the axis. Where they meet the curve, S keeps swinging.',
};

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
  /** @type {{lane: string, key: string}|null} whose threshold is marked */ #marked = null;

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
    for (const type of ['patch', 'hello']) api.addEventListener(type, () => this.#check());
  }

  /**
   * @param {Look} look
   * @returns {string|undefined} why there is nothing to see
   */
  show(look) {
    const {seen: {prediction}, lane, joint} = look;
    this.#look = look;
    this.#mark(look);
    if (!prediction) return `${lane} has no switching term, or power reaching: there is nothing to balance.`;
    this.#table.replaceChildren(...prediction.joints.map((/** @type {any} */ one, /** @type {number} */ index) => (
      row(one, index + 1, joint)
    )));
    const one = prediction.joints[joint - 1];
    this.#card.finding = finding(prediction);
    const {epsilon} = prediction;
    this.#button.hidden = epsilon === null || isWatching();
    this.#button.textContent = `Set ε to ${epsilonText(epsilon)}`;
    this.#curve.facts = facts(one, prediction);
    this.#curve.finding = cautions(one, joint, prediction);
    this.#curve.words = `Joint ${joint}: its curve G, with k₁, friction and the joints that are locked. `
      + BALANCE[prediction.switching === 'twisting' ? 'twisting' : one.layer ? 'layer' : 'sign'];
    this.#figure.element.hidden = one.crossing === null;
    if (one.crossing !== null) {
      this.#figure.draw(`Joint ${joint}: Nyquist curve against −1/N(A)`, (colors) => (
        nyquistFigure(colors, one, look)
      ));
    }
    return undefined;
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

  /**
   * Mark the threshold on the slider of ε.
   *
   * @param {Look} look
   */
  #mark({seen: {prediction}, lane, experiment}) {
    this.#marked = {lane, key: keyOf(experiment, lane, FREE)};
    const joints = prediction?.joints.map((/** @type {any} */ {threshold}) => threshold) ?? [];
    this.#tell(prediction && {lane, threshold: prediction.threshold, joints});
    this.#check();
  }

  /** Take the mark away as soon as it is another loop's. */
  #check() {
    if (!this.#marked) return;
    const {lane, key} = this.#marked;
    if (keyOf(this.#api.experiment, lane, FREE) === key) return;
    this.#marked = null;
    this.#tell(null);
  }

  /** @param {any} detail */
  #tell(detail) { this.#api.dispatchEvent(new CustomEvent('silence', {detail})); }
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
  const silent = one.frequency === null || one.amplitude === 0;
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

/** @param {number|number[]|null} epsilon */
function epsilonText(epsilon) {
  return Array.isArray(epsilon) ? 'each joint’s threshold' : `${written(Number(epsilon))} rad/s`;
}

/** @param {any} prediction */
function finding({joints, switching, threshold, adaptive}) {
  const swinging = joints.filter((/** @type {any} */ {frequency}) => frequency !== null);
  const present = adaptive ? ' k₂ adapts: this is for what it was in the run.' : '';
  if (!swinging.length) return `No limit cycle: nothing comes late enough to make this loop swing.${present}`;
  if (switching === 'twisting') return 'Super-twisting swings, if only a little: weaker k₁ and k₂ or less delay make it less.';
  if (threshold === null) return `It swings whatever ε is: k₁ alone is too much for what comes late.${present}`;
  const from = `silent from ε = ${threeDigits(threshold)} rad/s on`;
  if (switching === 'sign') return `sign swings whatever k₂ is. tanh in its place would be ${from}.${present}`;
  const loud = swinging.filter((/** @type {any} */ {amplitude}) => amplitude > 0).length;
  const many = loud === joints.length ? 'All joints swing' : `${loud} of ${joints.length} joints swing`;
  if (switching === 'implicit') {
    return loud
      ? `${many}: the layer T·k₂ is too thin for what comes late. tanh in its place would be ${from}.${present}`
      : `Silent: the layer T·k₂ of the implicit sign is wide enough.${present}`;
  }
  const widest = Math.max(...joints.map((/** @type {any} */ {layer}) => layer));
  return loud
    ? `${many} at this ε; it is ${from}.${present}`
    : `Silent: ε = ${threeDigits(widest)} rad/s is wide enough; it is ${from}.${present}`;
}

/**
 * @param {any} one
 * @param {any} prediction
 */
function facts(one, {switching, adaptive}) {
  const twisting = switching === 'twisting';
  const {kappa, frequency, crossing, alone, amplitude, locked, load, layer, gain} = one;
  const unit = twisting ? 's' : 'rad/s';
  return [
    ...(twisting ? [] : [
      {name: 'κ', value: `${threeDigits(kappa)} rad/s²`, title: 'How fast its own switching torque moves S'},
    ]),
    ...(adaptive ? [{name: 'k₂', value: `${threeDigits(gain)} rad/s²`, title: 'As it was where this joint needs the widest layer'}] : []),
    ...(switching === 'implicit' && layer ? [
      {name: 'T·k₂', value: `${threeDigits(layer)} rad/s`, title: 'Layer of the implicit sign, of this joint alone'},
    ] : []),
    ...(frequency === null ? [] : [
      {name: 'crosses at', value: `${threeDigits(frequency)} Hz, ${threeDigits(Math.hypot(...crossing))} ${unit}`},
    ]),
    ...(locked.length > 1 && amplitude > 0 ? [
      {name: 'alone', value: `${threeDigits(alone)} rad/s`, title: 'Amplitude if no other joint switched'},
    ] : []),
    ...(Math.abs(load) > OFTEN ? [
      {name: 'load', value: percent(Math.abs(load)), title: `Share of ${twisting ? 'z_max' : 'k₂'} that holds the joint on its surface`},
    ] : []),
  ];
}

/**
 * Where the prediction does not hold.
 *
 * @param {any} one
 * @param {number} joint
 * @param {any} prediction
 */
function cautions(one, joint, {switching}) {
  const bound = switching === 'twisting' ? 'z_max' : 'k₂';
  const said = [
    one.frequency === null && `Joint ${joint} has no limit cycle: its curve does not cross the axis.`,
    one.coarse && 'A period is a few samples: where they fall decides, within the range given.',
    Math.abs(one.load) >= 1 && `The load exceeds ${bound}: S leaves its surface, and there is no limit cycle.`,
    one.limited > OFTEN && `At its torque limit for ${percent(one.limited)} of the time: it swings otherwise.`,
    one.sticking > OFTEN && `Coulomb friction takes part of the swing for ${percent(one.sticking)} of the time.`,
  ];
  return said.filter(Boolean).join(' ');
}
