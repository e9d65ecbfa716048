// @ts-check
/** The trials of a search: what became of each, the best so far, and the gains that it stands for. */

import {joined} from '../fields/merge_patch.js';
import {FIGURES} from '../figures/figure.js';
import {threeDigits} from '../figures/columns.js';
import {ratioText} from '../goals/words.js';
import {percent} from '../lenses/card.js';

/** @typedef {import('../api/requests/studies.js').Study} Study */
/** @typedef {import('../api/requests/studies.js').Trial} Trial */
/** @typedef {import('../fields/merge_patch.js').Document} Document */
/** @typedef {'kept'|'missed'|'louder'|'diverged'|'refused'|'beaten'} Fate */
/**
 * A number of each trial, as it is shown; null where there is none.
 * @typedef {{id: string, title: string, unit: string, of: (trial: Trial) => number|null}} Measure
 */

/** What each fate is called in a legend. */
export const FATES = /** @type {const} */ ({
  kept: 'hard goals kept',
  missed: 'a hard goal missed',
  louder: 'chatters more than before',
  diverged: 'diverged: no score',
  refused: 'refused: no score',
  beaten: 'given up early',
});

/**
 * @param {Trial} trial
 * @returns {Fate}
 */
export function fateOf({outcome, beaten, louder}) {
  if (outcome.refused) return 'refused';
  if (outcome.diverged_at !== null) return 'diverged';
  if (beaten) return 'beaten';
  if (louder) return 'louder';
  return outcome.kept ? 'kept' : 'missed';
}

/**
 * @param {readonly Trial[]} trials
 * @returns {number[]} after each trial the number of the best so far, -1 while there is none
 */
export function bestSoFar(trials) {
  let best = -1;
  return trials.map(({beaten, outcome}, number) => {
    if (!beaten && (best < 0 || outcome.cost < trials[best].outcome.cost)) best = number;
    return best;
  });
}

/** @type {Measure} */
export const SCORE = {id: 'score', title: 'score', unit: '', of: ({outcome}) => outcome.score};

/**
 * @param {Study} study
 * @returns {Measure[]} the ratios of the soft goals, of the hard ones, the figures, the score
 */
export function measuresOf({experiment}) {
  const goals = Object.entries(experiment.goals);
  const ratios = ['soft', 'hard'].flatMap((priority) => (
    goals.filter(([, goal]) => goal.priority === priority).map(([name]) => ratioOf(name))
  ));
  const figures = FIGURES.filter(({studied}) => studied).map((figure) => ({
    id: `figure.${figure.name}`, title: figure.title, unit: figure.shown_unit,
    of: (/** @type {Trial} */ {outcome}) => {
      const value = outcome.figures[figure.name] ?? null;
      return value === null ? null : value * figure.factor;
    },
  }));
  return [...ratios, ...figures, SCORE];
}

/**
 * @param {string} name of a goal
 * @returns {Measure}
 */
function ratioOf(name) {
  return {id: `ratio.${name}`, title: `${name}, of its bound`, unit: '',
    of: ({outcome}) => outcome.ratios[name] ?? null};
}

/**
 * @param {Study} study
 * @returns {string[]} names of its soft goals
 */
export function softGoals({experiment}) {
  return Object.entries(experiment.goals).filter(([, goal]) => goal.priority === 'soft')
    .map(([name]) => name);
}

/**
 * The lane as it was in a trial, whole: its gains count under its other choices alone.
 *
 * @param {Study} study
 * @param {Trial} trial
 * @returns {Document}
 */
export function laneOf({experiment, lane}, trial) {
  return joined(experiment.lanes[lane], trial.patch.lanes?.[lane] ?? {});
}

/**
 * @param {Trial} trial
 * @returns {string} such as `Trial 37: score 0.83, hard goals kept`
 */
export function wordsOf(trial) {
  const {number, outcome} = trial;
  const fate = fateOf(trial);
  if (fate === 'refused') return `Trial ${number}: refused, ${outcome.refused}`;
  if (fate === 'diverged') {
    return `Trial ${number}: left its bounds at ${threeDigits(outcome.diverged_at)} s`;
  }
  const {draws, kept} = trial.draws;
  const share = fate === 'missed' && draws > 1 ? `, kept at ${percent(kept)} of the draws` : '';
  return `Trial ${number}: score ${ratioText(outcome.score)}, ${FATES[fate]}${share}`;
}
