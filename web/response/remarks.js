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
 * `due`: said of a run before the drag, until the next estimate
 * @typedef {{name: string, color: string, text: string, level: 'frozen'|'warning',
 *   patch: Document|null, due: boolean}} Remark
 */

const DUE = 'Of before the drag; estimated anew on release';

/**
 * A list that is there when there is something to say. It takes two lines of one remark, one each of
 * several; the rest unfolds over the plots.
 */
export class ResponseRemarks {
  element;
  #list = element('ul', {'aria-live': 'polite'});
  #more = element('button', {
    type: 'button', class: 'button small response-more', 'aria-expanded': 'false', hidden: true,
    on: {click: () => this.#unfold(!this.#isOpen)},
  }, 'more');
  #isOpen = false;
  /** Asked for in the middle of a drag, the page would lay everything out. */
  #height = 0;
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
    this.element = element('div', {
      class: 'response-remarks', hidden: true, on: {keydown: (event) => this.#keyed(event)},
    }, this.#list, this.#more);
    new ResizeObserver(([{borderBoxSize: [{blockSize}]}]) => {
      this.#height = blockSize;
      this.#measure();
    }).observe(this.element);
  }

  /**
   * A drag's responses have no estimate: what the last one with it said stays as long as it lasts,
   * in the same room.
   *
   * @param {import('../api/api.js').Lane[]} lanes
   * @param {Response|null} response
   */
  show(lanes, response) {
    const isDrag = response?.estimated === false;
    if (!isDrag) this.#estimated = response;
    const remarks = lanes.flatMap((lane) => remarksOf(lane, response, this.#estimated));
    if (this.#height && !this.element.hidden && !this.#isOpen) {
      this.element.style.height = isDrag ? `${this.#height}px` : '';
    }
    if (!isDrag || remarks.length) this.element.hidden = !remarks.length;
    const shown = JSON.stringify(remarks);
    if (shown === this.#shown) return;
    this.#shown = shown;
    this.element.classList.toggle('is-single', remarks.length === 1);
    if (!remarks.length && !isDrag) this.#unfold(false);
    this.#list.replaceChildren(...remarks.map((remark) => {
      const line = drawn(remark);
      if (remark.patch) this.#offer(line, remark.patch, remark.due);
      return line;
    }));
    if (!isDrag) requestAnimationFrame(() => this.#measure());
  }

  /** Whether a remark goes on, which is no question while all of it is shown. */
  #measure() {
    if (this.#isOpen) return;
    const parts = [this.#list, ...this.#list.querySelectorAll('.response-remark')];
    const buttons = [...this.#list.querySelectorAll('.button')];
    this.#more.hidden = parts.every((part) => part.scrollHeight <= part.clientHeight + 1)
      && buttons.every((button) => button.checkVisibility());
  }

  /** @param {boolean} open */
  #unfold(open) {
    if (open === this.#isOpen) return;
    this.#isOpen = open;
    // The plots below stay where they are.
    this.element.style.height = open ? `${this.#height}px` : '';
    this.element.classList.toggle('is-open', open);
    this.#more.setAttribute('aria-expanded', String(open));
    this.#more.textContent = open ? 'less' : 'more';
  }

  /** @param {KeyboardEvent} event */
  #keyed(event) {
    if (event.key !== 'Escape' || !this.#isOpen) return;
    event.stopPropagation();
    this.#unfold(false);
  }

  /**
   * Add the button that makes a change; what it sets, it says in the schema's words.
   *
   * @param {HTMLElement} line
   * @param {Document} patch
   * @param {boolean} due
   */
  #offer(line, patch, due) {
    const button = /** @type {HTMLButtonElement} */ (
      proposalButton({...this.#desk, names: this.#names}, patch)
    );
    button.disabled = due;
    line.append(button);
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
  if (frozen) remarks.push({name, color, text: frozen.cause, level: 'frozen', patch: null, due: false});
  const accuracy = estimated?.lanes.get(name)?.accuracy;
  // How exactly a lane left its bounds is no news.
  if (accuracy?.remark && !frozen) {
    const {remark: text, patch} = accuracy;
    const due = response?.estimated === false
      && (response.lanes.get(name)?.accuracy.error_estimate ?? null) === null;
    remarks.push({name, color, text, level: 'warning', patch, due});
  }
  return remarks;
}

/** @param {Remark} remark */
function drawn({name, color, text, level, due}) {
  const dot = element('span', {class: 'plots-dot', 'aria-hidden': 'true'});
  dot.style.setProperty('--lane', color);
  return element(
    'li', {class: `is-${level}${due ? ' is-due' : ''}`, title: due ? DUE : null}, dot,
    element('b', {}, name), level === 'warning' && icon('warning'),
    element('span', {class: 'response-remark'}, text),
  );
}
