// @ts-check
/** A value for all joints or one for each, and coordinates that are always several. */

import {Control, disclosure} from './control.js';
import {element} from '../dom/element.js';
import {NumberPair} from './number_pair.js';
import {written} from '../fields/quantity.js';
import {greatest, scaled} from '../fields/shares.js';

/** @typedef {import('../fields/schema.js').Field} Field */

/** What the values of a list of that length are called, and what each of them is. */
const NAMES = /** @type {{[length: number]: string[]}} */ ({2: ['from', 'to'], 3: ['x', 'y', 'z']});
const PARTS = /** @type {{[length: number]: string}} */ ({2: 'end', 3: 'coordinate'});

/**
 * A field that is a list, or may be one. Off (null) is a switch where it is allowed.
 */
export class JointsControl extends Control {
  #all;
  /** @type {NumberPair[]} */ #each;
  #values = element('span', {class: 'joint-values'});
  #summary = element('div', {class: 'joint-summary'});
  #unit = element('span', {class: 'unit'});
  #merge;
  #switch;
  #open;
  /** @type {any} the last value that was not off */ #on;
  /** @type {number[]|null} what a common factor is applied to; null where there is one for all */
  #shares = null;

  /**
   * @param {Field} field
   * @param {import('./control.js').Context} context
   */
  constructor(field, context) {
    super(field, context);
    const names = (field.perJoint ? null : NAMES[field.length]) ?? numbered(field.length);
    this.#all = this.#pair(this.name, (value) => {
      if (this.#isAlone && field.kind === 'vector') return [value];
      return this.#shares ? scaled(this.#shares, value, this.field) : value;
    }, this.id);
    this.#each = names.map((name, index) => this.#pair(`${this.name}, ${name}`, (value) => (
      this.#each.map((pair, at) => (at === index ? value : pair.value))
    )));
    this.#merge = element('button', {
      class: 'button small', type: 'button', on: {click: () => this.set(this.#each[0].value)},
    }, 'Set all equal');
    this.#switch = element('input', {
      type: 'checkbox', role: 'switch', class: 'switch', 'aria-label': `${this.name}, on`,
      on: {change: () => this.set(this.#switch.checked ? this.#on ?? field.usual ?? field.maximum : null)},
    });
    const list = element('div', {class: 'joint-list', role: 'group', 'aria-label': this.name});
    this.#each.forEach((pair, index) => list.append(row(names[index], index, pair)));
    const {button, open} = disclosure(`${this.name}: each ${this.#part}`, list);
    this.#open = open;
    button.hidden = this.#isAlone;
    if (field.kind !== 'vector') this.#summary.append(this.#values, this.#merge);
    this.beside.append(this.#switch, this.#unit);
    const vector = field.kind === 'vector';
    this.place.append(this.#all.slider, this.#all.box, ...(vector ? [this.#values] : []), button);
    this.element.append(this.#summary, list);
  }

  get held() { return [this.#all, ...this.#each].some((pair) => pair.held); }

  /**
   * @param {number|number[]|null} value
   * @param {number|number[]|null} baseline
   */
  show(value, baseline) {
    const off = value === null;
    const mixed = Array.isArray(value) && !this.#isAlone;
    if (!off) this.#on = value;
    this.element.classList.toggle('is-off', off);
    this.element.classList.toggle('is-mixed', mixed);
    this.#shape(off, mixed);
    this.#each.forEach((pair, index) => {
      pair.set(at(value, index, this.field), at(baseline, index, this.field));
    });
    this.#showAll(mixed ? value : null, value, baseline);
  }

  /**
   * What all joints have, or the greatest share, to which the others keep their proportion.
   *
   * @param {number[]|null} shares
   * @param {number|number[]|null} value
   * @param {number|number[]|null} baseline
   */
  #showAll(shares, value, baseline) {
    // From what a drag began with: what met its bound on the way comes back from there, and so do
    // all from 0.
    if (!this.held && (!shares || !this.#shares || greatest(shares))) this.#shares = shares;
    const index = shares ? this.#shares?.indexOf(greatest(this.#shares)) ?? 0 : 0;
    this.#all.set(at(value, index, this.field), at(baseline, index, this.field));
    const words = shares ? 'The largest value; the others scale with it' : '';
    this.#all.box.title = words;
    this.#all.slider.title = words;
  }

  /**
   * @param {boolean} off
   * @param {boolean} mixed
   */
  #shape(off, mixed) {
    this.#switch.hidden = !this.field.nullable;
    this.#switch.checked = !off;
    const common = !off && !(mixed && this.field.kind === 'vector');
    this.#all.slider.hidden = !common;
    this.#all.box.hidden = !common;
    this.#summary.hidden = !mixed || this.field.kind === 'vector';
    this.#values.hidden = !mixed;
    this.#values.textContent = mixed ? shortened(this.current, this.field) : '';
    this.#unit.textContent = off ? '' : this.field.unit;
    this.#merge.title = mixed ? `All joints as J1: ${this.inText(this.current[0])}` : '';
    if (off) this.#open(false);
  }

  /** @returns {boolean} whether the arm has one joint, of which all and each are the same */
  get #isAlone() { return this.field.perJoint && this.field.length === 1; }

  get #part() { return (this.field.perJoint ? null : PARTS[this.field.length]) ?? 'joint'; }

  /**
   * @param {string} name
   * @param {(value: number) => number|number[]} whole the field's value when the pair's is this
   * @param {string} [id]
   */
  #pair(name, whole, id) {
    return new NumberPair({
      field: this.field,
      name,
      id,
      describedBy: this.describedBy,
      move: (value) => this.move(whole(value)),
      commit: () => this.commit(),
      cancel: () => this.cancel(),
      watch: (interrupt) => this.watch(interrupt),
      settle: () => this.settle(),
      reset: () => this.reset(),
      refuse: (text) => this.refuse(text),
    });
  }
}

/** @param {number} length */
function numbered(length) { return Array.from({length}, (_, index) => `J${index + 1}`); }

/**
 * @param {string} name
 * @param {number} index
 * @param {NumberPair} pair
 */
function row(name, index, pair) {
  return element(
    'div', {class: 'joint-row', 'data-joint': index + 1},
    element('span', {class: 'joint-name'}, name), pair.slider, pair.box,
  );
}

/**
 * @param {number|number[]|null|undefined} value
 * @param {number} index
 * @param {Field} field
 * @returns {number}
 */
function at(value, index, field) {
  if (Array.isArray(value)) return value[index];
  return value ?? field.maximum;
}

/**
 * @param {number[]} values
 * @param {Field} field
 */
function shortened(values, {perJoint}) {
  const texts = values.map((value) => written(Number(value.toPrecision(3))));
  return texts.join(!perJoint && PARTS[values.length] === 'end' ? ' to ' : '  ');
}
