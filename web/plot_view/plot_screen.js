// @ts-check
/** Plots with all that stands around them: tabs, legend, cursors, toolbar, keys, files. */

import {JOINTS} from '../api/arm.js';
import {Canvas} from '../plots/canvas.js';
import {Cursors} from './cursors.js';
import {PlotLegend} from './legend.js';
import {PlotTabs} from '../dom/tab_row.js';
import {PlotToolbar} from './toolbar.js';
import {TIME_KEYS, reportedRanges} from './window.js';
import {download, image} from './download.js';
import {element} from '../dom/element.js';
import {recall, remember} from '../screen/remembered.js';

/** @typedef {import('../plots/canvas.js').CanvasSheet} CanvasSheet */
/**
 * `joints`: whether it has a panel a joint; `spectrum`: whether it goes over frequency, not time.
 * @typedef {{id: string, title: string, joints: boolean, spectrum?: boolean}} View
 */
/**
 * What the user wants to see.
 * @typedef {{view: any, joints: number[], hidden: Set<string>}} Choice
 */
/** @typedef {Omit<CanvasSheet, 'spectrum'|'window'|'zoomed'|'colors'|'selected'>} SourceSheet */
/**
 * Where the curves come from.
 *
 * @typedef {object} PlotSource
 * @property {string} key under which this browser remembers what is chosen
 * @property {View[]} views
 * @property {import('./window.js').PlotWindow} window
 * @property {{toolbar: string, table: string}} words the toolbar's name, and what a CSV holds
 * @property {number} [share] of the main thread that drawing may take
 * @property {(choice: Choice) => SourceSheet} sheet what to draw now
 * @property {(choice: Choice, time: number) => import('./cursors.js').Reading[]} readings
 * @property {() => Map<string, string|undefined>} colors of every lane that has a curve
 * @property {(choice: Choice) => {desired: boolean, frozen: Map<string, {text: string}>,
 *   before?: boolean}} legend beside the lanes, see {@link PlotLegend}
 * @property {() => void} [toggleBefore] the curves before the last change
 * @property {(view: any) => Blob} table every value, as CSV
 * @property {(view: any) => string} fileName without its ending
 */

const FIRST_JOINTS = JOINTS.slice(0, 3);
/** A spectrum takes longer to work out than a curve, and nobody reads it faster. */
const SPECTRUM_MS = 250;

