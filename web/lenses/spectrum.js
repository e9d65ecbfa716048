// @ts-check
/** The picture of torque over frequency, with what counts as chattering marked. */

import {unitAt} from '../api/arm.js';
import {plain} from '../plots/figure.js';
import {axis, faint} from './figure.js';

/** @typedef {import('./figure.js').Colors} Colors */
/** @typedef {{name: string, color: string, dash: string, density: number[], width?: number}} Spectrum */

/** Decades of density shown below the greatest: what is less is rounding. */
const DECADES = 7;

/**
 * @param {Colors} colors
 * @param {any} chattering
 * @param {Spectrum[]} spectra over the same frequencies
 * @param {{lane: string, joint: number}} of
 */
export function spectrumFigure(colors, {frequency, limit}, spectra, {lane, joint}) {
  const unit = `${unitAt('N·m', joint)}/√Hz`;
  const all = spectra.flatMap(({density}) => density);
  const top = Math.log10(Math.max(1e-9, ...all)) + 0.3;
  const least = Math.log10(Math.max(Math.min(...all.filter((value) => value > 0)), 1e-12)) - 0.2;
  const [first, last] = [frequency[0] ?? 1, frequency[frequency.length - 1] ?? 1000];
  const right = Math.log10(Math.max(last, 1.5 * limit));
  return {
    data: spectra.map(({name, color, dash, density, width = 1.6}, index) => ({
      type: 'scatter', mode: 'lines', uid: `density${index}`, name: plain(name),
      x: frequency, y: density,
      hovertemplate: `%{x:.4~g} Hz<br>%{y:.3~g} ${unit}`,
      line: {color, width, dash, simplify: false},
    })),
    layout: {
      uirevision: `${lane}-${joint}`,
      xaxis: axis(colors, {
        title: 'frequency [Hz]', type: 'log', range: [Math.log10(first), right],
      }),
      yaxis: axis(colors, {
        title: unit, type: 'log', range: [Math.max(least, top - DECADES), top], nticks: 6,
      }),
      shapes: [{
        type: 'rect', yref: 'paper', x0: limit, x1: 10 ** right, y0: 0, y1: 1, layer: 'below',
        fillcolor: faint(colors.bad, 0.08), line: {width: 0},
      }, {
        type: 'line', yref: 'paper', x0: limit, x1: limit, y0: 0, y1: 1,
        line: {color: colors.bad, width: 1, dash: 'dot'},
      }],
      annotations: [{
        x: Math.log10(limit), yref: 'paper', y: 0.98, text: `${limit} Hz`, showarrow: false,
        xanchor: 'left', yanchor: 'top', xshift: 4, font: {color: colors.bad},
      }],
      showlegend: spectra.length > 1,
      legend: {orientation: 'h', x: 0, y: 1.02, yanchor: 'bottom', bgcolor: 'transparent'},
    },
  };
}
