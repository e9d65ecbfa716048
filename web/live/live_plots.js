// @ts-check
/** The plots: tabs, legend, figure and toolbar over the newest telemetry. */

import {Cursors} from '../plot_view/cursors.js';
import {download, image, spectrumTable, timeTable} from '../plot_view/download.js';
import {element} from '../dom/element.js';
import {Freezes, shortTime} from '../curves/freezes.js';
import {ALL_JOINTS} from '../plot_view/joint_toggles.js';
import {liveReadings} from './readings.js';
import {LookLine} from './look_line.js';
import {holdOf, spectrumPanels, timePanels} from '../curves/panel_curves.js';
import {Canvas} from '../plots/canvas.js';
import {PlotLegend} from '../plot_view/legend.js';
import {PlotTabs} from '../dom/tab_row.js';
import {PlotToolbar} from '../plot_view/toolbar.js';
import {PlotWindow, TIME_KEYS, reportedRanges} from '../plot_view/window.js';
import {VIEWS} from './views.js';
import {recall, remember} from '../screen/remembered.js';
import {RevisionMarks} from '../plots/revision_marks.js';
import {Ring} from '../curves/ring.js';

/** @typedef {import('../api/api.js').Api} Api */
/** @typedef {import('./views.js').View} View */
/** @typedef {import('./views.js').Source} Source */

const FIRST_JOINTS = [1, 2, 3];
/** A spectrum takes longer to work out than a curve, and nobody reads it faster. */
const SPECTRUM_MS = 250;

/**
 * @param {HTMLElement} root
 * @param {Api} api
 */
export function mount(root, api) { new Plots(root, api); }

class Plots {
  #api;
  #ring = new Ring();
  #window = new PlotWindow();
  #marks = new RevisionMarks();
  /** @type {View} */ #view = VIEWS.find(({id}) => id === recall('plots.view')) ?? VIEWS[0];
  /** @type {number[]} */ #joints = rememberedJoints();
  /** @type {Set<string>} */ #hidden = new Set();
  #freezes = new Freezes();
  /** @type {string[]} */ #lanes = [];
  /** @type {number|null} */ #epoch = null;
  #restarts = 0;
  #restartsAtState = 0;

