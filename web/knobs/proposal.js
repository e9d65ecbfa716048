// @ts-check
/** A change that the server proposes: what it sets, in words, and a button that makes it. */

import {element, withIndices} from '../dom/element.js';
import {leaves, valueAt} from '../fields/merge_patch.js';

/** @typedef {import('../fields/merge_patch.js').Document} Document */
/**
 * @typedef {{history: import('../api/undo.js').History, tell: import('../dom/notices.js').Tell,
 *   names: import('../fields/field_names.js').FieldNames}} Desk
 */

/**
 * @param {Desk} desk
 * @param {Document} patch
 * @param {{title?: string, done?: () => void}} [how] `title`: what to call it instead of by its
 *   values; `done`: what follows the change
 * @returns {HTMLElement} a button that makes the change, once
 */
export function proposalButton({history, tell, names}, patch, {title, done = () => {}} = {}) {
  const parts = leaves(patch).map((path) => names.assignment(path, valueAt(patch, path)));
  const words = title || `Set ${parts.join(', ')}`;
  const button = /** @type {HTMLButtonElement} */ (element('button', {
    class: 'button small', type: 'button', 'aria-label': words, title: title && listed(names, patch), on: {click: () => apply()},
  }, withIndices(words)));
  const apply = async () => {
    button.disabled = true;
    try {
      await history.change(patch, words);
      done();
    } catch (error) {
      tell(/** @type {Error} */ (error).message, {error: true});
      button.disabled = false;
    }
  };
  return button;
}

/**
 * @param {Desk['names']} names
 * @param {Document} patch
 * @returns {string} a line for what all lanes share, and one for each lane
 */
function listed(names, patch) {
  const byLane = Map.groupBy(leaves(patch), ([part, lane]) => (part === 'lanes' ? lane : ''));
  return [...byLane].map(([lane, paths]) => {
    const parts = paths.map((path) => names.assignment(path, valueAt(patch, path)));
    return `${lane && `${lane}: `}${parts.join(', ')}`;
  }).join('\n');
}
