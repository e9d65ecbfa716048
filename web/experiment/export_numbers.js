// @ts-check
/** The live session, or a whole run, as a file of numbers. */

import {runAs, windowAs} from '../api/requests/downloads.js';
import {ask} from '../dom/dialog.js';
import {fileName, saveFile} from '../dom/save_file.js';

/** @typedef {import('../api/requests/downloads.js').Format} Format */

const WHAT = [
  {value: 'window', text: 'Live session: its last seconds, with every edit'},
  {value: 'run', text: 'Whole run: from 0 s to the horizon'},
];
const FORMATS = [
  {value: 'csv', text: 'CSV: spreadsheets'},
  {value: 'parquet', text: 'Parquet: pandas, Polars, DuckDB'},
  {value: 'mcap', text: 'MCAP: Foxglove, PlotJuggler, ROS 2'},
];
const SECONDS = 'In simulated time: 60 at most, back to the last reset or change of lanes';

/**
 * Ask what is exported, and as what, and save it.
 *
 * @param {import('../api/api.js').Api} api
 */
export function exportNumbers(api) {
  ask('Export numbers', [
    {name: 'what', label: 'What', options: WHAT},
    {name: 'format', label: 'Format', options: FORMATS},
    {name: 'seconds', label: 'Seconds', value: '10', hint: SECONDS, required: true, when: {what: 'window'}},
  ], 'Download', async ({what, format, seconds}, {relabel, signal}) => {
    const chosen = /** @type {Format} */ (format);
    const count = Number(seconds);
    if (what === 'window' && !(count > 0 && count <= 60)) {
      throw new Error(`Seconds must be a number above 0, up to 60; got ${seconds}.`);
    }
    relabel('Being written …');
    try {
      await api.settled();
      const file = await (what === 'run' ? runAs(chosen, signal) : windowAs(chosen, count, signal));
      signal.throwIfAborted();
      const name = fileName(api.preset || api.experiment.title) || 'experiment';
      saveFile(`${name}-${what}.${format}`, file, file.type);
    } finally {
      relabel('Download');
    }
  });
}
