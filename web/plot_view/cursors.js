// @ts-check
/** Two vertical lines, A and B, to read times and values at; over the plots of any view. */

import {CursorReadout} from './cursor_readout.js';
import {element} from '../dom/element.js';
import {isTyping} from '../screen/keys.js';

/** @typedef {import('../plots/canvas.js').TimeAxis} TimeAxis */
/** @typedef {'A'|'B'} Name */
/**
 * What one trace says at a moment; `value` is null where it says nothing.
 * @typedef {{lane: string, label: string, panel: string, unit: string, value: number|null}}
 *   Reading
 */

/** @type {Name[]} */
const NAMES = ['A', 'B'];
/** Without a pointer over the plots, two cursors stand a little apart. */
const PLACES = {A: 0.4, B: 0.6};
/** Pixels that an arrow key moves a cursor. */
const STEP = 2;
const WIDE_STEP = 20;
const DIGITS = 4;

/** One view's cursors and what they read. */
export class Cursors {
  /** Stands below the plots while there are cursors. */
  readout = new CursorReadout(() => this.clear());

  #stage;
  #read;
  #changed;
  #overlay = element('div', {class: 'cursors'});
  /** @type {Map<Name, number>} in [s] */ #times = new Map();
  /** @type {Map<Name, HTMLElement>} */ #lines;
  /** @type {TimeAxis|null} */ #axis = null;
  /** @type {number|null} where the pointer is over the stage */ #pointer = null;

