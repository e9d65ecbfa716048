// @ts-check
/** Whole runs that the server makes beside the live session; while watching: the owner's last. */

import {request, requestLines} from './http.js';
import {isWatching} from './watch_only.js';

/** @typedef {import('../fields/merge_patch.js').Document} Document */

/** Asks for runs. */
export class Runs {
  #api;

  /** @param {import('./api.js').Api} api */
  constructor(api) { this.#api = api; }

  /**
   * Run a lane over its horizon and look at it; while watching: what the owner last saw.
   *
   * @param {string} lane
   * @param {('sliding'|'network'|'chattering'|'prediction')[]} lenses
   * @param {{experiment?: Document, patch?: Document, signal?: AbortSignal}} [options] sent along,
   *   so that the server's may be another by then; `patch`: what is different in it
   * @returns {Promise<Document>} what each lens saw, under its name; null when it was given up
   */
  lens(lane, lenses, {experiment = this.#api.experiment, patch = {}, signal} = {}) {
    if (isWatching()) {
      const query = new URLSearchParams({lane, lens: lenses[0]});
      return request('GET', `/api/results/lens?${query}`, undefined, signal);
    }
    return request('POST', '/api/lens', {lane, lenses, patch, experiment}, signal);
  }

  /**
   * From which boundary layer on a lane is silent, without a run; the owner's own question.
   *
   * @param {string} lane
   * @returns {Promise<Document>} `threshold`: `common` and `joints` in [rad/s], or null
   */
  threshold(lane) {
    return request('POST', '/api/threshold', {lane, experiment: this.#api.experiment});
  }

  /**
   * Many short runs, told as they end; see the kinds at the server's `/api/studies`.
   *
   * @param {'strip'|'sensitivity'|'switching'} kind
   * @param {Document} body
   * @param {(row: Document) => void} onRow
   * @param {AbortSignal} [signal]
   * @returns {Promise<void>} kept when all runs have ended
   */
  study(kind, body, onRow, signal) {
    return requestLines(`/api/studies/${kind}`, body, onRow, signal);
  }

  /**
   * Run every lane over its horizon; while watching: the owner's last response. Of two at once for
   * one purpose the server gives up the older.
   *
   * @param {{experiment?: Document, estimate?: boolean, show?: boolean|null}} body
   * @param {AbortSignal} [signal]
   * @param {string} [purpose]
   * @returns {Promise<ArrayBuffer|null>} see preview_message.js; null when it was given up
   */
  preview(body, signal, purpose = 'preview') {
    if (isWatching()) return request('GET', '/api/results/response', undefined, signal);
    return request('POST', '/api/preview', {...body, client: `${this.#api.client} ${purpose}`}, signal);
  }
}
