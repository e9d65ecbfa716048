// @ts-check
/** The picture of one band: nine tenths of the draws filled, the median, the extremes, the bounds. */

import {axis, faint} from '../lenses/figure.js';

/** @typedef {import('../api/requests/studies.js').Band} Band */
/** @typedef {import('../lenses/figure.js').Colors} Colors */
/** @typedef {import('../response/views.js').ResponsePanel} Panel */
/** @typedef {{name: string, start: number, end: number, value: number, kept: boolean|null}} BoundLine */
/** @typedef {(number|null)[]} Values */

const FILLED = 0.28;
const THIN = 0.55;
/** A bound so many times beyond the curves would flatten them. */
const FAR = 3;
const MARGIN = {l: 62, r: 8, t: 20, b: 30};

/**
 * @param {Colors} colors
 * @param {{time: number[], band: Band, panel: Panel, color: string, bounds: BoundLine[]}} look
 *   bounds in the unit of the panel
 */
export function bandFigure(colors, {time, band, panel, color, bounds}) {
  const {scale, unit, positive} = panel;
  const scaled = (/** @type {Values} */ values) => values.map((value) => (value === null ? null : value * scale));
  const [low, median, high, least, greatest] = [band.low, band.median, band.high, band.least, band.greatest]
    .map(scaled);
  const line = (/** @type {string} */ uid, /** @type {string} */ name, /** @type {Values} */ y, /** @type {object} */ look) => ({
    type: 'scatter', mode: 'lines', uid, name, x: time, y, connectgaps: false, ...look,
    hovertemplate: `%{y:.3~g} ${unit}`,
  });
  const thin = {line: {color, width: 0.8}, opacity: THIN};
  const none = {line: {color, width: 0}};
  const signs = positive ? [1] : [1, -1];
  return {
    data: [
      {
        type: 'scatter', mode: 'lines', uid: 'band', ...outline(time, low, high), fill: 'toself',
        fillcolor: faint(color, FILLED), line: {width: 0}, hoverinfo: 'skip',
      },
      line('greatest', 'greatest', greatest, thin),
      line('high', '95 %', high, none),
      line('median', 'median', median, {line: {color, width: 2}}),
      line('low', '5 %', low, none),
      line('least', 'least', least, thin),
      ...bounds.flatMap(({name, start, end, value, kept}) => signs.map((sign) => ({
        type: 'scatter', mode: 'lines', uid: `bound ${name} ${sign}`, name,
        x: [start, end], y: [sign * value, sign * value], hoverinfo: 'skip',
        line: {color: kept === null ? colors.muted : kept ? colors.good : colors.bad, width: 1.6, dash: '5px,3px'},
      }))),
    ],
    layout: {
      margin: MARGIN,
      hovermode: 'x unified',
      annotations: [{
        text: panel.title, x: 0, y: 1, xref: 'paper', yref: 'paper', xanchor: 'left', yanchor: 'bottom',
        showarrow: false, font: {color: colors.text},
      }],
      xaxis: axis(colors, {title: 't [s]', unifiedhovertitle: {text: 't = %{x:.3~g} s'}}),
      yaxis: axis(colors, {
        title: `${panel.quantity} [${unit}]`, nticks: 6,
        range: rangeOf([...least, ...greatest, ...low, ...high, ...median], bounds, signs),
      }),
    },
  };
}

/**
 * A closed line around each stretch where there is a band, with gaps in between.
 *
 * @param {number[]} time
 * @param {Values} low
 * @param {Values} high
 * @returns {{x: Values, y: Values}}
 */
function outline(time, low, high) {
  /** @type {number[][]} */ const stretches = [[]];
  time.forEach((_, index) => {
    const stretch = stretches[stretches.length - 1];
    if (low[index] !== null && high[index] !== null) stretch.push(index);
    else if (stretch.length) stretches.push([]);
  });
  /** @type {Values} */ const [x, y] = [[], []];
  for (const stretch of stretches.filter(({length}) => length)) {
    const back = [...stretch].reverse();
    x.push(...stretch.map((index) => time[index]), ...back.map((index) => time[index]), null);
    y.push(...stretch.map((index) => high[index]), ...back.map((index) => low[index]), null);
  }
  return {x, y};
}

/**
 * @param {Values} values
 * @param {BoundLine[]} bounds
 * @param {number[]} signs
 * @returns {[number, number]|undefined}
 */
function rangeOf(values, bounds, signs) {
  const known = values.filter((value) => value !== null);
  const size = known.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  if (size === 0) return undefined;
  const near = bounds.filter(({value}) => value <= FAR * size)
    .flatMap(({value}) => signs.map((sign) => sign * value));
  const all = [...known, ...near];
  const [low, high] = [all.reduce((a, b) => Math.min(a, b)), all.reduce((a, b) => Math.max(a, b))];
  const room = 0.06 * (high - low || size);
  return [low - room, high + room];
}

/**
 * The goals that bound what a panel shows.
 *
 * @param {import('../api/requests/studies.js').Study} study
 * @param {Panel} panel
 * @returns {BoundLine[]}
 */
export function boundsIn({experiment, result}, panel) {
  const {horizon} = experiment.simulation;
  /** @type {[string, import('../goals/words.js').Goal][]} */
  const goals = Object.entries(experiment.goals ?? {});
  return goals.flatMap(([name, goal]) => {
    const {channel = '', joint, start = 0} = goal;
    const end = Math.min(goal.end ?? horizon, horizon);
    const rest = panel.channel.startsWith(channel) ? panel.channel.slice(channel.length) : null;
    const concerns = rest === '' || (/^[1-6]$/.test(rest ?? '') && (joint === 0 || joint === Number(rest)));
    if (goal.kind !== 'response' || !concerns || start >= end) return [];
    const ratio = result?.quantiles?.ratios[name]?.p95;
    const kept = ratio === undefined ? null : ratio !== null && ratio <= 1;
    return [{name, start, end, value: goal.bound * panel.scale, kept}];
  });
}
