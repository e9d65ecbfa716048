// @ts-check
/** How many seconds the live plots show, and whether they follow the newest. */

import {element} from '../dom/element.js';

const LENGTHS = [2, 5, 10, 30, 60];

/** A list of lengths and the button `live`, for the toolbar. */
export class WindowControls {
  /** @type {HTMLElement[]} */ elements;
  #length;
  #live;

  /** @param {{length: (seconds: number) => void, live: () => void}} actions */
  constructor({length, live}) {
    this.#length = element(
      'select', {
        class: 'plots-select', on: {change: (event) => length(Number(event.target.value))},
      }, ...LENGTHS.map((seconds) => element('option', {value: seconds}, `${seconds} s`)),
    );
    this.#live = element('button', {
      type: 'button', class: 'plots-button plots-live', 'aria-pressed': 'true', on: {click: live},
    }, element('span', {class: 'plots-live-dot', 'aria-hidden': 'true'}), 'live');
    this.elements = [
      element('label', {class: 'plots-window'},
        element('span', {class: 'plots-label'}, 'window'), this.#length),
      this.#live,
    ];
  }

  /** @param {{length: number, live: boolean}} window */
  show({length, live}) {
    this.#length.value = String(length);
    this.#live.setAttribute('aria-pressed', String(live));
    this.#live.title = live
      ? 'Follows the newest data. Click to hold; drag in a plot to zoom, with Shift to pan.'
      : 'Held. Click, or double-click a plot, to follow the newest data again.';
  }
}
