// @ts-check
/** Where lanes left their bounds: a line in the lane's colour, and in words when. */

import {axisNumber, colorOf, heightOfPanel, traceId} from './figure_panels.js';
import {shortTime} from '../curves/freezes.js';

/** @typedef {import('./figure.js').Drawing} Drawing */
/** @typedef {import('../curves/freezes.js').Stop} Stop */

/** Pixels from one line of words to the next. */
const LINE = 15;
/** Part of the window from which on words stand on the left of their line. */
const FAR = 0.7;

/**
 * The words stand in the first panel, one below the other, so that lanes which stop together can
 * all be read.
 *
 * @param {Drawing} drawing
 * @param {import('../curves/panel_curves.js').DrawnPanel} drawn
 * @param {number} index of the panel
 * @returns {any[]} traces
 */
export function stopTraces(drawing, {range}, index) {
  const {stops = [], zoomed, window: [from, to]} = drawing;
  const seen = stops.filter(({time}) => time >= from && time <= to);
  const [low, high] = zoomed.get(`yaxis${axisNumber(index)}`) ?? range;
  const lineHeight = (LINE * (high - low)) / heightOfPanel(drawing);
  return seen.flatMap((stop, place) => {
    const line = lineOf(drawing, stop, place, index, [low, high]);
    if (index) return [line];
    const left = stop.time > from + FAR * (to - from);
    return [line, {
      ...line,
      mode: 'text',
      uid: traceId(`stopped-${place}`, drawing, index, stop.lane),
      x: [stop.time],
      y: [high - (place + 0.6) * lineHeight],
      text: left ? `${words(stop)} ` : ` ${words(stop)}`,
      textposition: left ? 'middle left' : 'middle right',
      textfont: {color: colorOf(drawing, stop.lane)},
    }];
  });
}

/**
 * @param {Drawing} drawing
 * @param {Stop} stop
 * @param {number} place among the stops in sight
 * @param {number} index of the panel
 * @param {import('../curves/y_range.js').Range} range
 */
function lineOf(drawing, {lane, time}, place, index, [low, high]) {
  return {
    type: 'scatter',
    mode: 'lines',
    uid: traceId(`stop-${place}`, drawing, index, lane),
    name: 'frozen',
    x: [time, time],
    y: [high, low],
    xaxis: 'x',
    yaxis: `y${axisNumber(index)}`,
    line: {color: colorOf(drawing, lane), width: 1, dash: '2px,3px'},
    hoverinfo: 'skip',
    showlegend: false,
  };
}

/** @param {Stop} stop */
function words({time}) { return `frozen ${shortTime(time)}`; }
