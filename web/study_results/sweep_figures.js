// @ts-check
/** The pictures of a sweep: a curve over one field, a map over two. */

import {axis} from '../lenses/figure.js';
import {written} from '../fields/quantity.js';
import {plain} from '../plots/figure.js';

/** @typedef {import('../lenses/figure.js').Colors} Colors */
/**
 * An axis: `name` is `short` with its unit.
 * @typedef {{name: string, short: string, unit: string, path: string[], values: number[],
 *   log: boolean}} Swept
 */
/**
 * What is drawn of each point: `value` on the screen's scale, null where there is none.
 * @typedef {{title: string, points: {value: number|null, words: string, gone: boolean}[]}} Shown
 */

const MARGIN = {l: 62, r: 10, t: 20, b: 36};
const BOTTOM = 0.04;
/** Ratio of the greatest to the least value from which colours run by decades. */
const WIDE = 100;
const MOST_TICKS = 6;
const CROSS = {symbol: 'x-thin', size: 9};

/**
 * @param {Colors} colors
 * @param {Swept} swept
 * @param {Shown} shown
 * @param {string} color
 * @param {number|null} now what the live experiment has, null where it has no such number
 */
export function curveFigure(colors, {name, values, log}, {title, points}, color, now) {
  const made = values.slice(0, points.length);
  const gone = points.flatMap((point, place) => (point.gone ? [{point, place}] : []));
  return {
    data: [
      {
        type: 'scatter', mode: 'lines+markers', uid: 'curve', x: made,
        y: points.map(({value}) => value), customdata: points.map((_, place) => place),
        text: points.map(({words}) => plain(words)), hovertemplate: '%{text}<extra></extra>',
        connectgaps: false, line: {color, width: 2}, marker: {size: 6, color},
      },
      {
        type: 'scatter', mode: 'markers', uid: 'diverged', yaxis: 'y2',
        x: gone.map(({place}) => values[place]), y: gone.map(() => BOTTOM),
        customdata: gone.map(({place}) => place), text: gone.map(({point}) => plain(point.words)),
        hovertemplate: '%{text}<extra></extra>',
        marker: {...CROSS, color: colors.bad, line: {width: 2, color: colors.bad}},
      },
      ...(now !== null && now >= values[0] && now <= values[values.length - 1] ? [{
        type: 'scatter', mode: 'lines', uid: 'now', yaxis: 'y2', x: [now, now], y: [0, 1],
        hoverinfo: 'skip', line: {color: colors.text, width: 1, dash: 'dot'},
      }] : []),
    ],
    layout: {
      margin: MARGIN,
      annotations: [heading(colors, title)],
      xaxis: axis(colors, {title: plain(name), ...(log ? decades(values) : {nticks: MOST_TICKS}), range: ends(values, log)}),
      yaxis: axis(colors, {title: '', nticks: MOST_TICKS}),
      yaxis2: {overlaying: 'y', range: [0, 1], visible: false, fixedrange: true},
    },
  };
}

/**
 * Cells of the same size: of a logarithmic axis too.
 *
 * @param {Colors} colors
 * @param {[Swept, Swept]} axes the first one along, the second one up
 * @param {Shown} shown points in the order of the sweep: the second axis is the faster one
 */
