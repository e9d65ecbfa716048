// @ts-check
/** The chattering lens: the torque's spectrum, the price of smoothness, three switching functions. */

import {LensCard} from './lens_card.js';
import {LensFigure} from './lens_figure.js';
import {SmoothingCard} from './lens_smoothing.js';
import {spectrumFigure} from './lens_spectrum.js';
import {SwitchingCard} from './lens_switching.js';
import {threeDigits} from './metrics_columns.js';

/** @typedef {import('./lens_card.js').Look} Look */

const HEIGHT = 250;
/** Torque above 50 Hz in [N·m] that is worth a word. */
const CHATTERS = 0.1;

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
   * @param {import('./api.js').Api} api
   * @param {import('./right_panel.js').Desk} desk
   */
  constructor(api, desk) {
    this.#card = new LensCard({
      title: 'Where the torque lies in frequency', equation: 'Eq. 13, 14',
      words: 'The motion itself lives below a few hertz. What stands right of 50 Hz is chattering: '
        + 'it heats motors and shakes gears, and hardly moves the arm.',
    }, this.#spectrum.element);
    this.#smoothing = new SmoothingCard(api, desk);
    this.#switching = new SwitchingCard(api, desk);
    this.element = [this.#card.element, this.#smoothing.element, this.#switching.element];
  }

  /** @param {Look} look */
  show(look) {
    const {seen: {chattering}, joint, color, lane} = look;
    const one = chattering.joints[joint - 1];
    this.#card.facts = [
      {name: 'total variation', value: `${threeDigits(one.variation)} N·m/s`,
        title: 'How much the torque of this joint moves up and down in a second'},
      {name: 'switches', value: `${threeDigits(one.switches)} /s`,
        title: 'Sign changes of S a second'},
      {name: 'above 50 Hz', value: above(one.above)},
      {name: 'all joints', value: `${threeDigits(chattering.variation)} N·m/s, `
        + `${threeDigits(chattering.switches)} /s, ${above(chattering.above)}`},
    ];
    this.#card.finding = finding(chattering);
    const spectra = [{name: lane, color, dash: 'solid', density: one.density}];
    this.#spectrum.draw(`Joint ${joint}: spectrum of the torque`, (colors) => (
      spectrumFigure(colors, chattering, spectra, `${lane}-${joint}`)
    ));
    this.#smoothing.show(look);
    this.#switching.show(look);
  }
}

/** @param {number|null} torque */
function above(torque) { return torque === null ? '–' : `${threeDigits(torque)} N·m RMS`; }

/** @param {any} chattering */
function finding({frequency, switches, above: torque, mae}) {
  if (!frequency.length) {
    return 'The loop samples too slowly, or the run is too short, to tell torque above 50 Hz.';
  }
  const error = `${threeDigits(1000 * mae)} mrad mean error`;
  if (torque > CHATTERS) {
    return `${threeDigits(switches)} switches a second and ${threeDigits(torque)} N·m of chattering `
      + `buy ${error}. A wider boundary layer ε, or a smaller k₂, is quieter.`;
  }
  return `Smooth: hardly any torque above 50 Hz, with ${error}.`;
}
