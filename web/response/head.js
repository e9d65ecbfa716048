// @ts-check
/** Around the response: its tabs, two switches, which revision it belongs to. */

import {element} from '../dom/element.js';
import {isWatching, ownersLast} from '../api/watch_only.js';

/** @typedef {import('../api/preview.js').Preview} Preview */
/**
 * @typedef {{opens: boolean, scene: boolean, open: (on: boolean) => void,
 *   paths: (on: boolean) => void}} Switches
 */

/** A run that is over sooner needs no word. */
const PATIENCE_MS = 300;
const WHAT = 'Every lane from t = 0 over the horizon, with the step of the experiment.';

/** The line of status with its progress bar, and what may go wrong. */
export class ResponseHead {
  element;
  /** Which run is shown. */
  status = element('span', {class: 'response-status', 'aria-live': 'polite', title: WHAT});
  #preview;
  #revision;
  #bar = element('div', {
    class: 'response-progress running-bar', role: 'progressbar', hidden: true,
    'aria-label': 'Computing the response',
  });
  #failure = element('p', {class: 'response-failure', role: 'alert', hidden: true});
  /** @type {ReturnType<typeof setTimeout>|undefined} */ #timer;

  /**
   * @param {Preview} preview
   * @param {() => number} revision the live one
   * @param {HTMLElement} tabs
   * @param {Switches} switches
   */
  constructor(preview, revision, tabs, {opens, scene, open, paths}) {
    this.#preview = preview;
    this.#revision = revision;
    const switches = element(
      'div', {class: 'response-switches', role: 'group', 'aria-label': 'When and where to show'},
      switchBox('open on drag', opens, open,
        'Moving a control opens this view. If off, its tab shows a dot instead.'),
      switchBox('paths in 3D', scene, paths,
        'The flange’s path of the whole response, in the 3D scene, also while another view is open.'),
    );
    this.element = element(
      'header', {class: 'response-head'}, tabs, switches, this.#bar, this.#failure,
    );
    // During a drag one run follows the other; the patience is for each.
    preview.addEventListener('response', () => { this.#wait(false); this.show(); });
    for (const type of ['busy', 'failed']) preview.addEventListener(type, () => this.show());
    this.show();
  }

  show() {
    const {latest, failure, busy} = this.#preview;
    this.#wait(busy);
    const text = latest ? wording(latest, this.#revision()) : nothingYet();
    // Nobody wants every step of a drag read out.
    this.status.setAttribute('aria-busy', String(latest?.estimated === false));
    if (this.status.textContent !== text) this.status.textContent = text;
    this.status.dataset.response = String(latest?.revision ?? '');
    this.status.dataset.estimated = String(latest?.estimated ?? '');
    this.#explain(failure);
  }

  /** @param {boolean} busy */
  #wait(busy) {
    if (!busy) {
      clearTimeout(this.#timer);
      this.#timer = undefined;
      this.#bar.hidden = true;
    } else {
      this.#timer ??= setTimeout(() => { this.#bar.hidden = false; }, PATIENCE_MS);
    }
  }

  /** @param {string} failure */
  #explain(failure) {
    if (this.#failure.dataset.text === failure) return;
    this.#failure.dataset.text = failure;
    this.#failure.hidden = !failure;
    if (!failure) { this.#failure.replaceChildren(); return; }
    const again = element('button', {
      type: 'button', class: 'button small', on: {click: () => this.#preview.again()},
    }, 'Try again');
    this.#failure.replaceChildren(
      element('span', {}, `${isWatching() ? 'The owner’s response could not be fetched'
        : 'The response could not be computed'}: ${failure}`), again,
    );
  }
}

function nothingYet() {
  return isWatching() ? 'the owner has not opened the response yet' : 'not computed yet';
}

/**
 * @param {import('../api/preview_message.js').Response} response
 * @param {number} revision the live one
 */
function wording({revision: of}, revision) {
  if (isWatching()) return ownersLast('response', of, revision);
  return of < revision ? `rev ${of}, now ${revision}` : `rev ${of}`;
}

/**
 * @param {string} label
 * @param {boolean} checked
 * @param {(on: boolean) => void} change
 * @param {string} title
 */
function switchBox(label, checked, change, title) {
  return element('label', {class: 'response-switch', title}, element('input', {
    type: 'checkbox', role: 'switch', class: 'switch', checked,
    on: {change: (event) => change(event.target.checked)},
  }), label);
}
