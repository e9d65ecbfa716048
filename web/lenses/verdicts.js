// @ts-check
/** What the numbers of a lens say in words, of a law with just these gains. */

import {percent} from './card.js';
import {figureText, threeDigits} from '../figures/columns.js';
import {figureOf} from '../figures/figure.js';

/** @typedef {{[name: string]: any}} Gains */

const [ERROR, ABOVE, REACHING] = ['mae', 'high_frequency_torque', 'reaching_time'].map(figureOf);

/** Torque above the high frequency in [N·m] that is worth a word. */
const CHATTERS = 0.1;
/** Share of the time below which "never" is fair. */
const HARDLY = 0.0005;
/** Turns of V a second that are no motion of the arm's any more. */
export const RESTLESS = 50;

/**
 * @param {Gains} gains
 * @returns {boolean} whether the law has a switching term at all
 */
export function switches(gains) {
  return 'switching' in gains && [gains.k2 ?? 0].flat().some((k2) => k2 !== 0);
}

/**
 * @param {Gains} gains
 * @param {number} hold control period in [s], 0 in continuous mode, where implicit is sign
 * @returns {Gains} the gains as they act
 */
export function inEffect(gains, hold) {
  return gains.switching === 'implicit' && !hold ? {...gains, switching: 'sign'} : gains;
}

/**
 * What makes this law's torque quieter.
 *
 * @param {Gains} gains
 * @param {boolean} noise whether it is noise that it passes on
 */
function wayOut(gains, noise) {
  if (!('switching' in gains)) {
    return noise ? 'A lower k_d amplifies it less.' : 'A lower k_d, or a faster control rate, is quieter.';
  }
  if (gains.switching === 'sign' && switches(gains)) {
    return noise ? 'tanh in place of sign would amplify it less.'
      : 'tanh in place of sign, or a smaller k₂, is quieter.';
  }
  if (gains.switching === 'implicit' && switches(gains)) {
    return noise ? 'tanh with a wider layer ε amplifies it less.'
      : 'A shorter delay, or tanh with a wider layer ε, is quieter.';
  }
  if (!switches(gains)) return noise ? 'A lower k₁ amplifies it less.' : 'A lower k₁ is quieter.';
  return noise ? 'A wider boundary layer ε, or smaller k₁ and k₂, amplifies it less.'
    : 'A wider boundary layer ε, or a smaller k₂, is quieter.';
}

/**
 * @param {any} chattering
 * @param {Gains} gains
 */
export function chatteringFinding(chattering, gains) {
  const {frequency, limit, switches: count, above: torque, mae, quiet} = chattering;
  const above = `above ${limit} Hz`;
  if (!frequency.length) {
    return `The loop samples too slowly, or the run is too short, to tell torque ${above}.`;
  }
  const error = `${figureText(ERROR, mae)} ${ERROR.title}`;
  if (torque <= CHATTERS) return `Smooth: hardly any torque ${above}, with ${error}.`;
  const all = figureText(ABOVE, torque);
  if (quiet && quiet.above !== null && quiet.above <= CHATTERS) {
    return `Sensor noise, not chattering: of ${all} ${above}, ${figureText(ABOVE, quiet.above)} are left `
      + `in the same run without noise. The gains amplify what the sensors add. `
      + `${wayOut(gains, true)} There are ${error}.`;
  }
  const rest = quiet && quiet.above !== null
    ? ` Without sensor noise ${figureText(ABOVE, quiet.above)} of it are left.` : '';
  if (!switches(gains)) {
    return `${all} ${above}, though this law has nothing that switches: its gains are too high for `
      + `the control rate. They buy ${error}.${rest} ${wayOut(gains, false)}`;
  }
  return `${threeDigits(count)} switches a second and ${all} of chattering buy ${error}.${rest} `
    + wayOut(gains, false);
}

/**
 * @param {any} one
 * @param {number} horizon
 * @param {Gains} gains
 */
