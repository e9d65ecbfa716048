// @ts-check
/** What lies along a slider's track: the whole run's figure at twenty positions of one gain. */

import {jointCount} from '../api/arm.js';
import {element} from '../dom/element.js';
import {bestOf, cellsOf, drawStrip, placeOf} from './heat_drawing.js';
import {withUnit} from '../fields/quantity.js';
import {figureText} from '../figures/columns.js';

/** @typedef {import('../fields/schema.js').Field} Field */
/** @typedef {import('./study_metric.js').StudyRow} StudyRow */
/** @typedef {import('./study_metric.js').StudyMetric} StudyMetric */

/** Positions along a track. */
export const COUNT = 20;
/** Figures that differ by less than this factor are alike. */
const LEAST_SPREAD = 1.01;

/** One strip on the screen. */
export class Strip {
  slider;
  field;
  /** Whose share of the gain, from 1; null: that of all joints. */
  joint;
  key;
  /** @type {StudyRow[]} */ rows;
  #metric;
  #canvas = element('canvas', {class: 'heat-strip', 'aria-hidden': 'true'});
  #said = [element('span'), element('span', {class: 'heat-best'})];
  #words = element('span', {class: 'heat-words', 'aria-hidden': 'true'}, ...this.#said);
  #bar = element('span', {class: 'heat-progress', 'aria-hidden': 'true'});
  #aloud = element('span', {class: 'visually-hidden', role: 'status'});
  #abort = new AbortController();
  #failure = '';
  #frame = 0;
  /** @type {number|null} */ #pointer = null;
  /** Asked of the page when drawn: in the middle of a drag it would lay everything out. */
  #track = {width: 0, inset: 0, left: 0, room: 1};

  /**
   * @param {{slider: HTMLInputElement, field: Field, joint: number|null}} place
   * @param {StudyMetric} metric
   * @param {string} key
   * @param {StudyRow[]} [rows] where all are known
   */
  constructor({slider, field, joint}, metric, key, rows) {
    this.slider = slider;
    this.field = field;
    this.joint = joint;
    this.key = key;
    this.rows = rows ?? [];
    this.#metric = metric;
    slider.parentElement?.append(this.#canvas, this.#bar, this.#words, this.#aloud);
    if (rows) this.end();
    else this.draw();
  }

  get signal() { return this.#abort.signal; }

  get isComplete() { return this.rows.length === COUNT; }

  /** @returns {AbortSignal} of runs that begin now, from the first position on */
  go() {
    this.#abort.abort();
    this.#abort = new AbortController();
    this.#failure = '';
    this.#bar.hidden = false;
    this.tell();
    return this.signal;
  }

  /** Give up the runs under way; what they have told stays. */
  pause() {
    this.#abort.abort();
    this.tell();
  }

  /** @param {StudyRow} row */
  add(row) {
    this.rows[row.number] = row;
    // Several come within one frame.
    this.#frame ||= requestAnimationFrame(() => { this.#frame = 0; this.draw(); });
  }

  /** All positions are known. */
  end() {
    this.draw();
    this.#bar.hidden = true;
    this.#aloud.textContent = this.#summary();
    this.tell();
  }

  /** @param {string} text */
  fail(text) {
    this.#failure = text;
    this.#bar.hidden = true;
    this.tell();
  }

  remove() {
    this.#abort.abort();
    cancelAnimationFrame(this.#frame);
    for (const part of [this.#canvas, this.#bar, this.#words, this.#aloud]) part.remove();
  }

  #measured() {
    const {offsetWidth: width, offsetLeft: left, parentElement} = this.slider;
    const inset = matchMedia('(pointer: coarse)').matches ? 10 : 7;
    return {width, inset, left, room: parentElement?.clientWidth || 1};
  }

  draw() {
    const {rows, field} = this;
    const track = this.#measured();
    this.#track = track;
    const metric = this.#metric.chosen;
    const ended = this.isComplete;
    const best = ended && this.#matters ? bestOf(rows, metric) : undefined;
    const left = `${track.left}px`;
    this.#canvas.style.left = left;
    this.#bar.style.left = left;
    this.#bar.style.width = `${(track.width * rows.length) / COUNT}px`;
    drawStrip(this.#canvas, {
      cells: cellsOf(COUNT, rows, track),
      metric,
      best: best ? {row: best, place: placeOf(best.value, field, track)} : null,
      ended,
      width: track.width,
    });
    if (ended) this.#aloud.textContent = this.#summary();
    this.tell();
  }

  /** Whether the figure is another one at another position. */
  get #matters() {
    const {name} = this.#metric.chosen;
    const figures = this.rows.flatMap((row) => row[name] ?? []);
    const least = Math.max(Math.min(...figures), Number.MIN_VALUE);
    return figures.length < this.rows.length || Math.max(...figures) / least > LEAST_SPREAD;
  }

  /**
   * Say what stands under the pointer, or else under the thumb.
   *
   * @param {number} [pointer] across the window
   */
  tell(pointer) {
    if (pointer !== undefined) this.#pointer = pointer - this.slider.getBoundingClientRect().left;
    if (!this.slider.matches(':hover')) this.#pointer = null;
    const track = this.#track;
    const thumb = placeOf(this.#value, this.field, track);
    const at = this.#pointer ?? thumb;
    const cell = cellsOf(COUNT, this.rows, track).find(({right}) => at <= right);
    // Nothing is tried while the hand moves.
    this.#words.hidden = this.signal.aborted && !cell?.row;
    this.#said[0].textContent = this.#failure || this.#at(cell?.row);
    this.#said[1].textContent = this.#rest();
    // So much of their width as lies before this place: they stay within, however long they are.
    const along = `${(100 * (track.left + at)) / track.room}%`;
    this.#words.style.left = along;
    this.#words.style.translate = `-${along}`;
  }

  get #value() {
    const {log, minimum, maximum} = this.field;
    const along = this.slider.valueAsNumber;
    return log ? minimum * (maximum / minimum) ** (along / Number(this.slider.max)) : along;
  }

  get #name() {
    const name = this.field.symbol || this.field.title;
    return this.joint ? `${name} of J${this.joint}` : name;
  }

  /** @param {StudyRow|undefined} row */
  #at(row) {
    if (!row) return this.rows.length < COUNT ? 'trying …' : '';
    const value = `at ${this.#name} ≈ ${rounded(row.value, this.field.unit)}`;
    const metric = this.#metric.chosen;
    const figure = row[metric.name];
    if (row.state === 'refused') return `${value}: refused, ${row.reason}`;
    if (row.state === 'diverged' || figure === null) return `${value}: diverges`;
    const chatters = row.state === 'chattering' ? ', chatters' : '';
    const mean = metric.reduced === 'mean' ? `, mean of ${jointCount()}` : '';
    return `${value}: ${figureText(metric, figure)}${mean}${chatters}`;
  }

  #rest() {
    const {length} = this.rows;
    if (this.#failure) return '';
    return length < COUNT ? `${length} of ${COUNT}` : this.#summary();
  }

  #summary() {
    const metric = this.#metric.chosen;
    const best = bestOf(this.rows, metric);
    if (!best) return `no value of ${this.#name} is stable`;
    const figure = figureText(metric, /** @type {number} */ (best[metric.name]));
    if (!this.#matters) return `no effect: ${figure}`;
    const calm = this.rows.some(({state}) => state === 'chattering') ? ' without chattering' : '';
    return `best${calm} near ${rounded(best.value, '')}: ${figure}`;
  }
}

/**
 * @param {number} value
 * @param {string} unit
 */
function rounded(value, unit) { return withUnit(Number(value.toPrecision(2)), unit); }
