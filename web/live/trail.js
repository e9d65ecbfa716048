// @ts-check
/** Where the selected lane has just been in each joint's (e, de) plane, and where it is now. */

import {JOINTS} from '../api/arm.js';

/** @typedef {import('../api/api.js').Api} Api */
/** @typedef {import('../api/api.js').Frame} Frame */
/** @typedef {{time: number, e: number[], de: number[]}} Moment */

/** Frames kept: some ten seconds. */
const KEPT = 300;

/** Collects one moment a frame. */
export class LiveTrail {
  #api;
  #lane = '';
  /** @type {{e: number[], de: number[]}} columns of the lane's errors */ #places = {e: [], de: []};
  /** @type {Moment[]} */ #moments = [];

  /** @param {Api} api */
  constructor(api) {
    this.#api = api;
    api.addEventListener('hello', () => this.#follow());
    api.addEventListener('select', () => this.#follow());
    api.addEventListener('frame', (event) => {
      this.#append(/** @type {CustomEvent} */ (event).detail);
    });
    this.#follow();
  }

  /**
   * @param {number} joint from 1
   * @returns {{time: number, e: number[], de: number[]}|null} the newest last; null before the
   *   first frame
   */
  of(joint) {
    const last = this.#moments.at(-1);
    if (!last) return null;
    return {
      time: last.time,
      e: this.#moments.map(({e}) => e[joint - 1]),
      de: this.#moments.map(({de}) => de[joint - 1]),
    };
  }

  #follow() {
    const {channels, selected} = this.#api;
    if (selected !== this.#lane) this.#moments = [];
    this.#lane = selected;
    const place = (/** @type {string} */ group, /** @type {number} */ joint) => (
      channels.findIndex((one) => (
        one.lane === selected && one.group === group && one.joint === joint
      ))
    );
    this.#places = {
      e: JOINTS.map((joint) => place('e', joint)),
      de: JOINTS.map((joint) => place('de', joint)),
    };
  }

  /** @param {Frame} frame */
  #append({rows, columns, time, dt, data}) {
    const {e, de} = this.#places;
    if (!rows || columns !== this.#api.channels.length || [...e, ...de].includes(-1)) return;
    const now = time + (rows - 1) * dt;
    const last = this.#moments.at(-1);
    if (last && now < last.time) this.#moments = [];
    const newest = (/** @type {number} */ column) => data[(column + 1) * rows - 1];
    this.#moments.push({time: now, e: e.map(newest), de: de.map(newest)});
    if (this.#moments.length > KEPT) this.#moments.shift();
  }
}
