// @ts-check
/** A row of tabs; arrow keys, Home and End move between them. */

import {element, freshId} from './element.js';

/** @typedef {{id: string, title: string}} Tab */

/** The tabs of one panel. */
export class PlotTabs {
  /** @type {HTMLElement} */ element;
  /** @type {Map<string, HTMLButtonElement>} */ #buttons = new Map();
  #choose;
  #selected = '';

  /**
   * @param {Tab[]} tabs
   * @param {HTMLElement} panel what they switch
   * @param {(id: string) => void} choose
   */
  constructor(tabs, panel, choose) {
    this.#choose = choose;
    panel.id ||= freshId('plots-panel');
    panel.setAttribute('role', 'tabpanel');
    for (const {id, title} of tabs) {
      this.#buttons.set(id, element('button', {
        id: freshId('plots-tab'), type: 'button', role: 'tab', class: 'plots-tab',
        'aria-controls': panel.id, 'aria-selected': 'false', tabindex: -1,
        on: {click: () => choose(id)},
      }, title));
    }
    this.element = element('div', {
      role: 'tablist', class: 'plots-tabs', 'aria-label': 'Plots',
      on: {keydown: (event) => this.#moved(event)},
    }, ...this.#buttons.values());
    this.panel = panel;
    new ResizeObserver(() => this.#reveal()).observe(this.element);
  }

  /** @param {string} chosen */
  select(chosen) {
    if (chosen === this.#selected) return;
    this.#selected = chosen;
    for (const [id, button] of this.#buttons) {
      const selected = id === chosen;
      button.setAttribute('aria-selected', String(selected));
      button.tabIndex = selected ? 0 : -1;
      if (selected) this.panel.setAttribute('aria-labelledby', button.id);
    }
    this.#reveal();
  }

  #reveal() {
    const button = this.#buttons.get(this.#selected);
    if (!button) return;
    const {offsetLeft: left, offsetWidth: width} = button;
    const row = this.element;
    // scrollIntoView would scroll the page as well.
    if (left < row.scrollLeft) row.scrollLeft = left;
    else if (left + width > row.scrollLeft + row.clientWidth) {
      row.scrollLeft = left + width - row.clientWidth;
    }
  }

  /** @param {KeyboardEvent} event */
  #moved(event) {
    const buttons = [...this.#buttons.values()];
    const at = buttons.findIndex((button) => button === document.activeElement);
    const to = new Map([
      ['ArrowRight', (at + 1) % buttons.length],
      ['ArrowLeft', (at - 1 + buttons.length) % buttons.length],
      ['Home', 0],
      ['End', buttons.length - 1],
    ]).get(event.key);
    if (to === undefined) return;
    event.preventDefault();
    // The page takes arrow keys for itself elsewhere.
    event.stopPropagation();
    buttons[to].focus();
    this.#choose([...this.#buttons.keys()][to]);
  }
}
