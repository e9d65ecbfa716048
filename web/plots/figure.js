// @ts-check
/** What the plotting library is told: traces, axes and colours. */

import {GAP, MARGIN, axisNumber, colorOf, heightOfPanel, traceId} from './figure_panels.js';
import {stopTraces} from './stop_marks.js';

/** @typedef {import('../curves/panel_curves.js').DrawnPanel} DrawnPanel */
/** @typedef {import('../curves/panel_curves.js').Curve} Curve */
/** @typedef {import('../curves/y_range.js').Range} Range */
/** @typedef {{time: number, lines: string[]}} MarkText */
/**
 * @typedef {{text: string, muted: string, grid: string, zero: string, background: string,
 *   desired: string, font: string}} Theme
 */
/**
 * `legend`: with title, legend and background, for a file.
 * @typedef {{panels: DrawnPanel[], window: Range, spectrum: boolean, marks: MarkText[],
 *   stops?: import('../curves/freezes.js').Stop[],
 *   colors: Map<string, string>, selected: string, width: number, height: number,
 *   zoomed: Map<string, Range>, touch: boolean, theme: Theme, legend?: boolean, title: string}}
 *   Drawing
 */

const LEGEND_HEIGHT = 64;
const FONT_SIZE = 11;
const WRAP = 44;

/** @returns {any} the plotting library, which a plain script tag loads */
export function library() { return /** @type {any} */ (window).Plotly; }

/**
 * Colours and font of the page as it stands.
 *
 * @param {Element} element
 * @returns {Theme}
 */
export function themeOf(element) {
  const style = getComputedStyle(element);
  const color = (/** @type {string} */ name, /** @type {string} */ fallback) => (
    style.getPropertyValue(name).trim() || fallback
  );
  return {
    text: color('--text', '#191d23'),
    muted: color('--text-muted', '#59626e'),
    grid: color('--border', '#e2e5ea'),
    zero: color('--border-strong', '#c9ced6'),
    background: color('--surface', '#ffffff'),
    desired: color('--text', '#191d23'),
    good: color('--good', '#1a7a48'),
    bad: color('--danger', '#b8281f'),
    font: style.fontFamily,
  };
}

/**
 * The library reads a little markup in texts; data must not.
 *
 * @param {string} text
 */
export function plain(text) {
  return text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('>', '&gt;');
}

/**
 * @param {string} text
 * @returns {string} broken into short lines, as the library wants them
 */
function wrapped(text) {
  const lines = [''];
  for (const word of text.split(/\s+/)) {
    const line = lines[lines.length - 1];
    if (line && line.length + word.length >= WRAP) lines.push(word);
    else lines[lines.length - 1] = line ? `${line} ${word}` : word;
  }
  return lines.map(plain).join('<br>');
}

/**
 * @param {Drawing} drawing
 * @returns {import('./redraw.js').Figure}
 */
export function figure(drawing) {
  const data = drawing.panels.flatMap((panel, index) => [
    ...marksTrace(drawing, panel, index),
    ...panel.curves.map((curve) => line(drawing, panel, curve, index)),
    ...panel.curves.flatMap((curve) => cross(drawing, curve, index)),
    ...stopTraces(drawing, panel, index),
  ]);
  return {data, layout: layout(drawing)};
}

/**
 * @param {Drawing} drawing
 * @param {DrawnPanel} drawn
 * @param {Curve} curve
 * @param {number} index
 */
function line(drawing, {panel}, {trace, x, y, steps}, index) {
  const desired = trace.role === 'desired';
  const tone = trace.look?.tone;
  const own = desired ? drawing.theme.desired : colorOf(drawing, trace.lane);
  const color = tone ? drawing.theme[tone] : own;
  const {
    name = desired ? 'desired' : trace.lane, dash = desired ? '6px,4px' : 'solid', opacity = 1,
    width = desired ? 1.4 : trace.lane === drawing.selected ? 2 : 1.3, quiet = false,
  } = trace.look ?? {};
  return {
    type: 'scatter',
    mode: 'lines',
    uid: traceId(trace.role, drawing, index, trace.lane),
    name: plain(name),
    opacity,
    x,
    y,
    xaxis: 'x',
    yaxis: `y${axisNumber(index)}`,
    // The points are few already; leaving more out would cost peaks.
    line: {color, width, dash, simplify: false, shape: steps ? 'hv' : 'linear'},
    hoverinfo: quiet ? 'skip' : 'all',
    hovertemplate: `%{y:.4~g} ${panel.unit}`,
    showlegend: Boolean(drawing.legend) && index === 0,
  };
}

/**
 * @param {Drawing} drawing
 * @param {Curve} curve
 * @param {number} index
 */