export function mapFigure(colors, [along, up], {title, points}) {
  const rows = up.values.length;
  const at = (/** @type {number} */ column, /** @type {number} */ row) => points[column * rows + row];
  const known = points.flatMap(({value}) => (value === null ? [] : [value]));
  const wide = known.length > 0 && Math.min(...known) > 0 && Math.max(...known) > WIDE * Math.min(...known);
  const height = (/** @type {number|null|undefined} */ value) => (
    value === null || value === undefined ? null : wide ? Math.log10(value) : value
  );
  const grid = (/** @type {(column: number, row: number) => any} */ cell) => (
    up.values.map((_, row) => along.values.map((__, column) => cell(column, row)))
  );
  const gone = points.flatMap((point, place) => (point.gone ? [{point, place}] : []));
  return {
    data: [
      {
        type: 'heatmap', uid: 'map', z: grid((column, row) => height(at(column, row)?.value)),
        text: grid((column, row) => plain(at(column, row)?.words ?? '')),
        customdata: grid((column, row) => column * rows + row),
        hovertemplate: '%{text}<extra></extra>', hoverongaps: false, colorscale: 'Viridis',
        xgap: 1, ygap: 1, colorbar: bar(colors, title, known, wide),
      },
      {
        type: 'scatter', mode: 'markers', uid: 'diverged',
        x: gone.map(({place}) => Math.floor(place / rows)), y: gone.map(({place}) => place % rows),
        customdata: gone.map(({place}) => place), text: gone.map(({point}) => plain(point.words)),
        hovertemplate: '%{text}<extra></extra>',
        marker: {...CROSS, color: colors.bad, line: {width: 2, color: colors.bad}},
      },
    ],
    layout: {
      margin: {...MARGIN, t: 10},
      dragmode: false,
      xaxis: axis(colors, {title: plain(along.name), ...ticks(along.values), showgrid: false, zeroline: false}),
      yaxis: axis(colors, {title: plain(up.name), ...ticks(up.values), showgrid: false, zeroline: false}),
    },
  };
}

/**
 * @param {Colors} colors
 * @param {string} text
 */
function heading(colors, text) {
  return {
    text: plain(text), x: 0, y: 1, xref: 'paper', yref: 'paper', xanchor: 'left', yanchor: 'bottom',
    showarrow: false, font: {color: colors.text},
  };
}

/**
 * @param {Colors} colors
 * @param {string} title
 * @param {number[]} known
 * @param {boolean} wide
 */
function bar(colors, title, known, wide) {
  const decades = wide ? known.map((value) => Math.log10(value)) : [0];
  const [low, high] = [Math.ceil(Math.min(...decades)), Math.floor(Math.max(...decades))];
  const marks = Array.from({length: Math.max(high - low + 1, 0)}, (_, index) => low + index);
  return {
    title: {text: plain(title), side: 'right'}, thickness: 12, outlinewidth: 0, tickfont: {color: colors.muted},
    ...(wide && {tickvals: marks, ticktext: marks.map((decade) => `10<sup>${decade}</sup>`)}),
  };
}

/**
 * @param {number[]} values
 * @returns {object} where cells are numbered, some of them say their value
 */
function ticks(values) {
  const each = Math.max(1, Math.ceil((values.length - 1) / (MOST_TICKS - 1)));
  const places = values.map((_, place) => place).filter((place) => place % each === 0);
  return {
    tickmode: 'array', tickvals: places, ticktext: places.map((place) => written(Number(values[place].toPrecision(3)))),
    range: [-0.5, values.length - 0.5],
  };
}

/**
 * Round numbers along a logarithmic axis: those of every decade, more where there are few decades.
 *
 * @param {number[]} values
 */
function decades(values) {
  const [low, high] = [values[0], values[values.length - 1]];
  const marks = high > WIDE * low ? [1] : [1, 2, 5];
  const first = Math.floor(Math.log10(low));
  const count = Math.ceil(Math.log10(high)) - first + 1;
  const each = high > WIDE * low ? Math.ceil(count / MOST_TICKS) : 1;
  const found = Array.from({length: count}, (_, index) => first + index)
    .filter((_, index) => index % each === 0)
    .flatMap((decade) => marks.map((mark) => Number(`${mark}e${decade}`)));
  return {type: 'log', tickmode: 'array', tickvals: found, ticktext: found.map(written)};
}

/**
 * @param {number[]} values
 * @param {boolean} log
 */
function ends(values, log) {
  const [low, high] = [values[0], values[values.length - 1]].map((end) => (log ? Math.log10(end) : end));
  const room = 0.03 * (high - low);
  return [low - room, high + room];
}