  /**
   * @param {HTMLElement} root
   * @param {Api} api
   */
  constructor(root, api) {
    this.#api = api;
    api.kept = this.#ring;
    const stage = element('div', {
      class: 'plots-stage', tabindex: 0,
      'aria-keyshortcuts': 'Shift+ArrowLeft Shift+ArrowRight Shift+ArrowUp Shift+ArrowDown Escape',
    });
    this.canvas = new Canvas(stage, () => this.#sheet(), {
      zoom: (report) => this.#zoomed(report),
      live: () => this.#follow(),
      drawn: (axis) => {
        this.cursors.place(axis);
        this.looked.place(axis);
      },
    });
    this.looked = new LookLine(stage, api, (time) => this.#look(time));
    this.cursors = new Cursors(stage, api, {
      read: (time) => liveReadings(
        this.#ring, this.#panels(), this.#freezes.now, time, holdOf(this.#api.experiment),
      ),
      changed: () => this.#show(),
    });
    this.cursors.readout.colorOf = (lane) => (
      this.#api.lanes.find(({name}) => name === lane)?.color ?? ''
    );
    this.tabs = new PlotTabs(VIEWS, stage, (id) => this.#choose(id));
    this.legend = new PlotLegend((lane) => this.#toggleLane(lane));
    this.toolbar = new PlotToolbar({
      joint: (joint) => this.#toggleJoint(joint),
      length: (seconds) => { this.#window.length = seconds; this.#follow(); },
      live: () => (this.#window.live ? this.#hold({}) : this.#follow()),
      cursors: () => this.cursors.toggle(),
      png: () => this.#saveImage('png'),
      svg: () => this.#saveImage('svg'),
      csv: () => this.#saveTable(),
    });
    stage.addEventListener('keydown', (event) => this.#keyed(event));
    root.classList.add('plots');
    root.append(
      this.tabs.element, this.legend.element, stage, this.cursors.readout.element,
      this.toolbar.element,
    );
    this.#listen();
    if (api.channels.length) this.#hello();
    this.#show();
  }

  #listen() {
    const on = (/** @type {string} */ type, /** @type {(detail: any) => void} */ act) => (
      this.#api.addEventListener(type, (event) => act(/** @type {CustomEvent} */ (event).detail))
    );
    on('hello', () => this.#hello());
    on('patch', ({revision, experiment}) => {
      this.#marks.note(revision, experiment ?? this.#api.experiment);
    });
    on('state', () => this.#state());
    on('frame', (frame) => this.#frame(frame));
    on('select', () => this.#show());
    on('show', ({tab}) => { if (VIEWS.some(({id}) => id === tab)) this.#choose(tab); });
    on('samples', (samples) => {
      this.#window.closeUp(samples);
      this.#show();
    });
    on('joint', (joint) => {
      if (this.#view.joints && this.tabs.element.checkVisibility()) this.#toggleJoint(joint);
    });
  }

  // What arrives

  #hello() {
    const lanes = this.#api.lanes.map(({name}) => name);
    const gone = this.#lanes.filter((name) => !lanes.includes(name));
    const come = lanes.filter((name) => !this.#lanes.includes(name));
    if (gone.length === 1 && come.length === 1) {
      this.#ring.rename(gone[0], come[0]);
      this.#freezes.rename(gone[0], come[0]);
    }
    this.#lanes = lanes;
    this.#ring.configure(this.#api.channels);
    this.#marks.note(this.#api.revision, this.#api.experiment);
    this.#state();
    this.#show();
  }

  #state() {
    const session = this.#api.session;
    if (!session) return;
    // Frames of the new epoch may have come first, and have emptied the ring then.
    const restarted = this.#ring.restarts !== this.#restartsAtState;
    if (this.#epoch !== null && session.epoch !== this.#epoch && !restarted) this.#ring.clear();
    this.#epoch = session.epoch;
    this.#restartsAtState = this.#ring.restarts;
    this.#noticeRestart();
    if (!this.#freezes.note(session, this.#ring)) return;
    this.#window.still = this.#freezes.lastOf(this.#lanes);
    this.#show();
  }

  /** @param {import('../api/api.js').Frame} frame */
  #frame(frame) {
    const before = this.#ring.end;
    this.#ring.append(frame);
    this.#noticeRestart();
    if (this.#window.settle(this.#ring)) this.#show();
    const unseen = this.#window.live || before === 0
      || this.#ring.timeOf(before) < this.#window.range(this.#ring)[1];
    if (unseen) this.#request();
  }

  #noticeRestart() {
    if (this.#ring.restarts === this.#restarts) return;
    this.#restarts = this.#ring.restarts;
    this.#marks.clear();
    this.#freezes.clear();
    this.canvas.forgetRanges();
    this.#window.restarted();
    this.#show();
  }

  // What the user does

  /** @param {string} id */
  #choose(id) {
    this.#view = VIEWS.find((view) => view.id === id) ?? VIEWS[0];
    remember('plots.view', this.#view.id);
    this.#window.zoomed.clear();
    this.canvas.forgetRanges();
    this.#show();
  }

  /** @param {number} joint */
  #toggleJoint(joint) {
    const shown = this.#joints.includes(joint);
    if (shown && this.#joints.length === 1) return;
    this.#joints = ALL_JOINTS.filter((each) => this.#joints.includes(each) !== (each === joint));
    remember('plots.joints', this.#joints.join(''));
    this.#window.zoomed.clear();
    this.#show();
  }

  /** @param {string} lane */
  #toggleLane(lane) {
    if (!this.#hidden.delete(lane)) this.#hidden.add(lane);
    this.#show();
  }

  #follow() {
    this.#window.follow();
    this.#show();
  }

  /** @param {{shift?: number, factor?: number}} change */
  #hold(change) {
    this.#window.move(this.#ring, change);
    this.#show();
  }

  /**
   * Bring a past moment that the 3D scene shows into sight.
   *
   * @param {number|null} time in [s]; null: the present
   */
  #look(time) {
    if (time === null) { this.#follow(); return; }
    const [from, to] = this.#window.range(this.#ring);
    if (time >= from && time <= to) return;
    const half = (to - from) / 2;
    this.#window.hold([time - half, time + half]);
    this.#show();
  }

  /** @param {object} report */
  #zoomed(report) {
    const ranges = reportedRanges(report);
    const time = this.#view.spectrum ? undefined : ranges.get('xaxis');
    if (time) ranges.delete('xaxis');
    this.#window.hold(time ?? this.#window.range(this.#ring));
    for (const [axis, range] of ranges) this.#window.zoomed.set(axis, range);
    this.#show();
  }

  /** @param {KeyboardEvent} event */
  #keyed(event) {
    const change = event.shiftKey && TIME_KEYS.get(event.key);
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (change) this.#hold(change);
    else if (event.key === 'Escape') this.#follow();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  // What is shown

  #request() { this.canvas.request({least: this.#view.spectrum ? SPECTRUM_MS : 0}); }

  /** Bring everything but the curves up to date, and ask for those. */
  #show() {
    const {lanes, selected} = this.#api;
    const view = this.#view;
    this.tabs.select(view.id);
    this.legend.show({
      lanes, selected, hidden: this.#hidden, frozen: this.#freezes.now,
      desired: this.#panels().some(({traces}) => traces.some(({role}) => role === 'desired')),
    });
    this.toolbar.show({
      joints: this.#joints, perJoint: view.joints, length: this.#window.length,
      live: this.#window.live, cursors: view.spectrum ? null : this.cursors.any,
    });
    this.#request();
  }

  /** @param {{joints?: number[], hidden?: Set<string>}} [choice] */
  #panels({joints = this.#joints, hidden = this.#hidden} = {}) {
    const {lanes, laws, experiment} = this.#api;
    const networks = new Set(laws.filter(({network}) => network).map(({name}) => name));
    return this.#view.panels({
      ring: this.#ring,
      joints,
      lanes: lanes.map(({name}) => name).filter((name) => !hidden.has(name)),
      hasNetwork: (lane) => networks.has(experiment.lanes?.[lane]?.law),
    });
  }

  /** @returns {import('../plots/canvas.js').CanvasSheet} */
  #sheet() {
    const {lanes, selected} = this.#api;
    const [ring, view, freezes] = [this.#ring, this.#view, this.#freezes.now];
    const panels = this.#panels();
    const window = this.#window.range(ring);
    const build = view.spectrum ? spectrumPanels : timePanels;
    return {
      title: view.title,
      spectrum: Boolean(view.spectrum),
      panels,
      window,
      zoomed: this.#window.zoomed,
      curves: (room) => build({...room, ring, panels, window, freezes, hold: holdOf(this.#api.experiment)}),
      message: messageFor(ring, view, panels, window, this.#window.still),
      marks: view.spectrum ? [] : this.#marks.of(ring),
      stops: view.spectrum ? [] : this.#freezes.stops.filter(({lane}) => !this.#hidden.has(lane)),
      colors: new Map(lanes.map(({name, color}) => [name, color])),
      selected,
    };
  }

  // Files

  /** @param {'png'|'svg'} format */
  async #saveImage(format) {
    download(await image(this.canvas.forFile(), format), this.#fileName(format));
  }

  #saveTable() {
    const panels = this.#panels({joints: ALL_JOINTS, hidden: new Set()});
    const build = this.#view.spectrum ? spectrumTable : timeTable;
    const window = this.#window.range(this.#ring);
    download(build(this.#ring, panels, window, this.#freezes.now), this.#fileName('csv'));
  }

  /** @param {string} ending */
  #fileName(ending) {
    const [, to] = this.#window.range(this.#ring);
    const end = this.#ring.empty ? 0 : Math.min(to, this.#ring.newest);
    return `slidetune-${this.#view.id}-${end.toFixed(2)}s.${ending}`;
  }
}

/**
 * @param {Ring} ring
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
  if (window[1] < ring.timeOf(ring.start)) return 'Nothing is kept of this time any more.';
  if (still !== null && still < ring.timeOf(ring.start)) {
    return `Every lane has stood still since ${shortTime(still)}: reset them.`;
  }
  return '';
}

/** @returns {number[]} */
function rememberedJoints() {
  const joints = ALL_JOINTS.filter((joint) => recall('plots.joints')?.includes(String(joint)));
  return joints.length ? joints : FIRST_JOINTS;
}
