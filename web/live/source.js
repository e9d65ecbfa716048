// @ts-check
/** What the live plots draw and save: the telemetry within a window of time. */

import {TelemetryWindow} from './telemetry_window.js';
import {VIEWS} from './views.js';
import {liveReadings} from './readings.js';
import {shortTime} from '../curves/freezes.js';
import {spectrumTable, timeTable} from '../plot_view/download.js';
import {JOINTS} from '../api/arm.js';
import {holdOf, spectrumPanels, timePanels} from '../curves/panel_curves.js';

/** @typedef {import('./views.js').View} View */
/** @typedef {import('../plot_view/plot_screen.js').Choice} Choice */

/** @implements {import('../plot_view/plot_screen.js').PlotSource} */
export class LiveSource {
  key = 'plots';
  views = VIEWS;
  words = {toolbar: 'Plot settings', table: 'every visible sample, all joints'};
  #api;
  #telemetry;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('./telemetry.js').Telemetry} telemetry
   */
  constructor(api, telemetry) {
    this.#api = api;
    this.#telemetry = telemetry;
    this.window = new TelemetryWindow(telemetry);
  }

  colors() { return new Map(this.#api.lanes.map(({name, color}) => [name, color])); }

  /** @param {Choice} choice */
  legend(choice) {
    const traces = this.#panels(choice).flatMap((panel) => panel.traces);
    return {
      frozen: this.#telemetry.freezes.now, desired: traces.some(({role}) => role === 'desired'),
    };
  }

  /**
   * @param {Choice} choice
   * @param {number} time in [s]
   */
  readings(choice, time) {
    const {ring, freezes} = this.#telemetry;
    const hold = holdOf(this.#api.experiment);
    return liveReadings(ring, this.#panels(choice), freezes.now, time, hold);
  }

  /**
   * @param {Choice} choice
   * @returns {import('../plot_view/plot_screen.js').SourceSheet}
   */
  sheet(choice) {
    const {view, hidden} = choice;
    const {ring, freezes: {now: freezes, stops}, marks, still} = this.#telemetry;
    const panels = this.#panels(choice);
    const window = this.window.range;
    const hold = holdOf(this.#api.experiment);
    const build = view.spectrum ? spectrumPanels : timePanels;
    return {
      title: view.title,
      panels,
      curves: (room) => build({...room, ring, panels, window, freezes, hold}),
      message: messageFor(ring, view, panels, window, still),
      marks: view.spectrum ? [] : marks,
      stops: view.spectrum ? [] : stops.filter(({lane}) => !hidden.has(lane)),
    };
  }

  /** @param {Choice} choice */
  #panels({view, joints, hidden}) {
    const {lanes, laws, experiment} = this.#api;
    const networks = new Set(laws.filter(({network}) => network).map(({name}) => name));
    return view.panels({
      ring: this.#telemetry.ring,
      joints,
      lanes: lanes.map(({name}) => name).filter((name) => !hidden.has(name)),
      hasNetwork: (lane) => networks.has(experiment.lanes?.[lane]?.law),
    });
  }

  /** @param {View} view */
  table(view) {
    const {ring, freezes} = this.#telemetry;
    const panels = this.#panels({view, joints: JOINTS, hidden: new Set()});
    const build = view.spectrum ? spectrumTable : timeTable;
    return build(ring, panels, this.window.range, freezes.now);
  }

  /** @param {View} view */
  fileName({id}) {
    const {ring} = this.#telemetry;
    const end = ring.empty ? 0 : Math.min(this.window.range[1], ring.newest);
    return `${id}-${end.toFixed(2)}s`;
  }
}

/**
 * @param {import('../curves/ring.js').Ring} ring
 * @param {View} view
 * @param {import('./views.js').Panel[]} panels
 * @param {[number, number]} window
 * @param {number|null} still when the last lane stopped in [s]
 * @returns {string} why there is nothing to see, or nothing
 */
function messageFor(ring, view, panels, window, still) {
  if (!panels.length) return view.empty ?? 'Nothing to show.';
  if (ring.empty) return 'No data yet. Press play or step.';
  if (panels.every(({traces}) => !traces.length)) return 'Every lane is hidden.';
  if (window[1] < ring.timeOf(ring.start)) return 'No data is kept for this time any more.';
  if (still !== null && still < ring.timeOf(ring.start)) {
    return `Every lane has been frozen since ${shortTime(still)}: reset them.`;
  }
  return '';
}
