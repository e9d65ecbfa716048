// @ts-check
/** The whole response, from t = 0 over the horizon: what a gain does before time gets there. */

import {PlotScreen} from '../plot_view/plot_screen.js';
import {recall, remember} from '../screen/remembered.js';
import {BaselineList} from './baseline_list.js';
import {BoundLayer} from '../bounds/layer.js';
import {Baselines} from './baselines.js';
import {ResponseHead} from './head.js';
import {markLag} from './lag.js';
import {ResponseMetrics} from './figures.js';
import {ResponseRemarks} from './remarks.js';
import {ResponseSource} from './source.js';
import {goalWords} from '../goals/words.js';
import {isWatching} from '../api/watch_only.js';
import {LogList} from '../logs/log_list.js';
import {tellWithUndo} from '../dom/undo_notice.js';

/** @typedef {import('../api/api.js').Api} Api */
/** @typedef {import('../plot_view/plot_screen.js').Choice} Choice */
/**
 * What the tab of this view can do, where it has one.
 * @typedef {{open: () => void, mark: (news: boolean) => void}} Tab
 */

/**
 * @param {HTMLElement} root
 * @param {Api} api
 * @param {import('../page/right_panel.js').Desk & {tab?: Tab}} desk
 */
export function mount(root, api, desk) { new ResponsePlots(root, api, desk); }

class ResponsePlots {
  #api;
  #root;
  #tab;
  #preview;
  #before;
  #baselines;
  #screen;
  #head;
  #list;
  #logs;
  #logList;
  #remarks;
  #metrics;
  #bounds;
  /** @type {Choice} what the plots show */ #choice;
  #opens = recall('response.opens') === '1';
  /** Whether anybody can see it. */
  #seen = false;

  /**
   * @param {HTMLElement} root
   * @param {Api} api
   * @param {import('../page/right_panel.js').Desk & {tab?: Tab}} desk
   */
  constructor(root, api, desk) {
    this.#api = api;
    this.#root = root;
    this.#tab = desk.tab;
    this.#preview = desk.preview;
    this.#before = desk.before;
    this.#baselines = new Baselines(this.#preview);
    this.#remarks = new ResponseRemarks(api, desk);
    this.#list = new BaselineList(this.#baselines, () => this.#pin());
    this.#logs = desk.logs;
    this.#logList = new LogList(desk.logs);
    const source = new ResponseSource(api, this.#preview, this.#before, this.#baselines, desk.logs);
    this.#metrics = new ResponseMetrics((figure) => {
      api.dispatchEvent(new CustomEvent('goal', {detail: figure}));
    });
    this.#screen = new PlotScreen(api, source, {
      shown: (choice) => this.#shown(choice), drawn: (axis) => this.#bounds.place(axis),
    });
    const {tabs, legend, stage, cursors, toolbar} = this.#screen;
    this.#head = new ResponseHead(this.#preview, () => api.revision, tabs.element, {
      opens: this.#opens, open: (on) => this.#openOnDrag(on),
      scene: recall('response.scene') === '1', paths: (on) => this.#pathsInScene(on),
    });
    toolbar.element.append(this.#head.status, this.#list.element, this.#logList.element);
    root.classList.add('plots', 'response');
    const {history, tell} = desk;
    root.append(
      this.#head.element, legend.element, this.#remarks.element, stage, cursors.readout.element,
      toolbar.element, this.#metrics.element,
    );
    this.#bounds = new BoundLayer(stage, api, history, {
      sheet: () => source.content(this.#choice),
      refused: (text) => tell(text, {error: true}),
      added: (goal, horizon) => tellWithUndo(tell, history, `New goal: ${goalWords(goal, horizon)}`),
    });
    toolbar.afterJoints([this.#bounds.button]);
    this.#listen();
    this.#screen.show();
  }

  #listen() {
    const api = this.#api;
    const show = () => this.#screen.show();
    this.#preview.addEventListener('response', show);
    this.#preview.addEventListener('failed', show);
    this.#before.addEventListener('change', show);
    this.#baselines.addEventListener('change', show);
    this.#logs.addEventListener('change', show);
    api.addEventListener('hello', () => { this.#completeIfSeen(); show(); });
    api.addEventListener('patch', (event) => {
      this.#head.show();
      this.#mark();
      // A bound is seen where it is before it is judged.
      if (/** @type {CustomEvent} */ (event).detail.patch.goals) this.#screen.request();
    });
    api.addEventListener('moving', () => {
      if (api.moving && this.#opens && !this.#seen) this.#tab?.open();
    });
    markLag(this.#root, this.#preview, api);
    new ResizeObserver(() => this.#looked()).observe(this.#root);
    document.addEventListener('visibilitychange', () => this.#looked());
    if (recall('response.scene') === '1') this.#pathsInScene(true);
  }

  // Who looks

  #looked() {
    // Asked for in the middle of a drag, the page would lay everything out.
    this.#seen = !document.hidden && this.#root.checkVisibility();
    this.#preview.needed('view', this.#seen);
    this.#logs.seen = this.#seen;
    this.#completeIfSeen();
    if (this.#seen) this.#tab?.mark(false);
  }

  #completeIfSeen() {
    if (!this.#seen || isWatching()) return;
    this.#baselines.complete();
    this.#before.complete();
  }

  #mark() { if (!this.#seen) this.#tab?.mark(true); }

  // What the user does

  /** @param {boolean} on */
  #openOnDrag(on) {
    this.#opens = on;
    remember('response.opens', on ? '1' : null);
  }

  /** @param {boolean} on */
  #pathsInScene(on) {
    remember('response.scene', on ? '1' : null);
    this.#preview.scene = on;
    this.#preview.needed('scene', on);
    // Also to take them away again: the switch is only pressed where this view is seen.
    this.#preview.again();
  }

  #pin() {
    const {latest} = this.#preview;
    const experiment = latest && this.#preview.documentOf(latest);
    if (!latest || !experiment) return;
    this.#baselines.pin(experiment, latest.estimated ? latest : null);
  }

  // What is shown around the plots

  /** @param {Choice} choice */
  #shown(choice) {
    const {view, joints} = choice;
    this.#choice = choice;
    const {lanes, selected} = this.#api;
    const {latest} = this.#preview;
    this.#screen.stage.style.setProperty('--panels', String(view.panels(joints).length));
    this.#remarks.show(lanes, latest);
    this.#list.show(Boolean(latest));
    this.#logList.show();
    this.#metrics.show({
      lanes, selected, joints, current: latest, baselines: this.#baselines.list,
      logs: this.#logs.drawn,
    });
  }
}
