// @ts-check
/** What a study of a kind lacks before it can come to anything. */

/** @typedef {import('../fields/merge_patch.js').Document} Document */
/** @typedef {import('../api/requests/studies.js').Kind} Kind */
/** @typedef {{text: string, group: string, action: string}} Lack `group` of the left column that mends it, or '' */

/** @type {Lack} */
const NO_GOAL = {
  text: 'Set a goal first: what the lane is held to.', group: 'goals', action: 'Open Goals',
};
/** @type {Lack} */
const NOTHING_UNCERTAIN = {
  text: 'Give a quantity of Uncertainty a range first.', group: 'uncertainty', action: 'Open Uncertainty',
};

/** Figures that a lane which chatters can't keep small. */
const CHATTER = new Set(['chattering', 'switches', 'high_frequency_torque']);
const CHATTERS = 'No goal bounds chattering: gains that are found may chatter far more than the present '
  + 'ones. Tick "No more chattering than now", or set a bound: the target beside chattering in Response does.';

/**
 * @param {Kind} kind
 * @param {Document} experiment
 * @param {Document} wanted what the form says
 * @returns {Lack[]}
 */
export function lacks(kind, experiment, wanted) {
  const goals = Object.values(experiment.goals ?? {});
  const found = [];
  if ((kind === 'tune' || kind === 'worst') && !goals.length) found.push(NO_GOAL);
  const draws = kind === 'robustness' || kind === 'worst' || (kind === 'tune' && wanted.draws > 0);
  if (draws && !isUncertain(experiment)) found.push(NOTHING_UNCERTAIN);
  const soft = goals.filter(({priority}) => priority === 'soft').length;
  if (kind === 'tune' && goals.length && wanted.sampler === 'nsga2' && soft < 2) {
    found.push({...NO_GOAL, text: `nsga2 chooses between two soft goals or more; there ${soft ? 'is 1' : 'are 0'}.`});
  }
  if (kind === 'tune' && !Object.keys(wanted.gains ?? {}).length) {
    found.push({text: 'Tick a gain to search.', group: '', action: ''});
  }
  return found;
}

/**
 * What nothing forbids, though few want it.
 *
 * @param {Kind} kind
 * @param {Document} experiment
 * @param {Document} wanted what the form says
 * @returns {string} a warning, or ''
 */
export function risk(kind, {goals = {}}, {quiet}) {
  const all = Object.values(goals);
  return kind === 'tune' && !quiet && all.length && !all.some(({figure}) => CHATTER.has(figure)) ? CHATTERS : '';
}

/** @param {Document} experiment */
export function isUncertain({uncertainty = {}}) {
  return Object.values(uncertainty).some((range) => Array.isArray(range));
}
