// @ts-check
/** What the telemetry says at one moment, trace by trace. */

import {valuesOf} from './trace_values.js';

/** @typedef {import('./ring.js').Ring} Ring */
/** @typedef {import('./plot_views.js').Panel} Panel */

/**
 * @param {Ring} ring
 * @param {Panel[]} panels
 * @param {Map<string, import('./panel_curves.js').Freeze>} freezes
 * @param {number} time in [s]
 * @returns {import('./cursors.js').Reading[]}
 */
export function liveReadings(ring, panels, freezes, time) {
  const row = rowNear(ring, time);
  return panels.flatMap(({title, quantity, unit, traces}) => traces.map((trace) => {
    const freeze = freezes.get(trace.lane);
    const known = row !== null && !(freeze && time > freeze.time);
    const value = known ? valuesOf(ring, trace, row, row + 1)[0] : NaN;
    return {
      lane: trace.lane, label: trace.lane || 'desired', panel: `${title} ${quantity}`, unit,
      value: Number.isFinite(value) ? value : null,
    };
  }));
}

/**
 * @param {Ring} ring
 * @param {number} time in [s]
 * @returns {number|null} the kept row nearest to a time, null where there is none
 */
function rowNear(ring, time) {
  if (ring.empty) return null;
  const row = Math.round((time - ring.timeOf(0)) / ring.dt);
  return row >= ring.start && row < ring.end ? row : null;
}
