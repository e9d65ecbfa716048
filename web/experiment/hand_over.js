// @ts-check
/** What a real controller needs to run a lane's gains, as an archive. */

import {handOver as packageOf} from '../api/requests/downloads.js';
import {ask} from '../dom/dialog.js';
import {fileName, saveFile} from '../dom/save_file.js';

const CONTENT = 'The law in C and Python with these gains, also for ros2_control, the conditions '
  + 'under which they were tuned, and a check of both';
const DRAWS = 'Runs at drawn values of what the experiment calls uncertain, told in conditions.md; '
  + '0 to 200';

/**
 * Ask as what a lane is handed over, and save the archive.
 *
 * @param {import('../api/api.js').Api} api
 * @param {string} lane
 */
export function handOver(api, lane) {
  const {uncertainty = {}} = api.experiment;
  const uncertain = Object.values(uncertainty).some(Array.isArray);
  const questions = [{
    name: 'controller', label: 'Name of the controller', value: 'slidetune_controller',
    hint: CONTENT, required: true,
  }];
  if (uncertain) questions.push({
    name: 'draws', label: 'Draws', value: '40', hint: DRAWS, required: true,
  });
  ask(`Hand over ${lane}`, questions, 'Download', async ({controller, draws = '0'}, {relabel, signal}) => {
    const count = Number(draws);
    if (!Number.isInteger(count) || count < 0) {
      throw new Error(`Draws must be a whole number, 0 to 200; got ${draws}.`);
    }
    relabel('Being made …');
    try {
      await api.settled();
      const archive = await packageOf(lane, controller.trim(), count, signal);
      signal.throwIfAborted();
      saveFile(`${fileName(lane) || 'lane'}.zip`, archive, 'application/zip');
    } finally {
      relabel('Download');
    }
  });
}
