// @ts-check
/**
 * Every searched gain beside the score, one line a trial; what is brushed stays. On a canvas of its
 * own: the library's parallel coordinates compile code at run time, which the page's content policy
 * forbids.
 */

import {gainText} from './gain_names.js';
import {element} from '../dom/element.js';
import {drawLines, linesAt} from './parallel_lines.js';
import {ParallelAxis} from './parallel_axes.js';
import {saveImageButton} from '../plot_view/save_image.js';
import {PlotFrame, penOf} from './plot_frame.js';
import {written} from '../fields/quantity.js';
import {heightHere} from '../screen/low_screen.js';

/** @typedef {import('./plot_frame.js').Room} Room */
/** @typedef {import('./parallel_axes.js').Brush} Brush */
/** @typedef {import('./trials.js').Study} Study */
/** @typedef {import('./trials.js').Trial} Trial */
/** @typedef {{left: number, gap: number, top: number, height: number}} Box of the axes, in pixels */

const HEIGHT = heightHere(290, 185);
const MARGIN = {l: 40, r: 24, t: 30, b: 14};
/** Narrower than this in pixels the axes' numbers run into each other. */
const LEAST_GAP = 56;
/** A hand that moves no more than this has pressed, not dragged; in pixels. */
const STILL = 4;
const STRIP = 28;

