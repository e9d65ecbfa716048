// @ts-check
/** The picture of V over time, and of its derivative with the sign that decides. */

import {axis, faint} from './figure.js';

/** @typedef {import('./figure.js').Colors} Colors */

/** Decades of V that are shown below its greatest value. */
const DECADES = 6;
/** Share of dV/dt that the axis spans: the first moment would dwarf everything after it. */
const USUAL = 0.97;

/**
 * @param {Colors} colors
 * @param {{time: number[], V: number[], V_rate: number[]}} sliding
 * @param {string} color of the lane
 * @param {boolean} marked whether V itself is marked where it grows
 */
export function energyFigure(colors, {time, V, V_rate: rate}, color, marked) {
  const most = Math.max(1e-12, ...V);
  const top = Math.log10(most) + 0.2;
  const seen = V.map((value) => (value > most * 10 ** -DECADES ? value : null));
  const growing = seen.map((value, index) => (
    marked && (rate[index] > 0 || rate[index - 1] > 0) ? value : null
  ));
  const usual = spanned(rate);
  const filled = (/** @type {string} */ uid, /** @type {string} */ tint, /** @type {number[]} */ y) => ({
    type: 'scatter', mode: 'lines', uid, x: time, y, yaxis: 'y2', fill: 'tozeroy',
    fillcolor: faint(tint, 0.35), line: {color: tint, width: 1, simplify: false}, hoverinfo: 'skip',
  });
  return {
    data: [
      {
        type: 'scatter', mode: 'lines', uid: 'V', x: time, y: seen, name: 'V',
        hovertemplate: 't = %{x:.3f} s<br>V = %{y:.3~g} J<extra></extra>',
        line: {color, width: 1.4, simplify: false},
      },
      {
        type: 'scatter', mode: 'lines', uid: 'growing', x: time, y: growing, hoverinfo: 'skip',
        line: {color: colors.bad, width: 2.4, simplify: false},
      },
      filled('falls', colors.good, rate.map((value) => Math.min(value, 0))),
      filled('grows', colors.bad, rate.map((value) => Math.max(value, 0))),
    ],
    layout: {
      uirevision: `${time.length}-${most.toPrecision(2)}`,
      xaxis: axis(colors, {title: 't [s]', anchor: 'y2', zeroline: false}),
      yaxis: axis(colors, {
        title: 'V [J]', type: 'log', range: [Math.max(top - DECADES, lowest(seen)), top],
        domain: [0.52, 1], nticks: 5,
      }),
      yaxis2: axis(colors, {
        title: 'dV/dt [W]', domain: [0, 0.44], range: [-usual, usual], nticks: 5,
      }),
      annotations: [
        sign(colors.bad, 'grows', 0.43, 'top'), sign(colors.good, 'falls', 0.01, 'bottom'),
      ],
    },
  };
}

/** @param {(number|null)[]} values */
function lowest(values) {
  const known = values.filter((value) => value !== null);
  return known.length ? Math.log10(Math.min(...known)) - 0.2 : -6;
}

/** @param {number[]} rate */
function spanned(rate) {
  const sizes = rate.map(Math.abs).sort((one, other) => one - other);
  return 1.3 * Math.max(1e-12, sizes[Math.floor(USUAL * (sizes.length - 1))]);
}

/**
 * @param {string} color
 * @param {string} text
 * @param {number} y
 * @param {string} yanchor
 */
function sign(color, text, y, yanchor) {
  return {
    xref: 'paper', yref: 'paper', x: 0.995, y, xanchor: 'right', yanchor, text, showarrow: false,
    font: {color},
  };
}