/** The plots of one source. Its parts are for the view to arrange. */
export class PlotScreen {
  stage = element('div', {
    class: 'plots-stage', tabindex: 0,
    'aria-keyshortcuts': 'Shift+ArrowLeft Shift+ArrowRight Shift+ArrowUp Shift+ArrowDown Escape',
    on: {keydown: (event) => this.#keyed(event)},
  });

  #api;
  #source;
  #shown;
  /** @type {View} */ #view;
  /** @type {number[]} */ #joints;
  /** @type {Set<string>} */ #hidden = new Set();

  /**
   * @param {import('../api/api.js').Api} api
   * @param {PlotSource} source
   * @param {{shown: (choice: Choice) => void,
   *   drawn?: (axis: import('../plots/canvas.js').TimeAxis|null) => void}} on `shown`: bring what
   *   else there is up to date; `drawn`: where the times lie now, null where there are none
   */
  constructor(api, source, {shown, drawn = () => {}}) {
    this.#api = api;
    this.#source = source;
    this.#shown = shown;
    this.#view = this.#viewOf(recall(`${source.key}.view`));
    this.#joints = rememberedJoints(source.key);
    this.tabs = new PlotTabs(source.views, this.stage, (id) => this.choose(id));
    this.legend = new PlotLegend((lane) => this.#toggleLane(lane), source.toggleBefore);
    this.canvas = new Canvas(this.stage, () => this.#sheet(), {
      zoom: (report) => this.#zoomed(report),
      live: () => this.follow(),
      drawn: (axis) => {
        this.cursors.place(axis);
        drawn(axis);
      },
    }, source.share);
    this.cursors = new Cursors(this.stage, api, {
      read: (time) => source.readings(this.#choice, time), changed: () => this.show(),
    });
    this.cursors.readout.colorOf = (lane) => source.colors().get(lane) ?? '';
    this.toolbar = new PlotToolbar(source.words, {
      joint: (joint) => this.#toggleJoint(joint),
      cursors: () => this.cursors.toggle(),
      png: () => this.#saveImage('png'),
      svg: () => this.#saveImage('svg'),
      csv: () => this.#saveTable(),
    });
    api.addEventListener('select', () => this.show());
    api.addEventListener('joint', (event) => {
      if (this.tabs.element.checkVisibility()) {
        this.#toggleJoint(/** @type {CustomEvent} */ (event).detail);
      }
    });
  }

  /** Bring everything but the curves up to date, and ask for those. */
  show() {
    const {lanes, selected} = this.#api;
    const choice = this.#choice;
    const {view, joints, hidden} = choice;
    this.tabs.select(view.id);
    this.legend.show({lanes, selected, hidden, ...this.#source.legend(choice)});
    this.toolbar.show({
      joints, perJoint: view.joints, cursors: view.spectrum ? null : this.cursors.any,
    });
    this.#shown(choice);
    this.request();
  }

  /** Ask for the curves alone. */
  request() { this.canvas.request({least: this.#view.spectrum ? SPECTRUM_MS : 0}); }

  /** @param {string} id of the view to show */
  choose(id) {
    this.#view = this.#viewOf(id);
    remember(`${this.#source.key}.view`, this.#view.id);
    this.#source.window.zoomed.clear();
    this.canvas.forgetRanges();
    this.show();
  }

  /** Hold no time and no zoom any more. */
  follow() {
    this.#source.window.follow();
    this.show();
  }

  /** @returns {Choice} */
  get #choice() { return {view: this.#view, joints: this.#joints, hidden: this.#hidden}; }

  /** @param {string|null} id */
  #viewOf(id) {
    const {views} = this.#source;
    return views.find((view) => view.id === id) ?? views[0];
  }

  /** @returns {CanvasSheet} */
  #sheet() {
    const {window} = this.#source;
    return {
      ...this.#source.sheet(this.#choice),
      spectrum: Boolean(this.#view.spectrum),
      window: window.range,
      zoomed: window.zoomed,
      colors: this.#source.colors(),
      selected: this.#api.selected,
    };
  }

  // What the user does

  /** @param {number} joint */
  #toggleJoint(joint) {
    if (!this.#view.joints) return;
    const shown = this.#joints.includes(joint);
    if (shown && this.#joints.length === 1) return;
    this.#joints = JOINTS.filter((each) => this.#joints.includes(each) !== (each === joint));
    remember(`${this.#source.key}.joints`, this.#joints.join(''));
    this.#source.window.zoomed.clear();
    this.show();
  }

  /** @param {string} lane */
  #toggleLane(lane) {
    if (!this.#hidden.delete(lane)) this.#hidden.add(lane);
    this.show();
  }

  /** @param {object} report */
  #zoomed(report) {
    const {window} = this.#source;
    const ranges = reportedRanges(report);
    const time = this.#view.spectrum ? undefined : ranges.get('xaxis');
    if (time) ranges.delete('xaxis');
    window.hold(time ?? window.range);
    for (const [axis, range] of ranges) window.zoomed.set(axis, range);
    this.show();
  }

  /** @param {KeyboardEvent} event */
  #keyed(event) {
    const change = event.shiftKey && TIME_KEYS.get(event.key);
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (!change && event.key !== 'Escape') return;
    if (change) this.#source.window.move(change);
    else this.#source.window.follow();
    this.show();
    event.preventDefault();
    event.stopPropagation();
  }

  // Files

  /** @param {'png'|'svg'} format */
  async #saveImage(format) {
    // Time goes on while the image is made.
    const name = this.#fileName(format);
    download(await image(this.canvas.forFile(), format), name);
  }

  #saveTable() { download(this.#source.table(this.#view), this.#fileName('csv')); }

  /** @param {string} ending */
  #fileName(ending) { return `slidetune-${this.#source.fileName(this.#view)}.${ending}`; }
}

/**
 * @param {string} key
 * @returns {number[]}
 */
function rememberedJoints(key) {
  const joints = JOINTS.filter((joint) => recall(`${key}.joints`)?.includes(String(joint)));
  return joints.length ? joints : FIRST_JOINTS;
}
