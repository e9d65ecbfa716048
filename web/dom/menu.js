// @ts-check
/** A menu that opens at a button; arrow keys, Home, End, Escape and first letters work. */

import {element, withIndices} from './element.js';
import {icon} from './icons.js';

/**
 * @typedef {{label: string, hint?: string, keys?: string, icon?: import('./icons.js').IconName,
 *   checked?: boolean, danger?: boolean, disabled?: boolean, run: () => void}} Item
 * @typedef {Item|'separator'|{heading: string}} Entry
 */

const MARGIN = 8;

/**
 * Put a popover below its anchor, or above it, inside the window.
 *
 * @param {HTMLElement} popover
 * @param {Element} anchor
 */
export function placeAt(popover, anchor) {
  const at = anchor.getBoundingClientRect();
  const {width, height} = popover.getBoundingClientRect();
  const left = Math.max(MARGIN, Math.min(at.left, innerWidth - width - MARGIN));
  const below = at.bottom + 4;
  const fits = below + height <= innerHeight - MARGIN;
  const top = fits ? below : Math.max(MARGIN, at.top - height - 4);
  popover.style.left = `${left}px`;
  popover.style.top = `${top}px`;
}

/**
 * @param {HTMLElement} anchor
 * @param {Entry[]} entries
 */
export function openMenu(anchor, entries) {
  const menu = element('div', {class: 'menu', role: 'menu', popover: 'auto'});
  const close = () => menu.hidePopover();
  menu.append(...entries.map((entry) => drawn(entry, close)));
  document.body.append(menu);
  menu.addEventListener('keydown', (event) => moved(menu, event));
  menu.addEventListener('toggle', (event) => {
    const open = /** @type {ToggleEvent} */ (event).newState === 'open';
    anchor.setAttribute('aria-expanded', String(open));
    if (!open) menu.remove();
  });
  menu.showPopover();
  placeAt(menu, anchor);
  enabledItems(menu)[0]?.focus();
}

/**
 * @param {Entry} entry
 * @param {() => void} close
 */
function drawn(entry, close) {
  if (entry === 'separator') return element('div', {class: 'menu-separator', role: 'separator'});
  if ('heading' in entry) return element('div', {class: 'menu-heading'}, entry.heading);
  const checkable = entry.checked !== undefined;
  const button = element('button', {
    type: 'button',
    class: entry.danger ? 'menu-item is-danger' : 'menu-item',
    role: checkable ? 'menuitemradio' : 'menuitem',
    'aria-checked': checkable ? String(entry.checked) : null,
    tabindex: -1,
    disabled: entry.disabled,
    on: {click: () => { close(); entry.run(); }},
  });
  const mark = entry.checked ? icon('check') : entry.icon && icon(entry.icon);
  const hint = entry.hint && element('span', {class: 'menu-hint'}, withIndices(entry.hint));
  const text = element('span', {class: 'menu-text'}, element('span', {}, entry.label), hint);
  if (checkable || mark) button.append(element('span', {class: 'menu-mark'}, mark));
  button.append(text);
  if (entry.keys) button.append(element('kbd', {}, entry.keys));
  return button;
}

/**
 * @param {HTMLElement} menu
 * @returns {HTMLElement[]}
 */
function enabledItems(menu) {
  return [...menu.querySelectorAll('.menu-item:not(:disabled)')].map((item) => (
    /** @type {HTMLElement} */ (item)
  ));
}

/**
 * @param {HTMLElement} menu
 * @param {KeyboardEvent} event
 */
function moved(menu, event) {
  // It keeps the focus for a moment after it has closed: that key is the page's.
  if (!menu.matches(':popover-open')) return;
  const items = enabledItems(menu);
  const at = items.findIndex((item) => item === document.activeElement);
  const letter = event.key.toLowerCase();
  const to = {
    ArrowDown: (at + 1) % items.length,
    ArrowUp: (at - 1 + items.length) % items.length,
    Home: 0,
    End: items.length - 1,
  }[event.key] ?? items.findIndex((item) => item.textContent?.toLowerCase().startsWith(letter));
  event.stopPropagation();
  if (event.key === 'Tab') menu.hidePopover();
  if (to < 0 || event.key === ' ' || event.key === 'Enter') return;
  event.preventDefault();
  items[to]?.focus();
}
