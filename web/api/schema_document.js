// @ts-check
/** The experiment's JSON Schema, which is there before anything of the page is built. */

import {askForSchema} from './api.js';

const RETRY_MS = 1000;

/**
 * With the laws in `x-laws`, the figures of a lane in `x-figures` and further bounds in `x-bounds`.
 *
 * @type {import('../fields/merge_patch.js').Document}
 */
export const SCHEMA = await published();
/** @type {{lane_name: number, preset_name: number, exaggeration: number}} */
export const BOUNDS = SCHEMA['x-bounds'];

/** @param {import('../fields/merge_patch.js').Document} next what the server publishes now */
export function replaceSchema(next) {
  for (const key of Object.keys(SCHEMA)) delete SCHEMA[key];
  Object.assign(SCHEMA, next);
}

async function published() {
  for (;;) {
    try {
      return await askForSchema();
    } catch {
      // Without it there is no page: a server that is busy is asked again.
      await new Promise((done) => { setTimeout(done, RETRY_MS); });
    }
  }
}
