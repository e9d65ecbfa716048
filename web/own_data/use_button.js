// @ts-check
/** The button that makes one edit of what a log says; a refusal is shown beside it. */

import {element} from '../dom/element.js';

/**
 * @param {string} text
 * @param {HTMLElement} alert where a refusal goes
 * @param {() => Promise<void>} run
 * @returns {HTMLButtonElement}
 */
export function useButton(text, alert, run) {
  const button = element('button', {type: 'button', class: 'button primary', on: {click: async () => {
    button.disabled = true;
    alert.textContent = '';
    try {
      await run();
    } catch (error) {
      alert.textContent = /** @type {Error} */ (error).message;
      button.disabled = false;
    }
  }}}, text);
  return button;
}
