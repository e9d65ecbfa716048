// @ts-check
/** Plots as files: PNG, SVG, and CSV of every sample in sight. */

import {library} from '../plots/figure.js';
import {rowsUntil} from '../curves/freezes.js';
import {rowsIn} from '../curves/panel_curves.js';
import {amplitudeSpectrum} from '../curves/spectrum.js';
import {valuesOf} from '../curves/trace_values.js';

/** @typedef {import('../curves/ring.js').Ring} Ring */
/** @typedef {import('../live/views.js').Panel} Panel */
/** @typedef {import('../curves/panel_curves.js').Freeze} Freeze */
/** @typedef {import('../curves/y_range.js').Range} Range */

/** Pixels of a PNG for each one on the screen: enough for print. */
const PNG_SCALE = 3;
const ROWS_PER_PART = 5000;
const DIGITS = 9;

/**
 * @param {Blob} blob
 * @param {string} name of the file
 */
export function download(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  // The browser has taken hold of it by then.
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/**
 * @param {{data: object[], layout: any}} figure
 * @param {'png'|'svg'} format
 * @returns {Promise<Blob>}
 */
export async function image(figure, format) {
  const {width, height} = figure.layout;
  const content = await library().toImage(figure, {
    format, width, height, scale: format === 'png' ? PNG_SCALE : 1, imageDataOnly: true,
  });
  if (format === 'svg') return new Blob([content], {type: 'image/svg+xml'});
  const bytes = Uint8Array.from(atob(content), (letter) => letter.charCodeAt(0));
  return new Blob([bytes], {type: 'image/png'});
}

/**
 * Every sample of a window, undecimated; what never arrived, or came after a freeze, is empty.
 *
 * @param {Ring} ring
 * @param {Panel[]} panels
 * @param {Range} window in [s]
 * @param {Map<string, Freeze>} freezes
 * @returns {Blob}
 */
export function timeTable(ring, panels, window, freezes) {
  const [from, to] = rowsIn(ring, window);
  const columns = panels.flatMap((panel) => panel.traces.map((trace) => {
    const freeze = freezes.get(trace.lane);
    const values = valuesOf(ring, trace, from, to);
    values.fill(NaN, rowsUntil(ring, freeze, from, to) - from);
    return {header: `${trace.label} [${panel.unit}]`, values};
  }));
  const time = Float64Array.from({length: to - from}, (_, row) => ring.timeOf(from + row));
  return table([{header: 'time [s]', values: time}, ...columns]);
}

/**
 * Amplitude spectra of a window.
 *
 * @param {Ring} ring
 * @param {Panel[]} panels
 * @param {Range} window in [s]
 * @param {Map<string, Freeze>} freezes
 * @returns {Blob} a frequency and an amplitude for each trace: they may differ in length
 */
export function spectrumTable(ring, panels, window, freezes) {
  const [from, to] = rowsIn(ring, window);
  return table(panels.flatMap((panel) => panel.traces.flatMap((trace) => {
    const freeze = freezes.get(trace.lane);
    const values = valuesOf(ring, trace, from, rowsUntil(ring, freeze, from, to));
    const {frequency, amplitude} = amplitudeSpectrum(values, ring.dt);
    return [
      {header: `frequency of ${trace.label} [Hz]`, values: frequency},
      {header: `${trace.label} [${panel.unit}]`, values: amplitude},
    ];
  })));
}

/**
 * @param {{header: string, values: Float32Array|Float64Array}[]} columns
 * @returns {Blob}
 */
export function table(columns) {
  const rows = Math.max(0, ...columns.map(({values}) => values.length));
  const parts = [`${columns.map(({header}) => quoted(header)).join(',')}\r\n`];
  for (let first = 0; first < rows; first += ROWS_PER_PART) {
    const lines = [];
    for (let row = first; row < Math.min(rows, first + ROWS_PER_PART); row += 1) {
      lines.push(columns.map(({values}) => cell(values[row])).join(','));
    }
    parts.push(`${lines.join('\r\n')}\r\n`);
  }
  return new Blob(parts, {type: 'text/csv;charset=utf-8'});
}

/** @param {number|undefined} value */
function cell(value) {
  if (value === undefined || Number.isNaN(value)) return '';
  return String(Number(value.toPrecision(DIGITS)));
}

/** @param {string} text */
function quoted(text) { return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text; }
