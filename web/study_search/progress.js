// @ts-check
/** How far a search has come: the score of every trial in its order, and the best so far. */

import {SCORE, bestSoFar, fateOf} from '../trials/trials.js';
import {scaleOf} from '../trials/scales.js';

/** @typedef {import('../trials/point_plot.js').PointSheet} PointSheet */
/** @typedef {import('../trials/trials.js').Trial} Trial */

/**
 * @param {Trial[]} trials
 * @param {number} total of the search
 * @param {Pick<PointSheet, 'passes'|'marked'>} rest
 * @returns {PointSheet}
 */
export function progressSheet(trials, total, rest) {
  const x = Float64Array.from(trials, ({number}) => number);
  const scores = Float64Array.from(trials, (trial) => SCORE.of(trial) ?? NaN);
  const fates = trials.map(fateOf);
  const line = steps(trials, bestSoFar(trials));
  const up = scaleOf('score', scores, line.y);
  // What has no score is seen on the upper edge.
  const y = scores.map((score) => (Number.isNaN(score) ? Infinity : score));
  return {
    label: `Score of ${trials.length} trials in their order, and the best so far`,
    x, y, fates, up,
    across: {title: 'trial', log: false, range: [-1, Math.max(total, trials.length)]},
    steps: line,
    lines: (colors) => [{
      type: 'scatter', mode: 'lines', uid: 'met', x: [-1, Math.max(total, trials.length)], y: [1, 1],
      hoverinfo: 'skip', line: {color: colors.muted, width: 1, dash: 'dot'},
    }],
    key: 'progress',
    ...rest,
  };
}

/**
 * @param {Trial[]} trials
 * @param {number[]} best
 * @returns {{x: number[], y: (number|null)[]}} where the best changes, and the end
 */
function steps(trials, best) {
  const at = best.map((one, number) => ({one, number}))
    .filter(({one, number}) => one >= 0 && (one !== best[number - 1] || number === best.length - 1));
  return {
    x: at.map(({number}) => number), y: at.map(({one}) => SCORE.of(trials[one])),
  };
}
