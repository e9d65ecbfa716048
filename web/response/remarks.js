// @ts-check
/** What must be said of a whole response: which lanes left their bounds, which are inaccurate. */

import {element} from '../dom/element.js';
import {FieldNames} from '../fields/field_names.js';
import {icon} from '../dom/icons.js';
import {proposalButton} from '../knobs/proposal.js';
import {SCHEMA} from '../api/schema_document.js';
import {Schema} from '../fields/schema.js';

/** @typedef {import('../api/preview_message.js').Response} Response */
/** @typedef {import('../fields/merge_patch.js').Document} Document */
/**
 * @typedef {{name: string, color: string, text: string, level: 'frozen'|'warning',
 *   patch: Document|null}} Remark
 */

/** A list that is there when there is something to say. */
export class ResponseRemarks {
  element = element('ul', {class: 'response-remarks', 'aria-live': 'polite', hidden: true});
  #desk;
  #names;
  #shown = '';
  /** @type {Response|null} */ #estimated = null;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../page/right_panel.js').Desk} desk
   */
  constructor(api, desk) {
    this.#desk = desk;
    this.#names = new FieldNames(new Schema(SCHEMA), api);
  }

  /**
   * A drag's responses have no estimate: what the last one with it said stays as long as it lasts.
   *
   * @param {import('../api/api.js').Lane[]} lanes
   * @param {Response|null} response
   */
  show(lanes, response) {
    if (response?.estimated ?? true) this.#estimated = response;
    const remarks = lanes.flatMap((lane) => remarksOf(lane, response, this.#estimated));
    const shown = JSON.stringify(remarks);
    if (shown === this.#shown) return;
    this.#shown = shown;
    this.element.hidden = !remarks.length;
    this.element.replaceChildren(...remarks.map((remark) => {
      const line = drawn(remark);
      if (remark.patch) this.#offer(line, remark.patch);
      return line;
    }));
  }

  /**
   * Add the button that makes a change; what it sets, it says in the schema's words.
   *
   * @param {HTMLElement} line
   * @param {Document} patch
   */
  #offer(line, patch) {
    line.append(proposalButton({...this.#desk, names: this.#names}, patch));
  }
}

/**
 * @param {import('../api/api.js').Lane} lane
 * @param {Response|null} response
 * @param {Response|null} estimated
 * @returns {Remark[]}
 */
function remarksOf({name, color}, response, estimated) {
  /** @type {Remark[]} */ const remarks = [];
  const frozen = response?.lanes.get(name)?.frozen;
  if (frozen) remarks.push({name, color, text: frozen.cause, level: 'frozen', patch: null});
  const accuracy = estimated?.lanes.get(name)?.accuracy;
  // How exactly a lane left its bounds is no news.
  if (accuracy?.remark && !frozen) {
    const {remark: text, patch} = accuracy;
    remarks.push({name, color, text, level: 'warning', patch});
  }
  return remarks;
}

/** @param {Remark} remark */
function drawn({name, color, text, level}) {
  const dot = element('span', {class: 'plots-dot', 'aria-hidden': 'true'});
  dot.style.setProperty('--lane', color);
  return element(
    'li', {class: `is-${level}`}, dot, element('b', {}, name),
    level === 'warning' && icon('warning'), element('span', {}, text),
  );
}
