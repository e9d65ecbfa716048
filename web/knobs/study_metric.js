// @ts-check
/** By which figure variants of an experiment are compared; less is better of each. */

import {element} from '../dom/element.js';
import {FIGURES} from '../figures/figure.js';
import {recall, remember} from '../screen/remembered.js';

/**
 * One line of a study; see the server's `/api/studies`. The figures are null where a run came to
 * nothing.
 *
 * @typedef {{number: number, count: number, revision: number, name: string, value: any,
 *   patch: import('../fields/merge_patch.js').Document, factor: number|null, present: boolean,
 *   state: 'good'|'chattering'|'diverged'|'refused', reason: string, [figure: string]: any}} StudyRow
 */
/** @typedef {import('../figures/figure.js').Figure} Metric */

export const METRICS = FIGURES.filter(({studied}) => studied);

/** Event `change`: another figure was chosen. It is remembered. */
export class StudyMetric extends EventTarget {
  /** @type {Metric} */ chosen = METRICS.find(({name}) => name === recall('study.metric')) ?? METRICS[0];

  /** @returns {HTMLElement} a list to choose from */
  list() {
    const select = element('select', {
      class: 'select study-metric', 'aria-label': 'Judge gains by',
      title: 'Figure by which strips and bars rank a gain’s values',
      on: {change: () => this.#choose(METRICS[select.selectedIndex])},
    }, ...METRICS.map(({name, title}) => element('option', {value: name}, `by ${title}`)));
    select.value = this.chosen.name;
    return select;
  }

  /** @param {Metric} metric */
  #choose(metric) {
    this.chosen = metric;
    remember('study.metric', metric.name);
    this.dispatchEvent(new Event('change'));
  }
}
