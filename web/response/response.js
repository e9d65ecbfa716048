// @ts-check
/** The whole response, from t = 0 over the horizon: what a gain does before time gets there. */

import {Cursors} from '../plot_view/cursors.js';
import {download, image} from '../plot_view/download.js';
import {element} from '../dom/element.js';
import {ALL_JOINTS, JointToggles} from '../plot_view/joint_toggles.js';
import {Canvas} from '../plots/canvas.js';
import {PlotLegend} from '../plot_view/legend.js';
import {PlotTabs} from '../dom/tab_row.js';
import {cursorsButton, downloadButton} from '../plot_view/toolbar.js';
import {TIME_KEYS, moved, reportedRanges} from '../plot_view/window.js';
import {recall, remember} from '../screen/remembered.js';
import {BaselineList} from './baseline_list.js';
import {Baselines} from './baselines.js';
import {responsePanels, responseReadings} from './curves.js';
import {ResponseHead} from './head.js';
import {markLag} from './lag.js';
import {ResponseMetrics} from './figures.js';
import {ResponseRemarks} from './remarks.js';
import {responseTable} from './csv.js';
import {RESPONSE_VIEWS} from './views.js';
import {isWatching} from '../api/watch_only.js';

/** @typedef {import('../api/api.js').Api} Api */
/** @typedef {import('../curves/y_range.js').Range} Range */
/**
 * What the tab of this view can do, where it has one.
 * @typedef {{open: () => void, mark: (news: boolean) => void}} Tab
 */

const FIRST_JOINTS = [1, 2, 3];
const NO_HORIZON = 10;
/** Of the main thread; more than telemetry gets, because a picture comes only after each run. */
const SHARE = 0.65;

/**
 * @param {HTMLElement} root
 * @param {Api} api
 * @param {import('../page/right_panel.js').Desk & {tab?: Tab}} desk
 */
export function mount(root, api, desk) { new ResponseScreen(root, api, desk); }

class ResponseScreen {
  #api;
  #root;
  #tab;
  #preview;
  #before;
  #baselines;
  #view = RESPONSE_VIEWS.find(({id}) => id === recall('response.view')) ?? RESPONSE_VIEWS[0];
  /** @type {number[]} */ #joints = rememberedJoints();
  /** @type {Set<string>} */ #hidden = new Set();
  /** @type {Range|null} Seconds that the user chose to see. */ #held = null;
  /** @type {Map<string, Range>} */ #zoomed = new Map();
  #opens = recall('response.opens') === '1';
  #metrics = new ResponseMetrics();
  #remarks;
  #jointToggles = new JointToggles((joint) => this.#toggleJoint(joint));

