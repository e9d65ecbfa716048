// @ts-check
/** What the telemetry says at one moment, trace by trace. */

import {isSampledEvery} from '../curves/panel_curves.js';
import {valuesOf} from '../curves/trace_values.js';

/** @typedef {import('../curves/ring.js').Ring} Ring */
/** @typedef {import('./views.js').Panel} Panel */

/**
 * @param {Ring} ring
 * @param {Panel[]} panels
 * @param {Map<string, import('../curves/panel_curves.js').Freeze>} freezes
 * @param {number} time in [s]
 * @param {number} hold for so long in [s] a torque is held, 0 where nothing is sampled
 * @returns {import('../plot_view/cursors.js').Reading[]}
 */
export function liveReadings(ring, panels, freezes, time, hold) {
  const row = rowNear(ring, time);
  // What is held stays as it was at the sample before.
  const before = rowNear(ring, time, Math.floor);
  return panels.flatMap(({title, quantity, unit, traces}) => traces.map((trace) => {
    const freeze = freezes.get(trace.lane);
    const at = trace.held && isSampledEvery(hold, ring.dt) ? before : row;
    const known = at !== null && !(freeze && time > freeze.time);
    const value = known ? valuesOf(ring, trace, at, at + 1)[0] : NaN;
    return {
      lane: trace.lane, label: trace.lane || 'desired', panel: `${title} ${quantity}`, unit,
      value: Number.isFinite(value) ? value : null,
    };
  }));
}

/**
 * @param {Ring} ring
 * @param {number} time in [s]
 * @param {(row: number) => number} [whole] to the nearest row, or to the one before
 * @returns {number|null} the kept row nearest to a time, null where there is none
 */
function rowNear(ring, time, whole = Math.round) {
  if (ring.empty) return null;
  const row = whole((time - ring.timeOf(0)) / ring.dt + 1e-6);
  return row >= ring.start && row < ring.end ? row : null;
}
