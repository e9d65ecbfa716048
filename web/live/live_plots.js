// @ts-check
/** The live plots: the newest telemetry, or a window of time over the last minute. */

import {LiveSource} from './source.js';
import {LookLine} from './look_line.js';
import {PlotScreen} from '../plot_view/plot_screen.js';
import {Telemetry} from './telemetry.js';
import {WindowControls} from './window_controls.js';

/** @typedef {import('../api/api.js').Api} Api */

/**
 * @param {HTMLElement} root
 * @param {Api} api
 */
export function mount(root, api) { new LivePlots(root, api); }

class LivePlots {
  #api;
  #telemetry;
  #source;
  #window;
  #screen;

  /**
   * @param {HTMLElement} root
   * @param {Api} api
   */
  constructor(root, api) {
    this.#api = api;
    this.#telemetry = new Telemetry(api);
    api.kept = this.#telemetry.ring;
    this.#source = new LiveSource(api, this.#telemetry);
    this.#window = this.#source.window;
    const controls = new WindowControls({
      length: (seconds) => { this.#window.length = seconds; this.#screen.follow(); },
      live: () => (this.#window.live ? this.#hold(this.#window.range) : this.#screen.follow()),
    });
    this.#screen = new PlotScreen(api, this.#source, {
      shown: () => controls.show(this.#window), drawn: (axis) => looked.place(axis),
    });
    const {tabs, legend, stage, cursors, toolbar} = this.#screen;
    const looked = new LookLine(stage, api, (time) => this.#look(time));
    toolbar.afterJoints(controls.elements);
    root.classList.add('plots');
    root.append(tabs.element, legend.element, stage, cursors.readout.element, toolbar.element);
    this.#listen();
    this.#screen.show();
  }

  #listen() {
    const telemetry = this.#telemetry;
    telemetry.addEventListener('changed', () => this.#screen.show());
    telemetry.addEventListener('restarted', () => {
      this.#screen.canvas.forgetRanges();
      this.#window.restarted();
      this.#screen.show();
    });
    telemetry.addEventListener('frame', (event) => {
      this.#came(/** @type {CustomEvent} */ (event).detail);
    });
    this.#api.addEventListener('show', (event) => {
      const {tab} = /** @type {CustomEvent} */ (event).detail;
      if (this.#source.views.some(({id}) => id === tab)) this.#screen.choose(tab);
    });
    this.#api.addEventListener('samples', (event) => {
      this.#window.closeUp(/** @type {CustomEvent} */ (event).detail);
      this.#screen.show();
    });
  }

  /** @param {number} first row that is new */
  #came(first) {
    const {ring} = this.#telemetry;
    if (this.#window.settle()) this.#screen.show();
    if (this.#window.live || first === 0 || ring.timeOf(first) < this.#window.range[1]) {
      this.#screen.request();
    }
  }

  /** @param {import('../plot_view/window.js').Range} range in [s] */
  #hold(range) {
    this.#window.hold(range);
    this.#screen.show();
  }

  /**
   * Bring a past moment that the 3D scene shows into sight.
   *
   * @param {number|null} time in [s]; null: the present
   */
  #look(time) {
    if (time === null) { this.#screen.follow(); return; }
    const [from, to] = this.#window.range;
    if (time >= from && time <= to) return;
    const half = (to - from) / 2;
    this.#hold([time - half, time + half]);
  }
}
