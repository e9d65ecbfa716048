// @ts-check
/** Which channels of a whole response each of its tabs shows. */

/**
 * One of the stacked plots: a channel of every lane.
 * @typedef {{id: string, title: string, quantity: string, unit: string, channel: string,
 *   scale: number, positive?: boolean, held?: boolean}} ResponsePanel `held`: a sampled controller
 *   holds it from one sample to the next
 */
/**
 * @typedef {{id: string, title: string, joints: boolean,
 *   panels: (joints: number[]) => ResponsePanel[]}} ResponseView
 */

import {unitAt} from '../api/arm.js';

const MILLIMETRES = 1000;

/**
 * @param {string} stem of the channel
 * @param {string} quantity
 * @param {string} unit
 * @param {boolean} [held] from one sample to the next
 * @returns {(joints: number[]) => ResponsePanel[]}
 */
function perJoint(stem, quantity, unit, held = false) {
  return (joints) => joints.map((joint) => ({
    id: `${stem}${joint}`, title: `joint ${joint}`, quantity, unit: unitAt(unit, joint), channel: `${stem}${joint}`,
    scale: 1, held,
  }));
}

/** @type {ResponseView[]} */
export const RESPONSE_VIEWS = [
  {id: 'error', title: 'Error', joints: true, panels: perJoint('e', 'e', 'rad')},
  {id: 'torque', title: 'Torque', joints: true, panels: perJoint('tau', 'τ', 'N·m', true)},
  {id: 'surface', title: 'Surface', joints: true, panels: perJoint('S', 'S', 'rad/s')},
  {
    id: 'flange-error', title: 'Flange error', joints: false,
    panels: () => [{
      id: 'flange-error', title: 'flange', quantity: 'error', unit: 'mm',
      channel: 'flange_error', scale: MILLIMETRES, positive: true,
    }],
  },
];
