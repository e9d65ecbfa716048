// @ts-check
/** A report of the live experiment as one HTML file. */

import {reportOf} from '../api/requests/downloads.js';
import {fileName, saveFile} from '../dom/save_file.js';

/** Whether one is being made: a second click asks for no second one. */
let making = false;

/**
 * Have it made, which takes some seconds, and save it.
 *
 * @param {import('../api/api.js').Api} api
 * @param {import('../dom/notices.js').Tell} tell
 */
export async function saveReport(api, tell) {
  if (making) return;
  making = true;
  const takeBack = tell('The report is being made: the whole run, its plots and a replay …', {stays: true});
  try {
    await api.settled();
    const {preset, experiment} = api;
    const name = fileName(preset || experiment.title) || 'experiment';
    saveFile(`${name}-report.html`, await reportOf(), 'text/html');
  } catch (error) {
    tell(/** @type {Error} */ (error).message, {error: true});
  } finally {
    making = false;
    takeBack();
  }
}
