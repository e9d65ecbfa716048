// @ts-check
/** Who changed what, when: the list of edits in a panel, and the way back to each. */

import {element, symbol} from '../dom/element.js';
import {FieldNames, valueText} from '../fields/field_names.js';
import {icon} from '../dom/icons.js';
import {SCHEMA} from '../api/schema_document.js';
import {Schema} from '../fields/schema.js';

/** @typedef {{path: string[], from: any, to: any}} FieldChange whole lanes: `all` and `none` */
/**
 * `time` in [s] since 1970.
 * @typedef {{number: number, revision: number, time: number, author: string,
 *   changes: FieldChange[]}} Edit
 */

const MOST_CHANGES = 4;
const AGES_MS = 5000;
const WIDTH = 380;
const LONGEST = 32;
/** Authors that are no browser. */
const NAMES = new Map([['', 'the server'], ['http', 'a program'], ['history', 'return to an earlier edit']]);

/**
 * A button that opens the list; the event `edits` does so, too.
 *
 * @param {import('../api/api.js').Api} api
 * @param {import('../api/undo.js').History} history
 * @returns {HTMLButtonElement}
 */
export function editsButton(api, history) { return new EditPanel(api, history).button; }

class EditPanel {
  button;
  #api;
  #history;
  #panel;
  #list = element('ol', {class: 'edits-list'});
  #alert = element('p', {class: 'dialog-alert', role: 'alert'});
  #names;
  /** Ids that this page had: it gets another one after a lost connection. */
  #own = new Set();
  #ticking = 0;
  #asked = 0;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../api/undo.js').History} history
   */
  constructor(api, history) {
    this.#api = api;
    this.#history = history;
    this.#names = new FieldNames(new Schema(SCHEMA), api);
    this.#panel = element('section', {
      class: 'edits', popover: 'auto', 'aria-label': 'Edits of this session',
      on: {toggle: (event) => this.#toggled(event.newState === 'open')},
    }, element('h2', {tabindex: -1}, 'Edits of this session'), this.#alert, this.#list);
    this.button = element('button', {
      class: 'button icon-only', type: 'button', 'aria-label': 'Edits', title: 'Edits (H)',
      'aria-haspopup': 'dialog',
    }, icon('clock'));
    this.button.popoverTargetElement = this.#panel;
    document.body.append(this.#panel);
    api.addEventListener('edits', () => this.#panel.togglePopover());
    api.addEventListener('hello', () => this.#own.add(api.client));
    for (const type of ['patch', 'hello']) {
      api.addEventListener(type, () => { if (this.#open) this.#refresh(); });
    }
  }

  get #open() { return this.#panel.matches(':popover-open'); }

  /** @param {boolean} open */
  #toggled(open) {
    clearInterval(this.#ticking);
    if (!open) return;
    const {left, bottom} = this.button.checkVisibility()
      ? this.button.getBoundingClientRect() : {left: 0, bottom: 46};
    const widest = Math.min(WIDTH, innerWidth - 16);
    this.#panel.style.left = `${Math.max(8, Math.min(left, innerWidth - widest - 8))}px`;
    this.#panel.style.top = `${bottom + 6}px`;
    this.#panel.style.width = `${widest}px`;
    this.#panel.querySelector('h2')?.focus();
    this.#refresh();
    this.#ticking = setInterval(() => this.#age(), AGES_MS);
  }

  async #refresh() {
    this.#asked += 1;
    const asked = this.#asked;
    try {
      const edits = await this.#api.edits();
      if (asked !== this.#asked) return;
      this.#alert.textContent = '';
      this.#fill(edits.reverse());
    } catch (error) {
      this.#alert.textContent = /** @type {Error} */ (error).message;
    }
  }

  /** @param {Edit[]} edits the newest first */
  #fill(edits) {
    const items = edits.map((edit, index) => this.#item(edit, index === 0));
    if (!items.length) {
      items.push(element('li', {class: 'edits-none'}, 'Nothing has been changed yet.'));
    }
    this.#list.replaceChildren(...items);
  }

  /**
   * @param {Edit} edit
   * @param {boolean} present whether it made what is in force
   */
  #item(edit, present) {
    const {number, revision, time, author} = edit;
    const changes = edit.changes.filter(({path}) => path[0] !== 'description');
    const when = new Date(time * 1000);
    const age = element('time', {
      datetime: when.toISOString(), title: when.toLocaleString(), 'data-time': time,
    }, ageText(time));
    const own = this.#own.has(author) || this.#api.made.has(revision);
    const who = own ? 'you' : NAMES.get(author) ?? author;
    const shown = changes.slice(0, MOST_CHANGES).map((change) => this.#change(change));
    const more = changes.length - shown.length;
    if (!changes.length) shown.push(element('div', {}, 'Description changed'));
    if (more > 0) shown.push(element('div', {class: 'edits-more'}, `and ${more} more`));
    const back = present ? element('span', {class: 'edits-present'}, 'in force') : element('button', {
      class: 'button small', type: 'button', 'data-edit': number,
      'aria-label': `Back to here: edit ${number}`, on: {click: () => this.#restore(number)},
    }, 'Back to here');
    return element('li', {class: 'edits-item'},
      element('div', {class: 'edits-head'}, age, ` · ${who}`),
      element('div', {class: 'edits-changes'}, ...shown), back);
  }

  /** @param {FieldChange} change */
  #change({path, from, to}) {
    const whole = [from, to].every((value) => value === 'all' || value === 'none');
    if (whole) return element('div', {}, `${path[path.length - 1]} ${to === 'all' ? 'added' : 'removed'}`);
    const {symbol: sign, title, unit, lane} = this.#names.of(path);
    const values = `${shortened(valueText(from))} → ${shortened(valueText(to, unit))}`;
    return element('div', {title: path.join('.')},
      element('span', {class: 'edits-field'}, sign ? symbol(sign) : title),
      lane && element('span', {class: 'edits-lane'}, ` of ${lane}`),
      element('span', {class: 'edits-values'}, ` ${values}`));
  }

  /** @param {number} number */
  async #restore(number) {
    this.#alert.textContent = '';
    try {
      await this.#history.travelTo(`return to edit ${number}`, () => this.#api.restoreEdit(number));
      // The news of it may have been drawn before the answer said whose it is.
      await this.#refresh();
    } catch (error) {
      this.#alert.textContent = /** @type {Error} */ (error).message;
    }
    this.#panel.querySelector('h2')?.focus();
  }

  #age() {
    for (const age of this.#list.querySelectorAll('time')) {
      age.textContent = ageText(Number(age.dataset.time));
    }
  }
}

/** @param {string} text */
function shortened(text) { return text.length > LONGEST ? `${text.slice(0, LONGEST)}…` : text; }

/**
 * @param {number} time in [s] since 1970
 * @returns {string} how long ago that is
 */
function ageText(time) {
  const seconds = Math.max(0, Date.now() / 1000 - time);
  if (seconds < 5) return 'just now';
  if (seconds < 60) return `${Math.round(seconds)} s ago`;
  if (seconds < 3600) return `${Math.round(seconds / 60)} min ago`;
  return `${Math.round(seconds / 3600)} h ago`;
}
