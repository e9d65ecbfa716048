// @ts-check
/** A change that the server proposes: what it sets, in words, and a button that makes it. */

import {element, withIndices} from './element.js';
import {leaves, valueAt} from './merge_patch.js';

/** @typedef {import('./merge_patch.js').Document} Document */
/**
 * @typedef {{history: import('./history.js').History, tell: import('./notices.js').Tell,
 *   names: import('./field_names.js').FieldNames}} Desk
 */

/**
 * @param {Desk} desk
 * @param {Document} patch
 * @returns {HTMLElement} a button that makes the change, once
 */
export function proposalButton({history, tell, names}, patch) {
  const parts = leaves(patch).map((path) => names.assignment(path, valueAt(patch, path)));
  const words = `Set ${parts.join(', ')}`;
  const button = /** @type {HTMLButtonElement} */ (element('button', {
    class: 'button small', type: 'button', 'aria-label': words, on: {click: () => apply()},
  }, withIndices(words)));
  const apply = async () => {
    button.disabled = true;
    try {
      await history.change(patch, words);
    } catch (error) {
      tell(/** @type {Error} */ (error).message, {error: true});
      button.disabled = false;
    }
  };
  return button;
}
