// @ts-check
/** The chattering lens: the torque's spectrum, the price of smoothness, three switching functions. */

import {LensCard} from './card.js';
import {LensFigure} from './figure.js';
import {SmoothingCard} from './smoothing.js';
import {spectrumFigure} from './spectrum.js';
import {SwitchingCard} from './switching.js';
import {chatteringFinding, inEffect} from './verdicts.js';
import {figureText, threeDigits} from '../figures/columns.js';
import {figureOf} from '../figures/figure.js';

/** @typedef {import('./card.js').Look} Look */

const HEIGHT = 250;
const [VARIATION, SWITCHES, ABOVE] = [
  'chattering', 'switches', 'high_frequency_torque',
].map(figureOf);

/** Shows how restless the torque of a lane is. */
export class ChatteringLens {
  id = 'chattering';
  title = 'Chattering';
  element;
  #spectrum = new LensFigure({height: HEIGHT});
  #card;
  #smoothing;
  #switching;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../page/right_panel.js').Desk} desk
   */
  constructor(api, desk) {
    this.#card = new LensCard({
      title: 'Torque over frequency', equation: 'Eq. 13, 14',
      words: 'The motion itself is below a few hertz. Torque above fₕ is chattering or sensor '
        + 'noise: it heats motors, wears gears and hardly moves the arm.',
    }, this.#spectrum.element);
    this.#smoothing = new SmoothingCard(api, desk);
    this.#switching = new SwitchingCard(api, desk);
    this.element = [this.#card.element, this.#smoothing.element, this.#switching.element];
  }

  /** @param {Look} look */
  show(look) {
    const {seen: {chattering}, joint, color, lane, gains, hold} = look;
    const one = chattering.joints[joint - 1];
    this.#card.facts = [
      {name: 'total variation', value: figureText(VARIATION, one.variation, joint),
        title: 'Total variation of this joint’s torque per second'},
      {name: 'switches', value: `${threeDigits(one.switches)} /s`,
        title: `${SWITCHES.meaning} of this joint`},
      {name: `above ${chattering.limit} Hz`, value: above(one.above, joint)},
      {name: 'all joints', value: together(chattering)},
      ...(chattering.quiet ? [{
        name: 'without sensor noise', value: together(chattering.quiet),
        title: 'All joints, same run, exact sensors',
      }] : []),
    ];
    this.#card.finding = chatteringFinding(chattering, inEffect(gains, hold));
    const spectra = spectraOf(chattering, joint, lane, color);
    this.#spectrum.draw(`Joint ${joint}: spectrum of the torque`, (colors) => (
      spectrumFigure(colors, chattering, spectra, {lane, joint})
    ));
    this.#smoothing.show(look);
    this.#switching.show(look);
  }
}

/**
 * @param {number|null} torque
 * @param {number} [joint] where it is of one
 */
function above(torque, joint) { return `${figureText(ABOVE, torque, joint)}${torque === null ? '' : ' RMS'}`; }

/** @param {any} chattering */
function together({variation, switches, above: torque}) {
  return `${figureText(VARIATION, variation)}, ${threeDigits(switches)} /s, ${above(torque)}`;
}

/**
 * Of the run, and of that without sensor noise where there is one as long.
 *
 * @param {any} chattering
 * @param {number} joint
 * @param {string} lane
 * @param {string} color
 */
function spectraOf({joints, frequency, quiet}, joint, lane, color) {
  const spectra = [{name: lane, color, dash: 'solid', density: joints[joint - 1].density}];
  if (quiet?.frequency.length !== frequency.length) return spectra;
  const {density} = quiet.joints[joint - 1];
  return [...spectra, {name: 'without sensor noise', color, dash: 'dot', density}];
}
