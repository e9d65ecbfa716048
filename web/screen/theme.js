// @ts-check
/** Light and dark: as the system has it, or as chosen. The page's `data-theme` says which. */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {recall, remember} from './remembered.js';

const CHOICES = /** @type {const} */ (['auto', 'light', 'dark']);
const SHOWN = /** @type {const} */ ({
  auto: ['auto', 'Theme: as the system'],
  light: ['sun', 'Theme: light'],
  dark: ['moon', 'Theme: dark'],
});

/** @typedef {typeof CHOICES[number]} Choice */

const system = matchMedia('(prefers-color-scheme: dark)');

/** @returns {Choice} */
function chosen() {
  return CHOICES.find((choice) => choice === recall('theme')) ?? 'auto';
}

/** Put the chosen theme on the page. */
export function applyTheme() {
  const choice = chosen();
  const theme = choice === 'auto' ? (system.matches ? 'dark' : 'light') : choice;
  document.documentElement.dataset.theme = theme;
}

/** Go on to the next of automatic, light, dark. */
export function nextTheme() {
  const next = CHOICES[(CHOICES.indexOf(chosen()) + 1) % CHOICES.length];
  remember('theme', next === 'auto' ? null : next);
  applyTheme();
  dispatchEvent(new Event('slidetune:theme'));
}

/** @returns {HTMLButtonElement} a button that shows the choice and goes on to the next */
export function themeButton() {
  const button = element('button', {class: 'button icon-only', type: 'button', on: {click: nextTheme}});
  const show = () => {
    const [name, label] = SHOWN[chosen()];
    button.replaceChildren(icon(name));
    button.setAttribute('aria-label', label);
    button.title = label;
  };
  addEventListener('slidetune:theme', show);
  show();
  return button;
}

system.addEventListener('change', applyTheme);
