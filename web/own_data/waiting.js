// @ts-check
/** What the dialogs about a log share: a wait that may be given up, and lists of remarks. */

import {element} from '../dom/element.js';
import {showDialog} from '../dom/dialog.js';

/**
 * @template Result
 * @param {string} title
 * @param {string} text what is under way
 * @param {() => Promise<Result>} run
 * @returns {Promise<Result|null>} null where the dialog was closed meanwhile
 */
export async function waitFor(title, text, run) {
  const dialog = showDialog(title, element('div', {class: 'dialog-text'}, element('p', {}, text),
    element('progress', {class: 'own-data-progress', 'aria-label': 'Under way'})));
  try {
    const result = await run();
    return dialog.open ? result : null;
  } finally {
    dialog.close();
  }
}

/**
 * @param {string[]} texts
 * @param {string} title
 * @returns {HTMLElement|null} null where there are none
 */
export function listOf(texts, title) {
  if (!texts.length) return null;
  return element('div', {class: 'own-data-list'}, element('p', {}, title),
    element('ul', {}, ...texts.map((text) => element('li', {}, text))));
}
