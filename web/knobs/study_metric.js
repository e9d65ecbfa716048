// @ts-check
/** By which figure variants of an experiment are compared; smaller is better for each. */

import {element} from '../dom/element.js';
import {written} from '../fields/quantity.js';
import {recall, remember} from '../screen/remembered.js';

/**
 * One line of a study; see the server's `/api/studies`. The figures are null where a run came to
 * nothing.
 *
 * @typedef {{number: number, count: number, revision: number, name: string, value: any,
 *   patch: import('../fields/merge_patch.js').Document, factor: number|null, present: boolean,
 *   mae: number|null, max_error: number|null, chattering: number|null, flange_rms: number|null,
 *   state: 'good'|'chattering'|'diverged'|'refused', reason: string}} StudyRow
 */
/**
 * @typedef {{id: 'mae'|'max_error'|'chattering'|'flange_rms', title: string, short: string,
 *   unit: string, factor: number}} Metric
 */

/** @type {Metric[]} */
export const METRICS = [
  {id: 'mae', title: 'mean error', short: 'MAE', unit: 'mrad', factor: 1000},
  {id: 'max_error', title: 'maximum error', short: 'max', unit: 'mrad', factor: 1000},
  {id: 'chattering', title: 'chattering', short: 'chattering', unit: 'N·m/s', factor: 1},
  {id: 'flange_rms', title: 'flange RMS', short: 'flange', unit: 'mm', factor: 1000},
];
const DIGITS = 3;

/**
 * @param {Metric} metric
 * @param {number} figure as the server gives it
 * @returns {string} such as `8.31 mrad`
 */
export function figureText({factor, unit}, figure) {
  return `${written(Number((figure * factor).toPrecision(DIGITS)))} ${unit}`;
}

/** Event `change`: another figure was chosen. It is remembered. */
export class StudyMetric extends EventTarget {
  /** @type {Metric} */ chosen = METRICS.find(({id}) => id === recall('study.metric')) ?? METRICS[0];

  /** @returns {HTMLElement} a list to choose from */
  list() {
    const select = element('select', {
      class: 'select study-metric', 'aria-label': 'Judge gains by',
      title: 'The figure by which strips and bars judge a gain',
      on: {change: () => this.#choose(METRICS[select.selectedIndex])},
    }, ...METRICS.map(({id, title}) => element('option', {value: id}, `by ${title}`)));
    select.value = this.chosen.id;
    return select;
  }

  /** @param {Metric} metric */
  #choose(metric) {
    this.chosen = metric;
    remember('study.metric', metric.id);
    this.dispatchEvent(new Event('change'));
  }
}