function cross(drawing, curve, index) {
  if (!curve.cross) return [];
  const {lane, role} = curve.trace;
  const color = colorOf(drawing, lane);
  return [{
    type: 'scatter',
    mode: 'markers',
    uid: traceId(`cross-${role}`, drawing, index, lane),
    name: plain(lane),
    x: [curve.cross.x],
    y: [curve.cross.y],
    xaxis: 'x',
    yaxis: `y${axisNumber(index)}`,
    cliponaxis: false,
    marker: {
      symbol: 'x-thin', size: 10, color, line: {width: 2.5, color},
    },
    hovertemplate: wrapped(curve.cross.text),
    showlegend: false,
  }];
}

/**
 * Thin lines where gains took effect; their tops say what changed.
 *
 * @param {Drawing} drawing
 * @param {DrawnPanel} drawn
 * @param {number} index
 */
function marksTrace(drawing, {range}, index) {
  const {marks, theme, zoomed, window} = drawing;
  const seen = marks.filter(({time}) => time >= window[0] && time <= window[1]);
  if (!seen.length) return [];
  const [low, high] = zoomed.get(`yaxis${axisNumber(index)}`) ?? range;
  return [{
    type: 'scatter',
    mode: index ? 'lines' : 'lines+markers',
    uid: traceId('marks', drawing, index),
    name: 'changed',
    x: seen.flatMap(({time}) => [time, time, null]),
    y: seen.flatMap(() => [high, low, null]),
    text: seen.flatMap(({lines}) => Array(3).fill(lines.map(wrapped).join('<br>'))),
    xaxis: 'x',
    yaxis: `y${axisNumber(index)}`,
    cliponaxis: false,
    line: {color: theme.muted, width: 1, dash: 'dot'},
    marker: {
      symbol: 'triangle-down', color: theme.muted, opacity: 1,
      size: seen.flatMap(() => [8, 0, 0]), line: {width: 0},
    },
    hovertemplate: '%{text}',
    showlegend: false,
  }];
}

/**
 * @param {Drawing} drawing
 * @returns {{[name: string]: any}}
 */
function layout(drawing) {
  const {panels, width, height, theme, touch, legend} = drawing;
  const margin = {...MARGIN, t: MARGIN.t + (legend ? LEGEND_HEIGHT : 0)};
  return {
    width,
    height: height + (legend ? LEGEND_HEIGHT : 0),
    margin,
    title: legend ? {text: drawing.title, x: 0.02, font: {size: 14}} : undefined,
    font: {family: theme.font, size: FONT_SIZE, color: theme.muted},
    paper_bgcolor: legend ? theme.background : 'transparent',
    plot_bgcolor: 'transparent',
    showlegend: Boolean(legend),
    legend: {orientation: 'h', x: 0, y: 1.02, yanchor: 'bottom', bgcolor: 'transparent'},
    hovermode: 'x unified',
    hoverlabel: {
      bgcolor: theme.background, bordercolor: theme.zero, namelength: 28,
      font: {family: theme.font, size: FONT_SIZE, color: theme.text},
    },
    dragmode: touch ? 'pan' : 'zoom',
    xaxis: horizontal(drawing),
    ...Object.fromEntries(panels.map((panel, index) => (
      [`yaxis${axisNumber(index)}`, vertical(drawing, panel, index)]
    ))),
  };
}

/** @param {Drawing} drawing */
function horizontal({panels, window, spectrum, zoomed, theme}) {
  return {
    type: spectrum ? 'log' : 'linear',
    range: zoomed.get('xaxis') ?? window,
    anchor: `y${axisNumber(panels.length - 1)}`,
    title: {text: spectrum ? 'frequency [Hz]' : 't [s]', standoff: 4},
    unifiedhovertitle: {text: spectrum ? '%{x:.4~g} Hz' : 't = %{x:.4f} s'},
    ...axis(theme),
    exponentformat: spectrum ? 'power' : 'none',
    zeroline: false,
    showspikes: true,
    spikemode: 'across',
    spikesnap: 'hovered data',
    spikethickness: 1,
    spikedash: 'solid',
    spikecolor: theme.zero,
  };
}

/**
 * @param {Drawing} drawing
 * @param {DrawnPanel} drawn
 * @param {number} index
 */
function vertical({panels, height, spectrum, zoomed, theme, touch}, {panel, range}, index) {
  const room = height - MARGIN.t - MARGIN.b;
  const each = heightOfPanel({panels, height});
  const bottom = (panels.length - 1 - index) * (each + GAP);
  return {
    type: spectrum ? 'log' : 'linear',
    range: zoomed.get(`yaxis${axisNumber(index)}`) ?? range,
    domain: [bottom / room, Math.min(1, (bottom + each) / room)],
    title: {text: `${panel.title}<br>${panel.quantity} [${panel.unit}]`, standoff: 4},
    nticks: Math.min(9, Math.max(3, Math.floor(each / 20))),
    ...axis(theme),
    exponentformat: 'power',
    zeroline: !spectrum,
    // A finger that moves up or down scrolls the page.
    fixedrange: touch,
  };
}

/** @param {Theme} theme */
function axis(theme) {
  return {
    gridcolor: theme.grid,
    zerolinecolor: theme.zero,
    linecolor: theme.zero,
    showline: true,
    ticks: '',
    automargin: false,
  };
}
