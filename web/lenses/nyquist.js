// @ts-check
/** The picture of harmonic balance: a joint's Nyquist curve against -1/N(A). */

import {unitAt} from '../api/arm.js';
import {plain} from '../plots/figure.js';
import {axis} from './figure.js';
import {threeDigits} from '../figures/columns.js';
import {isHeldByNothing} from './prediction_words.js';

/** @typedef {import('./figure.js').Colors} Colors */

/**
 * @param {Colors} colors
 * @param {any} one a joint that has a curve
 * @param {{lane: string, color: string, joint: number}} of
 */
export function nyquistFigure(colors, one, {lane, color, joint}) {
  if (!one.crossing) return apart(colors, one, {lane, color, joint});
  const {crossing: [x, y], layer} = one;
  const speed = unitAt('rad/s', joint);
  const size = Math.hypot(x, y);
  const reach = 1.6 * Math.max(size, layer);
  const silent = one.amplitude === 0;
  // Super-twisting has no layer, and turns its swing away from the axis.
  const place = one.threshold === null ? '' : `ε* = ${threeDigits(size)} ${speed}, `;
  const unit = y === 0 ? speed : 's';
  return {
    data: [...curves(colors, one, {lane, color, joint}), {
      type: 'scatter', mode: 'markers', uid: 'crossing', x: [x], y: [y],
      hovertemplate: `${place}${threeDigits(one.frequency)} Hz<extra></extra>`,
      marker: {symbol: 'circle-open', size: 13, color: silent ? colors.good : colors.bad, line: {width: 2.5}},
    }],
    layout: {
      uirevision: `${lane}-${joint}`,
      xaxis: axis(colors, {title: `Re [${unit}]`, range: [-reach, 0.3 * reach], zeroline: true}),
      yaxis: axis(colors, {title: `Im [${unit}]`, range: [-0.8 * reach, 0.4 * reach], zeroline: true}),
      annotations: marks(colors, one, silent || isHeldByNothing(one)),
    },
  };
}

/**
 * The curve, and the dots of −1/N(A).
 *
 * @param {Colors} colors
 * @param {any} one
 * @param {{lane: string, color: string, joint: number}} of
 */
function curves(colors, {curve: [real, imaginary], curve_frequency: frequency, line}, {lane, color, joint}) {
  const [amplitude, ...balance] = line;
  return [{
    type: 'scatter', mode: 'lines', uid: 'curve', name: plain(lane), x: real, y: imaginary,
    customdata: frequency, hovertemplate: 'G at %{customdata:.3~g} Hz<extra></extra>',
    line: {color, width: 1.8, simplify: false},
  }, {
    type: 'scatter', mode: 'lines', uid: 'balance', x: balance[0], y: balance[1], customdata: amplitude,
    hovertemplate: `−1/N at A = %{customdata:.3~g} ${unitAt('rad/s', joint)}<extra></extra>`,
    line: {color: colors.text, width: 3, dash: 'dot'},
  }];
}

/**
 * A curve that never meets −1/N(A), with the place where it comes nearest.
 *
 * @param {Colors} colors
 * @param {any} one
 * @param {{lane: string, color: string, joint: number}} of
 */
function apart(colors, one, {lane, color, joint}) {
  const {layer, curve: [real, imaginary], curve_frequency: frequency, line, nearest} = one;
  // Of super-twisting the dots would be others at each frequency.
  const unit = line[0].length ? unitAt('rad/s', joint) : 's';
  const sizes = real.map((/** @type {number} */ x, /** @type {number} */ index) => Math.hypot(x, imaginary[index]));
  // Near 0 Hz a curve may be as long as it likes.
  const size = layer ? Math.min(Math.max(...sizes), 3 * layer) : sizes[Math.floor(sizes.length / 2)];
  const reach = 1.3 * Math.max(size, layer);
  const at = nearest === null ? -1
    : frequency.findIndex((/** @type {number} */ value) => value >= nearest * (1 - 1e-9));
  const shown = at >= 0 && sizes[at] < reach;
  return {
    data: [...curves(colors, one, {lane, color, joint}), ...(shown ? [{
      type: 'scatter', mode: 'markers', uid: 'nearest', x: [real[at]], y: [imaginary[at]],
      hovertemplate: `nearest to the dots at ${threeDigits(nearest)} Hz<extra></extra>`,
      marker: {symbol: 'circle-open', size: 13, color: colors.good, line: {width: 2.5}},
    }] : [])],
    layout: {
      uirevision: `${lane}-${joint}`,
      xaxis: axis(colors, {title: `Re [${unit}]`, range: [-reach, reach], zeroline: true}),
      yaxis: axis(colors, {title: `Im [${unit}]`, range: [-reach, 0.5 * reach], zeroline: true}),
      annotations: layerMark(colors, layer),
    },
  };
}

/**
 * @param {Colors} colors
 * @param {any} one
 * @param {boolean} fleeting whether no limit cycle is to be seen there
 */
function marks(colors, {crossing: [x, y], threshold, layer}, fleeting) {
  const named = [threshold !== null && 'ε*', !fleeting && 'limit cycle'].filter(Boolean).join(', ');
  const told = !named ? [] : [{
    x, y, text: named, showarrow: true, arrowhead: 0,
    arrowcolor: colors.muted, ax: 16, ay: -32, xanchor: 'left', font: {color: colors.text},
  }];
  return [...told, ...layerMark(colors, layer)];
}

/**
 * Where the dots begin.
 *
 * @param {Colors} colors
 * @param {number} layer
 */
function layerMark(colors, layer) {
  return layer ? [{
    x: -layer, y: 0, text: '−ε', showarrow: true, arrowhead: 0, arrowcolor: colors.muted, ax: 0, ay: 30,
    xanchor: 'center', font: {color: colors.text},
  }] : [];
}
