// @ts-check
/** Make the live experiment what one entry of a study is of: one edit, which undo takes back. */

import {difference, same} from '../fields/merge_patch.js';
import {tellWithUndo} from '../dom/undo_notice.js';
import {entryExperiment} from '../api/requests/studies.js';

/**
 * Only what the entry changes is changed.
 *
 * @param {import('../api/api.js').Api} api
 * @param {import('../page/right_panel.js').Desk} desk
 * @param {import('../api/requests/studies.js').Study} study
 * @param {number} place of the entry
 * @param {string} label what it is then
 */
export async function goThere(api, {history, tell}, study, place, label) {
  try {
    const patch = difference(study.experiment, await entryExperiment(study.id, place));
    const before = api.experiment;
    await history.change(patch, label);
    // Without an edit the button would undo another one.
    if (same(before, api.experiment)) tell('The live experiment is that already.');
    else tellWithUndo(tell, history, `Set to ${label}.`);
  } catch (error) {
    tell(/** @type {Error} */ (error).message, {error: true});
  }
}
