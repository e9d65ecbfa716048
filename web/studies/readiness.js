// @ts-check
/** What a study of a kind lacks before it can come to anything. */

/** @typedef {import('../fields/merge_patch.js').Document} Document */
/** @typedef {import('../api/studies.js').Kind} Kind */
/** @typedef {{text: string, group: string, action: string}} Lack `group` of the left column that mends it, or '' */

/** @type {Lack} */
const NO_GOAL = {
  text: 'Set a goal first: what the lane is held to.', group: 'goals', action: 'Open Goals',
};
/** @type {Lack} */
const NOTHING_UNCERTAIN = {
  text: 'Give a quantity of Uncertainty a range first.', group: 'uncertainty', action: 'Open Uncertainty',
};

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

/** @param {Document} experiment */
function isUncertain({uncertainty = {}}) {
  return Object.values(uncertainty).some((range) => Array.isArray(range));
}
