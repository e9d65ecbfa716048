// @ts-check
/** The picture of harmonic balance: a joint's Nyquist curve against -1/N(A). */

import {plain} from '../plots/figure.js';
import {axis} from './figure.js';
import {threeDigits} from '../figures/columns.js';

/** @typedef {import('./figure.js').Colors} Colors */

/**
 * @param {Colors} colors
 * @param {any} one a joint with a limit cycle
 * @param {{lane: string, color: string, joint: number}} of
 */
export function nyquistFigure(colors, one, {lane, color, joint}) {
  const {crossing: [x, y], layer, curve: [real, imaginary], curve_frequency: frequency} = one;
  const [amplitude, ...balance] = one.line;
  const size = Math.hypot(x, y);
  const reach = 1.6 * Math.max(size, layer);
  const silent = one.amplitude === 0;
  // Super-twisting has no layer, and turns its swing away from the axis.
  const place = one.threshold === null ? '' : `ε* = ${threeDigits(size)} rad/s, `;
  const unit = y === 0 ? 'rad/s' : 's';
  return {
    data: [{
      type: 'scatter', mode: 'lines', uid: 'curve', name: plain(lane), x: real, y: imaginary,
      customdata: frequency, hovertemplate: 'G at %{customdata:.3~g} Hz<extra></extra>',
      line: {color, width: 1.8, simplify: false},
    }, {
      type: 'scatter', mode: 'lines', uid: 'balance', x: balance[0], y: balance[1], customdata: amplitude,
      hovertemplate: '−1/N at A = %{customdata:.3~g} rad/s<extra></extra>',
      line: {color: colors.text, width: 3, dash: 'dot'},
    }, {
      type: 'scatter', mode: 'markers', uid: 'crossing', x: [x], y: [y],
      hovertemplate: `${place}${threeDigits(one.frequency)} Hz<extra></extra>`,
      marker: {symbol: 'circle-open', size: 13, color: silent ? colors.good : colors.bad, line: {width: 2.5}},
    }],
    layout: {
      uirevision: `${lane}-${joint}`,
      xaxis: axis(colors, {title: `Re [${unit}]`, range: [-reach, 0.3 * reach], zeroline: true}),
      yaxis: axis(colors, {title: `Im [${unit}]`, range: [-0.8 * reach, 0.4 * reach], zeroline: true}),
      annotations: marks(colors, one, silent),
    },
  };
}

/**
 * @param {Colors} colors
 * @param {any} one
 * @param {boolean} silent
 */
function marks(colors, {crossing: [x, y], threshold, layer}, silent) {
  const named = [threshold !== null && 'ε*', !silent && 'limit cycle'].filter(Boolean).join(', ');
  const told = [{
    x, y, text: named, showarrow: true, arrowhead: 0,
    arrowcolor: colors.muted, ax: 16, ay: -32, xanchor: 'left', font: {color: colors.text},
  }];
  if (!layer) return told;
  return [...told, {
    x: -layer, y: 0, text: '−ε', showarrow: true, arrowhead: 0, arrowcolor: colors.muted, ax: 0, ay: 30,
    xanchor: 'center', font: {color: colors.text},
  }];
}
