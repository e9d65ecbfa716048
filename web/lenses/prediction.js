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
    if (!prediction) return `${lane} has no switching term k₂sw(S), or power reaching: there is nothing to balance.`;
    this.#table.replaceChildren(...prediction.joints.map((/** @type {any} */ one, /** @type {number} */ index) => (
      row(one, index + 1, joint)
    )));
    const one = prediction.joints[joint - 1];
    this.#card.finding = finding(prediction);
    const {epsilon} = prediction;
    this.#button.hidden = epsilon === null || isWatching();
    this.#button.textContent = `Set ε to ${epsilonText(epsilon)}`;
    this.#curve.facts = facts(one);
    this.#curve.finding = cautions(one, joint);
    this.#curve.words = `Joint ${joint}: its curve G, with k₁, friction and the joints that are locked. `
      + 'The dots are −1/N(A): they begin at −ε and run left as S swings farther. Where they meet the '
      + 'curve, S keeps swinging; if they begin left of it, S is silent.';
    this.#figure.element.hidden = one.crossing === null;
    if (one.crossing !== null) {
      const layer = prediction.layer[joint - 1];
      this.#figure.draw(`Joint ${joint}: Nyquist curve against −1/N(A)`, (colors) => (
        nyquistFigure(colors, one, {...look, layer})
      ));
    }
    return undefined;
  }

  async #silence() {
    const {lane, seen} = this.#look ?? {};
    if (!lane) return;
    const {epsilon, switching} = seen.prediction;
    const gains = {epsilon, ...(switching === 'sign' && {switching: 'tanh'})};
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
function finding({joints, switching, threshold, layer}) {
  const swinging = joints.filter((/** @type {any} */ {frequency}) => frequency !== null);
  if (!swinging.length) return 'No limit cycle: nothing comes late enough to make this loop swing.';
  if (threshold === null) return 'It swings whatever ε is: k₁ alone is too much for what comes late.';
  const from = `silent from ε = ${threeDigits(threshold)} rad/s on`;
  if (switching === 'sign') return `sign swings whatever k₂ is. tanh in its place would be ${from}.`;
  const loud = swinging.filter((/** @type {any} */ {amplitude}) => amplitude > 0).length;
  const thin = `${loud === joints.length ? 'All joints swing' : `${loud} of ${joints.length} joints swing`} at this ε`;
  const widest = Math.max(...layer);
  return loud ? `${thin}; it is ${from}.` : `Silent: ε = ${threeDigits(widest)} rad/s is wide enough; it is ${from}.`;
}

/** @param {any} one */
function facts(one) {
  const {kappa, frequency, crossing, alone, amplitude, locked, load} = one;
  return [
    {name: 'κ', value: `${threeDigits(kappa)} rad/s²`, title: 'How fast its own switching torque moves S'},
    ...(frequency === null ? [] : [
      {name: 'crosses at', value: `${threeDigits(frequency)} Hz, ${threeDigits(crossing)} rad/s`},
    ]),
    ...(locked.length > 1 && amplitude > 0 ? [
      {name: 'alone', value: `${threeDigits(alone)} rad/s`, title: 'Amplitude if no other joint switched'},
    ] : []),
    ...(Math.abs(load) > OFTEN ? [
      {name: 'load', value: percent(Math.abs(load)), title: 'Share of k₂ that holds the joint on its surface'},
    ] : []),
  ];
}

/**
 * Where the prediction does not hold.
 *
 * @param {any} one
 * @param {number} joint
 */
function cautions(one, joint) {
  const said = [
    one.frequency === null && `Joint ${joint} has no limit cycle: its curve does not cross the axis.`,
    one.coarse && 'A period is a few samples: where they fall decides, within the range given.',
    Math.abs(one.load) >= 1 && 'The load exceeds k₂: S leaves its surface, and there is no limit cycle.',
    one.limited > OFTEN && `At its torque limit for ${percent(one.limited)} of the time: it swings otherwise.`,
    one.sticking > OFTEN && `Coulomb friction takes part of the swing for ${percent(one.sticking)} of the time.`,
  ];
  return said.filter(Boolean).join(' ');
}