/** Draws parallel coordinates; tells what is pointed at, pressed, and left by the brushes. */
export class Parallel {
  element;
  /** @type {Set<number>|null} trials within all brushes; null where nothing is brushed */ within = null;
  #frame = new PlotFrame(HEIGHT, (room) => this.#draw(room));
  #canvas = element('canvas', {class: 'search-points', 'aria-hidden': 'true'});
  #strips = element('div', {class: 'search-strips'});
  #words = element('p', {class: 'search-note', role: 'status'});
  #clear = element('button', {
    class: 'button small', type: 'button', hidden: true, on: {click: () => this.#brush(null)},
  }, 'Clear the brushes');
  #names;
  #on;
  /** @type {Study|null} */ #study = null;
  /** @type {Trial[]} the worst first, so that the best is drawn above it */ #trials = [];
  #left = 0;
  #kept = '';
  /** @type {ParallelAxis[]} the score first */ #axes = [];
  /** @type {Box|null} */ #box = null;
  /** @type {Map<string, Brush>} by the axis */ #brushes = new Map();
  /** @type {[string, number][]} */ #marked = [];

  /**
   * @param {import('../fields/field_names.js').FieldNames} names
   * @param {{focus: (number: number|null) => void, choose: (number: number) => void,
   *   brush: () => void}} on
   */
  constructor(names, on) {
    this.#names = names;
    this.#on = on;
    const place = this.#frame.element;
    place.append(this.#canvas, this.#strips, saveImageButton(this.#frame.graph, this.#canvas));
    this.element = element('div', {}, place,
      element('div', {class: 'search-row'}, this.#words, this.#clear));
    place.addEventListener('pointermove', (event) => {
      if (event.pointerType !== 'touch' && !event.buttons) on.focus(this.#at(event));
    });
    place.addEventListener('pointerleave', () => on.focus(null));
    place.addEventListener('click', (event) => {
      const number = this.#at(event);
      if (number !== null) on.choose(number);
    });
  }

  /** Another study than before comes next. */
  begin() {
    this.#brushes.clear();
    this.within = null;
  }

  /**
   * @param {Study} study
   * @param {Trial[]} trials
   * @param {[string, number][]} marked trials by what they are
   */
  draw(study, trials, marked) {
    this.#marked = marked;
    if (this.#study !== study || trials.length !== this.#trials.length + this.#left) {
      this.#study = study;
      const known = trials.filter(({outcome}) => outcome.score !== null);
      this.#trials = known.sort((one, other) => other.outcome.cost - one.outcome.cost);
      this.#left = trials.length - known.length;
      this.#axes = known.length ? this.#allAxes(study) : [];
      this.#filter();
    }
    this.#frame.label = `Gains and score of ${this.#trials.length} trials as parallel coordinates`;
    this.#frame.request();
  }

  /** @param {Study} study */
  #allAxes({lane, result}) {
    const names = Object.keys(this.#trials[0].values);
    // What counts most stands beside the score, and stays where there is little room.
    const importance = result?.importance ?? {};
    names.sort((one, other) => (importance[other] ?? 0) - (importance[one] ?? 0));
    const scores = this.#trials.map(({outcome}) => Number(outcome.score));
    return [new ParallelAxis('score', 'score', scores), ...names.map((name) => new ParallelAxis(
      name, gainText(this.#names, lane, name), this.#trials.map(({values}) => values[name]),
    ))];
  }

  /** @param {Room} room */
  #draw({colors, width, height}) {
    if (!this.element.checkVisibility()) return;
    const pen = penOf(this.#canvas, width, height);
    const room = width - MARGIN.l - MARGIN.r;
    const shown = this.#axes.slice(0, Math.max(2, 1 + Math.floor(room / LEAST_GAP)));
    if (shown.length < 2) return;
    this.#box = {
      left: MARGIN.l, gap: room / (shown.length - 1), top: MARGIN.t,
      height: height - MARGIN.t - MARGIN.b,
    };
    const {within} = this;
    const passes = this.#trials.map(({number}) => !within || within.has(number));
    const marked = this.#marked.map(([mark, number]) => (
      /** @type {[string, number]} */ ([mark, this.#trials.findIndex((one) => one.number === number)])
    )).filter(([, at]) => at >= 0);
    drawLines(pen, colors, this.#box, shown, passes, marked, this.#brushes);
    this.#place(shown);
  }

  /** @param {ParallelAxis[]} shown */
  #place(shown) {
    const {left, gap, top, height} = /** @type {Box} */ (this.#box);
    const known = [...this.#strips.children].map((strip) => strip.getAttribute('data-axis')).join('\n');
    if (known !== shown.map(({id}) => id).join('\n')) {
      this.#strips.replaceChildren(...shown.map(({id, label}) => this.#strip(id, label)));
      this.#tell();
    }
    shown.forEach((axis, at) => {
      const strip = /** @type {HTMLElement} */ (this.#strips.children[at]);
      const brush = this.#brushes.get(axis.id);
      Object.assign(strip.style, {
        left: `${left + at * gap - STRIP / 2}px`, top: `${top}px`, height: `${height}px`,
      });
      const middle = brush ? 100 * axis.along((brush[0] + brush[1]) / 2) : 50;
      strip.setAttribute('aria-valuenow', String(Math.round(middle)));
      strip.setAttribute('aria-valuetext', brush ? brush.map((end) => (
        written(Number(end.toPrecision(3)))
      )).join(' to ') : 'all values');
    });
  }

  /**
   * @param {string} id
   * @param {string} label
   */
  #strip(id, label) {
    return element('div', {
      class: 'search-strip', 'data-axis': id, tabindex: 0, role: 'slider',
      'aria-orientation': 'vertical', 'aria-label': `Brush of ${label}`, 'aria-valuemin': 0,
      'aria-valuemax': 100, title: 'Drag to keep what passes here; press to keep everything',
      on: {
        pointerdown: (/** @type {PointerEvent} */ event) => this.#grab(id, event),
        click: (/** @type {Event} */ event) => event.stopPropagation(),
        keydown: (/** @type {KeyboardEvent} */ event) => this.#key(id, event),
      },
    });
  }

  /**
   * @param {string} id
   * @param {PointerEvent} begun
   */
  #grab(id, begun) {
    const strip = /** @type {HTMLElement} */ (begun.currentTarget);
    strip.setPointerCapture(begun.pointerId);
    const move = (/** @type {PointerEvent} */ event) => {
      const {top, height} = strip.getBoundingClientRect();
      const axis = this.#axes.find((one) => one.id === id);
      if (!axis) return;
      if (Math.abs(event.clientY - begun.clientY) <= STILL) { this.#brush(id); return; }
      const [low, high] = [begun, event].map(({clientY}) => (
        axis.valueAt(1 - (clientY - top) / height)
      )).sort((one, other) => one - other);
      this.#brush(id, [low, high]);
    };
    strip.addEventListener('pointermove', move);
    for (const type of ['pointerup', 'pointercancel']) {
      strip.addEventListener(type, () => strip.removeEventListener('pointermove', move), {once: true});
    }
    move(begun);
  }

  /**
   * @param {string} id
   * @param {KeyboardEvent} event
   */
  #key(id, event) {
    const way = /** @type {1|-1|undefined} */ ({ArrowUp: 1, ArrowDown: -1}[event.key]);
    const axis = this.#axes.find((one) => one.id === id);
    if (!axis || (!way && event.key !== 'Delete' && event.key !== 'Backspace')) return;
    event.preventDefault();
    // The page takes these keys for itself elsewhere.
    event.stopPropagation();
    this.#brush(id, way && axis.moved(this.#brushes.get(id), way));
  }

  /**
   * @param {string|null} id of an axis; null: of all
   * @param {Brush} [brush] none: everything passes
   */
  #brush(id, brush) {
    if (id === null) this.#brushes.clear();
    else if (brush) this.#brushes.set(id, brush);
    else if (!this.#brushes.delete(id)) return;
    this.#filter();
    this.#frame.request();
    this.#on.brush();
  }

  #filter() {
    const brushed = this.#axes.filter(({id}) => this.#brushes.has(id));
    const passing = this.#trials.filter((_, at) => brushed.every(({id, values}) => {
      const [low, high] = /** @type {Brush} */ (this.#brushes.get(id));
      return values[at] >= low && values[at] <= high;
    }));
    this.within = brushed.length ? new Set(passing.map(({number}) => number)) : null;
    this.#clear.hidden = !brushed.length;
    this.#tell(brushed.length ? `${passing.length} of ${this.#trials.length} trials pass.`
      : 'Drag along an axis to keep only what passes there.');
  }

  /** @param {string} [kept] how many pass, or how to have fewer */
  #tell(kept = this.#kept) {
    this.#kept = kept;
    const beyond = this.#axes.length - this.#strips.children.length;
    const hidden = this.#strips.children.length && beyond > 0
      ? ` No room for ${beyond} more ${beyond === 1 ? 'gain' : 'gains'}.` : '';
    const lost = this.#left ? ` ${this.#left} without a score are not drawn.` : '';
    const text = `${kept}${hidden}${lost}`;
    if (this.#words.textContent !== text) this.#words.textContent = text;
  }

  /**
   * @param {MouseEvent} event
   * @returns {number|null} the trial whose line is nearest
   */
  #at({clientX, clientY}) {
    if (!this.#box) return null;
    const {left, top} = this.#canvas.getBoundingClientRect();
    const shown = this.#axes.slice(0, this.#strips.children.length);
    const passes = (/** @type {number} */ at) => (
      !this.within || this.within.has(this.#trials[at].number)
    );
    const at = linesAt(this.#box, shown, clientX - left, clientY - top, passes);
    return at === null ? null : this.#trials[at].number;
  }
}