  /**
   * @param {HTMLElement} root
   * @param {Api} api
   * @param {import('../page/right_panel.js').Desk & {tab?: Tab}} desk
   */
  constructor(root, api, desk) {
    this.#api = api;
    this.#root = root;
    this.#tab = desk.tab;
    this.#remarks = new ResponseRemarks(api, desk);
    this.#preview = desk.preview;
    this.#before = desk.before;
    this.#baselines = new Baselines(this.#preview);
    this.stage = element('div', {
      class: 'plots-stage', tabindex: 0,
      'aria-keyshortcuts': 'Shift+ArrowLeft Shift+ArrowRight Shift+ArrowUp Shift+ArrowDown Escape',
      on: {keydown: (event) => this.#keyed(event)},
    });
    this.#build();
    this.#listen();
    this.#show();
  }

  #build() {
    const api = this.#api;
    this.tabs = new PlotTabs(RESPONSE_VIEWS, this.stage, (id) => this.#choose(id));
    this.head = new ResponseHead(this.#preview, () => api.revision, this.tabs.element, {
      opens: this.#opens, open: (on) => this.#openOnDrag(on),
      scene: recall('response.scene') === '1', paths: (on) => this.#pathsInScene(on),
    });
    this.legend = new PlotLegend((lane) => this.#toggleLane(lane), () => {
      this.#before.isShown = !this.#before.isShown;
    });
    this.list = new BaselineList(this.#baselines, () => this.#pin());
    this.canvas = new Canvas(this.stage, () => this.#sheet(), {
      zoom: (report) => this.#zoom(report),
      live: () => this.#zoomOut(),
      drawn: (axis) => this.cursors.place(axis),
    }, SHARE);
    this.cursors = new Cursors(this.stage, api, {
      read: (time) => responseReadings(this.#content(), time), changed: () => this.#show(),
    });
    this.cursors.readout.colorOf = (lane) => this.#colors().get(lane) ?? '';
    this.cursorsButton = cursorsButton(() => this.cursors.toggle());
    const toolbar = element(
      'div', {class: 'plots-toolbar', role: 'group', 'aria-label': 'Response settings'},
      this.#jointToggles.element, this.cursorsButton, downloadButton({
        png: () => this.#saveImage('png'),
        svg: () => this.#saveImage('svg'),
        csv: () => this.#saveTable(),
      }, 'every point of the response, all joints'),
      this.head.status, this.list.element,
    );
    this.#root.classList.add('plots', 'response');
    this.#root.append(
      this.head.element, this.legend.element, this.#remarks.element, this.stage,
      this.cursors.readout.element, toolbar, this.#metrics.element,
    );
  }

  #listen() {
    const api = this.#api;
    this.#preview.addEventListener('response', () => this.#show());
    this.#preview.addEventListener('failed', () => this.#show());
    this.#before.addEventListener('change', () => this.#show());
    this.#baselines.addEventListener('change', () => this.#show());
    api.addEventListener('hello', () => { this.#completeIfSeen(); this.#show(); });
    api.addEventListener('select', () => this.#show());
    api.addEventListener('patch', () => { this.head.show(); this.#mark(); });
    api.addEventListener('moving', () => {
      if (api.moving && this.#opens && !this.#seen) this.#tab?.open();
    });
    api.addEventListener('joint', (event) => {
      if (this.#seen) this.#toggleJoint(/** @type {CustomEvent} */ (event).detail);
    });
    markLag(this.#root, this.#preview, api);
    new ResizeObserver(() => this.#looked()).observe(this.#root);
    document.addEventListener('visibilitychange', () => this.#looked());
    if (recall('response.scene') === '1') this.#pathsInScene(true);
  }

  // Who looks

  /** Whether anybody can see it. */
  get #seen() {
    // Asked for its size in the middle of a drag, the page would lay everything out.
    return !document.hidden && this.#root.checkVisibility();
  }

  #looked() {
    this.#preview.needed('view', this.#seen);
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

  /** @param {string} id */
  #choose(id) {
    this.#view = RESPONSE_VIEWS.find((view) => view.id === id) ?? RESPONSE_VIEWS[0];
    remember('response.view', this.#view.id);
    this.#zoomed.clear();
    this.canvas.forgetRanges();
    this.#show();
  }

  /** @param {number} joint */
  #toggleJoint(joint) {
    if (!this.#view.joints) return;
    const shown = this.#joints.includes(joint);
    if (shown && this.#joints.length === 1) return;
    this.#joints = ALL_JOINTS.filter((each) => this.#joints.includes(each) !== (each === joint));
    remember('response.joints', this.#joints.join(''));
    this.#zoomed.clear();
    this.#show();
  }

  /** @param {string} lane */
  #toggleLane(lane) {
    if (!this.#hidden.delete(lane)) this.#hidden.add(lane);
    this.#show();
  }

  #pin() {
    const {latest} = this.#preview;
    const experiment = latest && this.#preview.documentOf(latest);
    if (!latest || !experiment) return;
    this.#baselines.pin(experiment, latest.quick ? null : latest);
  }

  /** @param {object} report */
  #zoom(report) {
    const ranges = reportedRanges(report);
    this.#held = ranges.get('xaxis') ?? this.#window();
    ranges.delete('xaxis');
    for (const [axis, range] of ranges) this.#zoomed.set(axis, range);
    this.#show();
  }

  #zoomOut() {
    this.#held = null;
    this.#zoomed.clear();
    this.#show();
  }

  /** @param {KeyboardEvent} event */
  #keyed(event) {
    const change = event.shiftKey && TIME_KEYS.get(event.key);
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (!change && event.key !== 'Escape') return;
    if (change) this.#held = moved(this.#window(), change);
    else this.#zoomOut();
    this.#show();
    event.preventDefault();
    event.stopPropagation();
  }

  // What is shown

  /** @returns {Range} */
  #window() {
    const horizons = this.#baselines.pinned.map(({response}) => response.horizon);
    return this.#held ?? [0, this.#preview.latest?.horizon ?? horizons[0] ?? NO_HORIZON];
  }

  /** @returns {import('./curves.js').ResponseSheet} */
  #content() {
    return {
      panels: this.#view.panels(this.#joints), current: this.#preview.latest,
      before: this.#before.isShown ? this.#before.response : null,
      pinned: this.#baselines.pinned, shows: (lane) => !this.#hidden.has(lane),
      window: this.#window(),
    };
  }

  /** @returns {Map<string, string|undefined>} also lanes that only a baseline has */
  #colors() {
    /** @type {Map<string, string|undefined>} */
    const colors = new Map(this.#api.lanes.map(({name, color}) => [name, color]));
    for (const {response} of this.#baselines.pinned) {
      for (const name of response.lanes.keys()) if (!colors.has(name)) colors.set(name, undefined);
    }
    return colors;
  }

  /** @returns {import('../plots/canvas.js').CanvasSheet} */
  #sheet() {
    const content = this.#content();
    const drawable = content.current || content.pinned.length;
    return {
      title: `Response: ${this.#view.title}`,
      spectrum: false,
      panels: drawable ? content.panels : [],
      window: content.window,
      zoomed: this.#zoomed,
      curves: ({ranges}) => responsePanels(content, ranges),
      message: drawable || this.#preview.failure ? '' : waiting(),
      marks: [],
      stops: stopsOf(content),
      colors: this.#colors(),
      selected: this.#api.selected,
      // An exact one follows every quick one.
      passing: content.current?.quick,
    };
  }

  #show() {
    const {lanes, selected} = this.#api;
    const {latest} = this.#preview;
    const frozen = new Map([...latest?.lanes ?? []].flatMap(([name, lane]) => (
      lane.frozen ? [[name, {text: lane.frozen.cause}]] : []
    )));
    this.tabs.select(this.#view.id);
    this.stage.style.setProperty('--panels', String(this.#view.panels(this.#joints).length));
    this.legend.show({
      lanes, selected, hidden: this.#hidden, frozen, desired: false, before: this.#before.isShown,
    });
    this.#remarks.show(lanes, latest);
    this.list.show(Boolean(latest));
    this.#jointToggles.show(this.#joints, this.#view.joints);
    this.cursorsButton.setAttribute('aria-pressed', String(this.cursors.any));
    this.#metrics.show({
      lanes, selected, joints: this.#joints, current: latest, baselines: this.#baselines.list,
    });
    this.canvas.request();
  }

  // Files

  /** @param {'png'|'svg'} format */
  async #saveImage(format) {
    download(await image(this.canvas.forFile(), format), this.#fileName(format));
  }

  #saveTable() {
    const {latest} = this.#preview;
    const responses = [...(latest ? [{name: '', response: latest}] : []), ...this.#baselines.pinned];
    download(responseTable(this.#view, responses), this.#fileName('csv'));
  }

  /** @param {string} ending */
  #fileName(ending) {
    return `slidetune-response-${this.#view.id}-rev${this.#preview.latest?.revision ?? 0}.${ending}`;
  }
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
  return 'No response yet: as soon as the owner opens Response, it is here as well.';
}

/** @returns {number[]} */
function rememberedJoints() {
  const joints = ALL_JOINTS.filter((joint) => recall('response.joints')?.includes(String(joint)));
  return joints.length ? joints : FIRST_JOINTS;
}
