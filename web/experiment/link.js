// @ts-check
/** Links: the live experiment and what is looked at as an address to paste, and such an address opened. */

import {isWatching, WATCH_ONLY} from '../api/watch_only.js';
import {showDialog} from '../dom/dialog.js';
import {element} from '../dom/element.js';
import {tellWithUndo} from '../dom/undo_notice.js';
import {recall, remember} from '../screen/remembered.js';
import {showRefusal} from './refusal.js';

/** @typedef {import('../api/api.js').Api} Api */
/** @typedef {import('../api/api.js').ApiError} ApiError */

const EXPERIMENT = 'x';
const LANE = 'lane';
const VIEW = 'right.view';
/** What a link says of each view: what this browser remembers by the same names. */
const SHOWN = /** @type {{[view: string]: string[]}} */ ({
  live: ['plots.view', 'plots.joints'], response: ['response.view', 'response.joints'],
  lenses: ['lens', 'lens.joint'], studies: [],
});
const LOOKS_LIKE_ONE = /^\s*(\S+#|#)?(x=)?1\.[a-z0-9-]*\.[0-9a-f]{8}\.[\w-]*\.[0-9a-f]{8}\S*\s*$/;
/** How the server offers to open what another version made. */
const DESPITE = 'despite';

/**
 * @param {string} text
 * @returns {boolean} whether it is meant as a link
 */
export function isLink(text) { return LOOKS_LIKE_ONE.test(text); }

/** Links to the live experiment. */
export class Links {
  #api;
  #history;
  #tell;

  /**
   * Where the page's own address is a link, what that shows is remembered before anybody recalls it.
   *
   * @param {Api} api nobody listens to yet
   * @param {import('../api/undo.js').History} history
   * @param {import('../dom/notices.js').Tell} tell
   */
  constructor(api, history, tell) {
    this.#api = api;
    this.#history = history;
    this.#tell = tell;
    const address = location.hash;
    if (isLink(address)) {
      // A reload is to go on with what has become of it.
      window.history.replaceState(null, '', location.pathname + location.search);
      showAgain(address);
      api.addEventListener('hello', () => this.open(address), {once: true});
    }
    addEventListener('hashchange', () => { if (isLink(location.hash)) location.reload(); });
  }

  /** Show an address of the live experiment, and put it on the clipboard. */
  async share() {
    try {
      await this.#api.settled();
      const address = `${location.origin}/#${EXPERIMENT}=${await this.#api.link()}${shownNow(this.#api.selected)}`;
      const status = element('p', {class: 'dialog-hint', role: 'status'}, '');
      const box = element('textarea', {
        class: 'text-box link-text', readonly: true, rows: 4, spellcheck: 'false', 'aria-label': 'Link',
      });
      box.value = address;
      const copy = async () => {
        box.select();
        try {
          await navigator.clipboard.writeText(address);
          status.textContent = `Copied: ${address.length} characters.`;
        } catch {
          // A browser lets only pages of this machine, or secure ones, write there.
          status.textContent = `${address.length} characters, selected: copy them with Ctrl C.`;
        }
      };
      showDialog('A link to this experiment', element('div', {class: 'dialog-text'},
        element('p', {}, 'It holds the experiment and what you look at, and none of it leaves this machine '
          + 'until you send it. To open it elsewhere, paste it on the page of any Slidetune, or run it without a page:'),
        element('code', {}, 'slidetune run "LINK"'), box, status,
        element('div', {class: 'dialog-buttons'},
          element('button', {class: 'button primary', type: 'button', on: {click: copy}}, 'Copy'))));
      await copy();
    } catch (error) {
      this.#tell(/** @type {Error} */ (error).message, {error: true});
    }
  }

  /**
   * Begin with the experiment of a link.
   *
   * @param {string} text
   * @param {boolean} [despite] whether another version's will do
   */
  async open(text, despite = false) {
    if (isWatching()) {
      this.#tell(WATCH_ONLY, {error: true});
      return;
    }
    try {
      await this.#history.replace('opening of a link', () => this.#api.openLink(text, despite));
      const lane = valueOf(text, LANE);
      if (lane in this.#api.experiment.lanes) this.#api.select(lane);
      tellWithUndo(this.#tell, this.#history, 'Opened the experiment of the link.');
    } catch (error) {
      this.#refused(text, /** @type {ApiError} */ (error));
    }
  }

  /**
   * @param {string} text
   * @param {ApiError} error
   */
  #refused(text, error) {
    const [field] = error.fields ?? [];
    if (field?.allowed !== DESPITE) {
      showRefusal('Not opened', 'The link', error);
      return;
    }
    const dialog = showDialog('Made with another version', element('div', {class: 'dialog-text'},
      element('p', {}, `${field.message[0].toUpperCase()}${field.message.slice(1)}.`),
      element('div', {class: 'dialog-buttons'}, element('button', {
        class: 'button primary', type: 'button', on: {click: () => { dialog.close(); this.open(text, true); }},
      }, 'Open it all the same'))));
  }
}

/** @param {string} lane that is selected */
function shownNow(lane) {
  const view = recall(VIEW) ?? 'live';
  const said = new URLSearchParams({[LANE]: lane, [VIEW]: view});
  for (const key of SHOWN[view] ?? []) {
    const value = recall(key);
    if (value) said.set(key, value);
  }
  return `&${said}`;
}

/** @param {string} address */
function showAgain(address) {
  for (const key of [VIEW, ...Object.values(SHOWN).flat()]) {
    const value = valueOf(address, key);
    if (value) remember(key, value);
  }
}

/**
 * @param {string} address
 * @param {string} key
 */
function valueOf(address, key) {
  return new URLSearchParams(address.trim().replace(/^[^#]*#/, '')).get(key) ?? '';
}
