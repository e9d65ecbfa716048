// @ts-check
/** Which knob, which way: strips along the sliders, a ranking of the gains, remarks beside them. */

import {element} from '../dom/element.js';
import {FieldNames} from '../fields/field_names.js';
import {mountAdvice} from './advice.js';
import {mountHeatStrips} from './heat_strip.js';
import {mountSilenceMark} from './silence_mark.js';
import {StudyMetric} from './study_metric.js';
import {Tornado} from './tornado.js';

/**
 * @typedef {{api: import('../api/api.js').Api, history: import('../api/undo.js').History,
 *   tell: import('../dom/notices.js').Tell, schema: import('../fields/schema.js').Schema}} Desk
 */

/** What helps to tune the gains of the selected lane. */
export class Knobs {
  /** What belongs below the gains' heading. */
  element;

  /**
   * @param {Desk} desk
   * @param {HTMLElement} column with all controls
   * @param {HTMLElement} gains with those of the selected lane
   * @param {(path: string) => import('../fields/schema.js').Field|undefined} fieldAt by its dotted path
   */
  constructor({api, history, tell, schema}, column, gains, fieldAt) {
    const metric = new StudyMetric();
    const names = new FieldNames(schema, api);
    const tornado = new Tornado({api, history, metric, names});
    const bar = element('div', {class: 'knob-tools'}, metric.list(), tornado.button);
    this.element = element('div', {class: 'knobs'}, bar, tornado.card);
    mountHeatStrips(gains, api, fieldAt, metric);
    mountSilenceMark(gains, api, fieldAt);
    mountAdvice(column, {api, history, names, tell});
  }
}
