// @ts-check
/** Which traces each tab of the plots shows. */

import {unitAt} from '../api/arm.js';

/** @typedef {import('../curves/ring.js').Ring} Ring */
/** @typedef {import('../curves/trace_values.js').Trace} Trace */
/** @typedef {import('../curves/trace_values.js').Rule} Rule */
/**
 * One of the stacked plots.
 * @typedef {{id: string, title: string, quantity: string, unit: string, traces: Trace[],
 *   positive?: boolean}} Panel
 */
/**
 * @typedef {{ring: Ring, lanes: string[], joints: number[],
 *   hasNetwork: (lane: string) => boolean}} Source
 */
/**
 * @typedef {{id: string, title: string, joints: boolean, spectrum?: boolean, empty?: string,
 *   panels: (source: Source) => Panel[]}} View
 */

const AXES = ['x', 'y', 'z'];
const MILLIMETRES = 1000;

/**
 * @param {Source} source
 * @param {string} lane
 * @param {string} label
 * @param {[string, string, number|string][]} channels lane, group and joint of each column
 * @param {{role?: 'actual'|'desired', rule?: Rule, scale?: number, held?: boolean}} [how]
 * @returns {Trace[]} none when the server doesn't send the channels
 */
function traces(source, lane, label, channels, how = {}) {
  const places = channels.map((channel) => source.ring.place(...channel));
  if (places.includes(-1)) return [];
  return [{lane, label, places, role: 'actual', rule: 'value', scale: 1, ...how}];
}

/**
 * A quantity of each lane, one panel a joint.
 *
 * @param {string} group
 * @param {string} quantity
 * @param {string} unit
 * @param {{held?: boolean, shown?: (lane: string, source: Source) => boolean}} [how] whether a
 *   sampled controller holds it from one sample to the next, and which lanes have it
 * @returns {(source: Source) => Panel[]}
 */
function perJoint(group, quantity, unit, {held = false, shown = () => true} = {}) {
  return (source) => source.joints.map((joint) => ({
    id: `${group}${joint}`,
    title: `joint ${joint}`,
    quantity,
    unit: unitAt(unit, joint),
    traces: source.lanes.filter((lane) => shown(lane, source)).flatMap((lane) => (
      traces(source, lane, `${quantity} joint ${joint} ${lane}`, [[lane, group, joint]], {held})
    )),
  }));
}

/**
 * What each lane does beside what is asked of it; the server sends the difference.
 *
 * @param {string} desired group of the desired value
 * @param {string} error group of desired less actual
 * @param {string} quantity
 * @param {string} unit
 * @returns {(source: Source) => Panel[]}
 */
function besideDesired(desired, error, quantity, unit) {
  return (source) => source.joints.map((joint) => ({
    id: `${quantity}${joint}`,
    title: `joint ${joint}`,
    quantity,
    unit: unitAt(unit, joint),
    traces: [
      ...source.lanes.flatMap((lane) => traces(
        source, lane, `${quantity} joint ${joint} ${lane}`,
        [['', desired, joint], [lane, error, joint]], {rule: 'difference'},
      )),
      ...traces(
        source, '', `${quantity} joint ${joint} desired`, [['', desired, joint]],
        {role: 'desired'},
      ),
    ],
  }));
}

/**
 * @param {Source} source
 * @returns {Panel[]}
 */
function flange(source) {
  return AXES.map((axis) => ({
    id: `flange-${axis}`,
    title: 'flange',
    quantity: axis.toUpperCase(),
    unit: 'm',
    traces: [
      ...source.lanes.flatMap((lane) => (
        traces(source, lane, `${axis} flange ${lane}`, [[lane, 'flange', axis]])
      )),
      ...traces(
        source, '', `${axis} flange desired`, [['', 'flange_d', axis]], {role: 'desired'},
      ),
    ],
  }));
}

/**
 * @param {Source} source
 * @returns {Panel[]}
 */
function flangeError(source) {
  return [{
    id: 'flange-error',
    title: 'flange',
    quantity: 'error',
    unit: 'mm',
    positive: true,
    traces: source.lanes.flatMap((lane) => traces(
      source, lane, `flange error ${lane}`,
      [...AXES.map((axis) => /** @type {[string, string, string]} */ ([lane, 'flange', axis])),
        ...AXES.map((axis) => /** @type {[string, string, string]} */ (['', 'flange_d', axis]))],
      {rule: 'distance', scale: MILLIMETRES},
    )),
  }];
}

/**
 * The network's output above the norm of its weights, joint after joint.
 *
 * @param {Source} source
 * @returns {Panel[]}
 */
function network(source) {
  const shown = (/** @type {string} */ lane) => source.hasNetwork(lane);
  if (!source.lanes.some(shown)) return [];
  const outputs = perJoint('f', 'f', 'N·m', {shown, held: true})(source);
  const weights = perJoint('weights', 'norm of W', 'N·m', {shown})(source);
  return outputs.flatMap((output, index) => [output, {...weights[index], positive: true}]);
}

/** @type {View[]} */
export const VIEWS = [
  {id: 'error', title: 'Error', joints: true, panels: perJoint('e', 'e', 'rad')},
  {id: 'tracking', title: 'Tracking', joints: true,
    panels: besideDesired('q_d', 'e', 'q', 'rad')},
  {id: 'velocity', title: 'Velocity', joints: true,
    panels: besideDesired('v_d', 'de', 'v', 'rad/s')},
  {id: 'torque', title: 'Torque', joints: true, panels: perJoint('tau', 'τ', 'N·m', {held: true})},
  {id: 'surface', title: 'Surface', joints: true, panels: perJoint('S', 'S', 'rad/s')},
  {id: 'network', title: 'Network', joints: true, panels: network,
    empty: 'No lane has a neural network.'},
  {id: 'flange', title: 'Flange', joints: false, panels: flange},
  {id: 'flange-error', title: 'Flange error', joints: false, panels: flangeError},
  {id: 'spectrum', title: 'Spectrum', joints: true, spectrum: true,
    panels: perJoint('tau', '|τ|', 'N·m')},
];
