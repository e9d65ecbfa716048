// @ts-check
/** The picture of the tries of a search for the worst, in their order. */

import {axis, faint} from '../lenses/figure.js';
import {ratioText} from '../goals/words.js';
import {failureOf} from './outcome_words.js';

/** @typedef {import('../api/requests/studies.js').Draw} Draw */

const TOP = 0.97;

/**
 * @param {import('../lenses/figure.js').Colors} colors
 * @param {Draw[]} draws
 * @param {string} color
 */
export function triesFigure(colors, draws, color) {
  const ended = draws.filter(({outcome}) => outcome.score !== null);
  const gone = draws.filter(({outcome}) => outcome.score === null);
  const number = ({index}) => index + 1;
  let worst = -Infinity;
  const running = ended.map(({outcome}) => { worst = Math.max(worst, Number(outcome.score)); return worst; });
  return {
    data: [
      {
        type: 'scatter', mode: 'markers', uid: 'tries', x: ended.map(number),
        y: ended.map(({outcome}) => outcome.score),
        marker: {size: 6, color: ended.map(({outcome}) => (outcome.kept ? faint(color, 0.8) : colors.bad))},
        text: ended.map((draw) => `try ${number(draw)}: ${ratioText(draw.outcome.score)}`),
        hovertemplate: '%{text}<extra></extra>',
      },
      {
        type: 'scatter', mode: 'lines', uid: 'worst', x: ended.map(number), y: running,
        line: {color: colors.text, width: 1.4, shape: 'hv'}, hoverinfo: 'skip',
      },
      {
        type: 'scatter', mode: 'markers', uid: 'diverged', x: gone.map(number), y: gone.map(() => TOP),
        yaxis: 'y2', cliponaxis: false,
        marker: {symbol: 'x-thin', size: 8, color: colors.bad, line: {width: 2, color: colors.bad}},
        text: gone.map((draw) => `try ${number(draw)}: ${failureOf(draw.outcome) || 'came to no end'}`),
        hovertemplate: '%{text}<extra></extra>',
      },
    ],
    layout: {
      xaxis: axis(colors, {title: 'try', rangemode: 'tozero'}),
      yaxis: axis(colors, {title: 'score', rangemode: 'tozero'}),
      yaxis2: {overlaying: 'y', range: [0, 1], visible: false, fixedrange: true},
      shapes: [{
        type: 'line', xref: 'paper', x0: 0, x1: 1, y0: 1, y1: 1,
        line: {color: colors.good, width: 1.2, dash: 'dash'},
      }],
    },
  };
}
