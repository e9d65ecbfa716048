// @ts-check
/** Measured torque, and what a fit leaves of it, joint by joint. */

import {JOINTS, unitAt} from '../api/arm.js';
import {LensFigure, axis} from '../lenses/figure.js';
import {inDigits} from '../figures/columns.js';

/** @typedef {import('../api/requests/logs.js').Identification} Identification */

const PANEL_HEIGHT = 62;
const EDGES = 46;
const DIGITS = 3;
/** Share of the whole that parts two panels. */
const PARTED = 0.18;

/**
 * @param {Identification} found
 * @returns {LensFigure}
 */
export function residualFigure({time, torque, residual, rms_torque: whole, rms_residual: left}) {
  const figure = new LensFigure({height: PANEL_HEIGHT * JOINTS.length + EDGES});
  const words = JOINTS.map((joint, at) => (
    `joint ${joint}: ${inDigits(left[at], DIGITS)} of ${inDigits(whole[at], DIGITS)} ${unitAt('N·m', joint)} are left`
  ));
  figure.draw(`What the fit leaves of the torque, effective: ${words.join('; ')}`, (colors) => ({
    data: JOINTS.flatMap((joint, at) => [
      line(time, torque[at], at, colors.muted, 1), line(time, residual[at], at, colors.accent, 1.4),
    ]),
    layout: {
      xaxis: axis(colors, {title: 't [s]', anchor: `y${name(JOINTS.length - 1)}`}),
      ...Object.fromEntries(JOINTS.map((joint, at) => [`yaxis${name(at)}`, axis(colors, {
        title: `joint ${joint}<br>[${unitAt('N·m', joint)}]`, domain: domainOf(at), nticks: 3,
      })])),
      annotations: words.map((text, at) => ({
        text: text.replace(/^.*?: /, ''), showarrow: false, xref: 'paper', yref: 'paper', x: 1, xanchor: 'right',
        y: domainOf(at)[1], yanchor: 'bottom', font: {color: colors.muted, size: 10},
      })),
    },
  }));
  return figure;
}

/** @param {number} at from 0 */
function name(at) { return at ? String(at + 1) : ''; }

/** @param {number} at */
function domainOf(at) {
  const each = 1 / JOINTS.length;
  const bottom = 1 - (at + 1) * each;
  return [bottom, bottom + each * (1 - PARTED)];
}

/**
 * @param {number[]} x
 * @param {number[]} y
 * @param {number} at
 * @param {string} color
 * @param {number} width
 */
function line(x, y, at, color, width) {
  return {
    type: 'scatter', mode: 'lines', x, y, xaxis: 'x', yaxis: `y${name(at)}`, line: {color, width},
    hovertemplate: '%{x:.3f} s: %{y:.4~g}<extra></extra>',
  };
}