  /**
   * @param {HTMLElement} stage
   * @param {import('../api/api.js').Api} api
   * @param {{read: (time: number) => Reading[], changed: () => void}} on `read`: all visible
   *   traces, in the same order at every time; `changed`: cursors came or went
   */
  constructor(stage, api, {read, changed}) {
    this.#stage = stage;
    this.#read = read;
    this.#changed = changed;
    this.#lines = new Map(NAMES.map((name) => [name, this.#line(name)]));
    this.#overlay.append(...this.#lines.values());
    stage.append(this.#overlay);
    stage.addEventListener('pointermove', ({clientX}) => { this.#pointer = clientX; });
    stage.addEventListener('pointerleave', () => { this.#pointer = null; });
    stage.addEventListener('keydown', (event) => this.#escaped(event), true);
    addEventListener('keydown', (event) => this.#escaped(event));
    api.addEventListener('cursor', (event) => {
      this.set(/** @type {CustomEvent} */ (event).detail);
    });
    this.show();
  }

  /** Whether there is any. */
  get any() { return this.#times.size > 0; }

  /**
   * Follow a redraw of the plots.
   *
   * @param {TimeAxis|null} axis null where no time can be read
   */
  place(axis) {
    this.#axis = axis;
    this.show();
  }

  /**
   * Set a cursor where the pointer is, or else near the middle; only in a view that is seen.
   *
   * @param {Name} name
   */
  set(name) {
    if (!this.#axis || !this.#stage.checkVisibility()) return;
    const {left, width} = this.#axis;
    const along = this.#pointer === null ? PLACES[name]
      : (this.#pointer - this.#stage.getBoundingClientRect().left - left) / width;
    this.#move(name, along >= 0 && along <= 1 ? along : PLACES[name]);
    this.#lines.get(name)?.focus({preventScroll: true});
  }

  /** Set both, or remove them. */
  toggle() {
    if (this.any) this.clear();
    else for (const name of NAMES) this.set(name);
  }

  /** Remove both. */
  clear() {
    const focused = this.#overlay.contains(document.activeElement);
    this.#times.clear();
    this.show();
    this.#changed();
    if (focused) this.#stage.focus({preventScroll: true});
  }

  /** Bring lines and numbers up to date. */
  show() {
    for (const name of NAMES) this.#showLine(name);
    const axis = this.#axis;
    this.#overlay.style.height = `${axis?.height ?? 0}px`;
    const columns = new Map([...this.#times].map(([name, time]) => [
      name, {time, readings: axis ? this.#read(time) : []},
    ]));
    this.readout.show(columns.get('A') ?? null, columns.get('B') ?? null);
  }

  /** @param {Name} name */
  #showLine(name) {
    const line = /** @type {HTMLElement} */ (this.#lines.get(name));
    const time = this.#times.get(name);
    const axis = this.#axis;
    const along = axis && time !== undefined ? fraction(time, axis) : -1;
    line.hidden = !(along >= 0 && along <= 1);
    if (!axis || time === undefined || line.hidden) return;
    // Whole pixels: a line between two is a grey blur.
    line.style.transform = `translateX(${Math.round(axis.left + along * axis.width)}px)`;
    const [from, to] = axis.window;
    line.setAttribute('aria-valuemin', from.toFixed(DIGITS));
    line.setAttribute('aria-valuemax', to.toFixed(DIGITS));
    line.setAttribute('aria-valuenow', time.toFixed(DIGITS));
    line.setAttribute('aria-valuetext', `${time.toFixed(DIGITS)} s`);
  }

  /**
   * @param {Name} name
   * @param {number} along the axis, 0 to 1
   */
  #move(name, along) {
    if (!this.#axis) return;
    const [from, to] = this.#axis.window;
    const came = !this.#times.has(name);
    this.#times.set(name, from + Math.min(Math.max(along, 0), 1) * (to - from));
    this.show();
    if (came) this.#changed();
  }

  /** @param {Name} name */
  #line(name) {
    const line = element('div', {
      class: 'cursor', role: 'slider', tabindex: 0, hidden: true, 'aria-label': `Cursor ${name}`,
      'aria-orientation': 'horizontal', title: `Cursor ${name}: drag it, or use the arrow keys`,
      on: {
        keydown: (event) => this.#keyed(name, event),
        pointerdown: (event) => this.#grasped(name, event),
      },
    }, element('span', {class: 'cursor-name', 'aria-hidden': 'true'}, name));
    return line;
  }

  /**
   * @param {Name} name
   * @param {PointerEvent} start
   */
  #grasped(name, start) {
    if (start.button !== 0) return;
    start.preventDefault();
    const line = /** @type {HTMLElement} */ (this.#lines.get(name));
    line.focus({preventScroll: true});
    line.setPointerCapture(start.pointerId);
    const moved = ({clientX}) => {
      if (!this.#axis) return;
      const {left, width} = this.#axis;
      this.#move(name, (clientX - this.#stage.getBoundingClientRect().left - left) / width);
    };
    line.addEventListener('pointermove', moved);
    line.addEventListener('lostpointercapture', () => {
      line.removeEventListener('pointermove', moved);
    }, {once: true});
  }

  /**
   * @param {Name} name
   * @param {KeyboardEvent} event
   */
  #keyed(name, event) {
    const time = this.#times.get(name);
    if (!this.#axis || time === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = (event.shiftKey ? WIDE_STEP : STEP) / this.#axis.width;
    const here = fraction(time, this.#axis);
    const to = new Map([
      ['ArrowLeft', here - step], ['ArrowRight', here + step],
      ['ArrowDown', here - step], ['ArrowUp', here + step], ['Home', 0], ['End', 1],
    ]).get(event.key);
    if (to === undefined) return;
    event.preventDefault();
    // The plots and the page have other uses for arrows.
    event.stopPropagation();
    this.#move(name, to);
  }

  /**
   * In the plots Escape has another use when there are no cursors.
   *
   * @param {KeyboardEvent} event
   */
  #escaped(event) {
    if (event.key !== 'Escape' || event.defaultPrevented || !this.any) return;
    if (isTyping(event.target) || document.querySelector('dialog[open], :popover-open')) return;
    if (!this.#stage.checkVisibility()) return;
    event.preventDefault();
    event.stopPropagation();
    this.clear();
  }
}

/**
 * @param {number} time in [s]
 * @param {TimeAxis} axis
 */
function fraction(time, {window: [from, to]}) { return (time - from) / (to - from); }