export function planeFinding(one, horizon, gains) {
  const {layer, reaching_time: reached, inside, time_constant: constant} = one;
  const slow = constant > horizon
    ? ` On the line the error takes ${threeDigits(constant)} s to fall to 37 %, longer than this `
      + `run of ${threeDigits(horizon)} s: it hardly converges.` : '';
  if (!layer) return `This law has no boundary layer: it pulls in proportion to S.${slow}`;
  if (reached === null) {
    return `S never came within the layer: k₁ and k₂ don’t overcome what acts on this joint.${slow}`;
  }
  if (gains.switching === 'sign') {
    return 'sign(S) has no layer, and ε has no effect: it applies the full k₂ wherever S is not '
      + `zero. For ${percent(inside)} of the time S is practically zero.${slow}`;
  }
  if (gains.switching === 'implicit' && switches(gains)) {
    return `Within the layer, T·k₂ by the model, implicit brings S to zero by the end of each period. For ${
      percent(inside)} of the time S is within it; ε has no effect.${slow}`;
  }
  if (1 - inside < HARDLY) {
    return 'The whole response of this joint stays within the layer: there tanh and saturation are '
      + `little more than a gain k₂/ε, and nothing switches.${slow}`;
  }
  const begins = reached ? `S came within the layer after ${figureText(REACHING, reached)}` : 'S begins within the layer';
  return `${begins} and is outside it for ${percent(1 - inside)} of the time.${slow}`;
}

/**
 * @param {any} sliding
 * @param {number} horizon
 * @param {Gains} gains
 */
export function energyFinding(sliding, horizon, gains) {
  if (sliding.turns > RESTLESS) return restless(sliding, gains);
  const {outside, growing, growing_outside: beyond, joints} = sliding;
  if (!joints.some((/** @type {{layer: number}} */ {layer}) => layer)) {
    return 'This law has no layer, so V need not fall: it follows the motion and the '
      + `disturbance, and grows for ${percent(growing)} of the time.`;
  }
  const follows = 'within the layers nothing forces V to fall, it follows the motion.';
  if (!outside) return `Every S stays within its layer: ${follows}`;
  const span = `${threeDigits(outside * horizon)} s in all`;
  if (beyond < HARDLY) {
    return `While some S is outside its layer (${span}) V falls all the time: there the gains overcome `
      + `everything that disturbs. ${follows.replace('w', 'W')}`;
  }
  return `While some S is outside its layer (${span}) V grows for ${percent(beyond)} of that time: `
    + 'the gains k₁, k₂ are too small for what disturbs the arm then, or a joint pulls its neighbours.';
}

/**
 * @param {any} sliding whose V turns more often than any motion does
 * @param {Gains} gains
 */
function restless({turns, quiet_turns: quiet, outside}, gains) {
  const often = `V turns ${threeDigits(turns)} times a second`;
  const apart = quiet === null ? '' : `, and ${threeDigits(quiet)} times without sensor noise`;
  if (quiet !== null && quiet <= RESTLESS) {
    return `${often}${apart}: that is measurement noise, not switching. S is only as smooth as `
      + 'it is measured.';
  }
  if (!switches(gains)) {
    return `${often}${apart}: the torque is held for a whole sample and overshoots each time. `
      + 'Nothing switches in this law; its gains are too high for the control rate.';
  }
  if (gains.switching === 'implicit') {
    return `${often}${apart}: implicit predicts S one period ahead, by the model. A delay, or a model `
      + 'that is off, makes it overshoot the line each time.';
  }
  if (gains.switching !== 'sign' && outside < HARDLY) {
    return `${often}${apart}: the torque is held for a whole sample and overshoots the line each `
      + 'time, though hardly any S leaves its layer. Nothing switches; k₁ + k₂/ε is too steep for the '
      + 'control rate.';
  }
  return `${often}${apart}: the torque is held for a whole sample and overshoots the line each `
    + 'time. That is chattering, not a lack of gain.';
}
