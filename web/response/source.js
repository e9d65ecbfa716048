// @ts-check
/** What the plots of a response draw and save: it, the baselines, the one before the last change. */

import {PlotWindow} from '../plot_view/window.js';
import {isWatching} from '../api/watch_only.js';
import {responsePanels, responseReadings} from './curves.js';
import {responseTable} from './csv.js';
import {RESPONSE_VIEWS} from './views.js';

/** @typedef {import('./views.js').ResponseView} ResponseView */
/** @typedef {import('../plot_view/plot_screen.js').Choice} Choice */

const NO_HORIZON = 10;
/** Of the main thread; more than telemetry gets, because a picture comes only after each run. */
const SHARE = 0.8;

/** @implements {import('../plot_view/plot_screen.js').PlotSource} */
export class ResponseSource {
  key = 'response';
  views = RESPONSE_VIEWS;
  words = {toolbar: 'Response settings', table: 'every point of the response, all joints'};
  share = SHARE;
  window = new PlotWindow(() => [0, this.#horizon]);
  #api;
  #preview;
  #before;
  #baselines;
  #logs;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../api/preview.js').Preview} preview
   * @param {import('./before.js').ResponseBefore} before
   * @param {import('./baselines.js').Baselines} baselines
   * @param {import('../logs/logs.js').Logs} logs
   */
  constructor(api, preview, before, baselines, logs) {
    this.#api = api;
    this.#preview = preview;
    this.#before = before;
    this.#baselines = baselines;
    this.#logs = logs;
  }

  /** In [s] of what is drawn. */
  get #horizon() {
    const [pinned] = this.#baselines.pinned;
    return this.#preview.latest?.horizon ?? pinned?.response.horizon ?? NO_HORIZON;
  }

  /** @returns {Map<string, string|undefined>} also of lanes that only a baseline has */
  colors() {
    /** @type {Map<string, string|undefined>} */
    const colors = new Map(this.#api.lanes.map(({name, color}) => [name, color]));
    for (const {response} of this.#baselines.pinned) {
      for (const name of response.lanes.keys()) if (!colors.has(name)) colors.set(name, undefined);
    }
    return colors;
  }

  legend() {
    const frozen = new Map([...this.#preview.latest?.lanes ?? []].flatMap(([name, lane]) => (
      lane.frozen ? [[name, {text: lane.frozen.cause}]] : []
    )));
    return {frozen, desired: false, before: this.#before.isShown};
  }

  toggleBefore = () => { this.#before.isShown = !this.#before.isShown; };

  /**
   * @param {Choice} choice
   * @param {number} time in [s]
   */
  readings(choice, time) { return responseReadings(this.content(choice), time); }

  /**
   * @param {Choice} choice
   * @returns {import('../plot_view/plot_screen.js').SourceSheet}
   */
  sheet(choice) {
    const content = this.content(choice);
    const drawable = content.current || content.pinned.length || content.logs.length;
    return {
      title: `Response: ${choice.view.title}`,
      panels: drawable ? content.panels : [],
      curves: ({ranges}) => responsePanels(content, ranges),
      message: drawable || this.#preview.failure ? '' : waiting(),
      marks: [],
      stops: stopsOf(content),
      // The same one follows with its estimate.
      passing: content.current?.estimated === false,
    };
  }

  /**
   * @param {Choice} choice
   * @returns {import('./curves.js').ResponseSheet}
   */
  content({view, joints, hidden}) {
    return {
      panels: view.panels(joints), current: this.#preview.latest,
      before: this.#before.isShown ? this.#before.response : null,
      goals: this.#api.experiment.goals ?? {},
      pinned: this.#baselines.pinned, logs: this.#logs.drawn,
      shows: (lane) => !hidden.has(lane),
      window: this.window.range,
    };
  }

  /** @param {ResponseView} view */
  table(view) {
    const {latest} = this.#preview;
    const logs = this.#logs.drawn.map(({overlay: {response}}) => ({name: '', response}));
    return responseTable(view, [
      ...(latest ? [{name: '', response: latest}] : []), ...this.#baselines.pinned, ...logs,
    ]);
  }

  /** @param {ResponseView} view */
  fileName({id}) { return `response-${id}-rev${this.#preview.latest?.revision ?? 0}`; }
}

/**
 * @param {import('./curves.js').ResponseSheet} content
 * @returns {import('../curves/freezes.js').Stop[]} of the current response
 */
function stopsOf({current, shows}) {
  return [...current?.lanes ?? []].flatMap(([lane, {frozen}]) => (
    frozen && shows(lane) ? [{lane, time: frozen.time, text: frozen.cause}] : []
  ));
}

function waiting() {
  if (!isWatching()) return 'Computing the response …';
  return 'No response yet: it appears here as soon as the owner opens Response.';
}
