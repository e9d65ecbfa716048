// @ts-check
/** What the numbers of the prediction lens say in words. */

import {unitAt, unitOfAll} from '../api/arm.js';
import {percent} from './card.js';
import {threeDigits} from '../figures/columns.js';
import {written} from '../fields/quantity.js';

/** Share of the time from which on a limit or friction is worth a word (*ours*). */
export const OFTEN = 0.05;
/** Share of k₂ that a load takes from which on the wave is too lopsided for the prediction (*ours*). */
const HALF = 0.5;
/** So many times the least lag of a drive the greatest may be before it is worth a word (*ours*). */
const UNLIKE = 3;
/** Switching functions that the button replaces by tanh. */
const REPLACED = ['sign', 'implicit'];

/**
 * @param {string} lane
 * @param {{[name: string]: any}} gains
 * @returns {string} why there is no prediction
 */
export function whyNothing(lane, gains) {
  const twisting = gains.law === 'super_twisting';
  if (!twisting && !('switching' in gains)) {
    return `The law of ${lane} has no switching term: nothing in it can chatter.`;
  }
  if (gains.reaching === 'power') {
    return `${lane} has power reaching, whose gain at S = 0 has no bound: harmonic balance does not say `
      + 'how it swings. See the run in the lens Chattering.';
  }
  return `${twisting ? 'k₁ and k₂' : 'k₂'} of ${lane} ${twisting ? 'are' : 'is'} 0: nothing switches.`;
}

/**
 * @param {any} prediction with an epsilon
 * @returns {string} what the button does
 */
export function proposal({epsilon, switching, joints}) {
  const value = Array.isArray(epsilon) ? 'each joint’s threshold' : `${written(epsilon)} ${unitOfAll('rad/s')}`;
  if (REPLACED.includes(switching)) return `Set ε to ${value} and sw to tanh`;
  return `Set ε to ${value}${isSilent(joints) ? ', the least that is silent' : ''}`;
}

/** @param {any[]} joints */
function isSilent(joints) { return joints.every(({amplitude}) => !amplitude); }

/**
 * @param {number|number[]} lag of the drives
 * @returns {string} where joints may carry each other with them, or ''
 */
export function unlikeDrives(lag) {
  if (!Array.isArray(lag) || Math.max(...lag) <= UNLIKE * Math.min(...lag)) return '';
  return 'The drives’ lags differ much: a slow joint may carry others with it, which then swing at its '
    + 'frequency though silent by themselves. ε for all joints holds; for each joint compare what was measured.';
}

/** @param {any} prediction */
export function finding({joints, switching, threshold, adaptive}) {
  const swinging = joints.filter((/** @type {any} */ {frequency}) => frequency !== null);
  const present = adaptive ? ' k₂ adapts: this is for what it was in the run.' : '';
  if (!swinging.length) return `No limit cycle: nothing comes late enough to make this loop swing.${present}`;
  if (switching === 'twisting') return 'Super-twisting swings, if only a little: weaker k₁ and k₂ or less delay make it less.';
  if (threshold === null) return `It swings farther and farther whatever ε is: what comes late is too much for it.${present}`;
  const from = `silent from ε = ${threeDigits(threshold)} ${unitOfAll('rad/s')} on for all joints, or from ε* of each`;
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
    : `Silent: ε = ${threeDigits(widest)} ${unitOfAll('rad/s')} is wide enough; it is ${from}.${present}`;
}

/**
 * How the picture is read: -1/N(A) has no beginning without a layer, and is turned by an integral.
 *
 * @param {any} one
 * @param {number} joint
 * @param {any} prediction
 */
export function reading(one, joint, {switching}) {
  if (!one.curve[0].length) return `Joint ${joint} has no gain that switches.`;
  const curve = `Joint ${joint}: its curve G, with k₁, friction and the joints that are locked. `;
  if (switching === 'twisting') {
    return one.crossing
      ? `${curve}The dots are −1/N(A): they run away from 0 as S swings farther, and the integral z turns `
        + 'them from the axis. Where they meet the curve, S keeps swinging.'
      : curve;
  }
  const dots = `${curve}The dots are −1/N(A): they begin at ${one.layer ? '−ε' : '0'} and run left as S `
    + 'swings farther. ';
  if (isHeldByNothing(one)) return `${dots}They meet the curve, but no layer holds this loop: that is no limit cycle.`;
  const meeting = `${dots}Where they meet the curve, S keeps swinging`;
  return one.layer ? `${meeting}; if they begin left of it, S is silent.` : `${meeting}.`;
}

/**
 * Why a joint is silent, and where the prediction does not hold.
 *
 * @param {any} one
 * @param {number} joint
 * @param {any} prediction
 */
export function cautions(one, joint, {switching}) {
  const bound = switching === 'twisting' ? 'z_max' : 'k₂';
  const swings = one.amplitude > 0;
  const said = [
    !swings && whySilent(one, joint),
    swings && one.coarse && 'A switch waits for the next sample: where the samples fall decides, within the range given.',
    Math.abs(one.load) >= 1 && `The load exceeds ${bound}: S leaves its surface, and there is no limit cycle.`,
    swings && Math.abs(one.load) >= HALF && Math.abs(one.load) < 1
      && `The load takes ${percent(Math.abs(one.load))} of ${bound}: it swings more slowly than predicted, and farther.`,
    one.limited > OFTEN && `At its torque limit for ${percent(one.limited)} of the time: it swings otherwise.`,
    one.sticking > OFTEN && `Coulomb friction takes part of the swing for ${percent(one.sticking)} of the time.`,
  ];
  return said.filter(Boolean).join(' ');
}

/**
 * The whole loop, that is: of its joints some may swing no farther than they would by themselves.
 *
 * @param {any} one
 * @returns {boolean} whether it is in a loop that swings farther and farther
 */
export function isHeldByNothing({crossing, amplitude}) { return crossing !== null && amplitude === null; }

/**
 * @param {any} one a joint that does not keep swinging
 * @param {number} joint
 */
function whySilent(one, joint) {
  const {crossing, layer, locked, curve: [real, imaginary], clearance, nearest} = one;
  if (!real.length) return '';
  if (isHeldByNothing(one)) {
    return `Joint ${joint} is in a loop that swings farther and farther: no layer holds it, however wide, until `
      + 'something else does.';
  }
  const silent = `Joint ${joint} is silent`;
  const unit = unitAt('rad/s', joint);
  if (crossing) {
    const size = Math.hypot(...crossing);
    if (layer > size) {
      return `${silent}: its layer of ${threeDigits(layer)} ${unit} is ${threeDigits(layer / size)} times as wide as `
        + 'the crossing is far from 0.';
    }
    return locked.length > 1
      ? `${silent}, though its dots begin right of the crossing: the layers of the joints that are locked to it `
        + 'are wide enough to hold it.'
      : `${silent} by the exact map of a control period, though its dots begin right of the crossing.`;
  }
  if (clearance !== null) {
    const angle = `${((clearance * 180) / Math.PI).toFixed(0)}°`;
    return `${silent}: the curve keeps ${angle} away from the dots, seen from 0; it comes nearest at `
      + `${threeDigits(nearest)} Hz.`;
  }
  if (!layer) return `${silent}: the curve never meets the dots.`;
  return `${silent}: the curve stays nearer to 0 than the dots, which begin at ε = ${threeDigits(layer)} ${unit}.`;
}
