// @ts-check
/** Follows one study: its entries as they come, and now and then what they show together. */

import {followStudy, isUnderWay, oneStudy} from '../api/requests/studies.js';

/** @typedef {import('../api/requests/studies.js').Study} Study */
/** @typedef {import('../api/requests/studies.js').Summary} Summary */
/** @typedef {import('../api/requests/studies.js').Entry} Entry */

/** Least time between two redraws in [ms]; ours. */
const REDRAW_MS = 250;
/** Least time between two looks at the whole of a running study in [ms]; ours. */
const WHOLE_MS = 1000;

/** Events: `change`, there is news; `lost`, `lost` says that the server can't be heard, or ''. */
export class StudyFeed extends EventTarget {
  /** @type {Study|null} */ study = null;
  /** @type {Entry[]} */ entries = [];
  /** Why there is no news, or ''. */
  lost = '';
  #id;
  /** @type {Summary|null} */ #summary = null;
  #leave = () => {};
  #closed = false;
  #asking = false;
  /** What the whole that was asked for last was of. */ #known = '';
  #asked = -Infinity;
  /** @type {ReturnType<typeof setTimeout>|undefined} */ #redraw;
  /** @type {ReturnType<typeof setTimeout>|undefined} */ #again;

  /** @param {number} id */
  constructor(id) {
    super();
    this.#id = id;
  }

  /** Begin, or begin anew after the study goes on or the server is back. */
  follow() {
    this.#leave();
    this.#known = '';
    this.#leave = followStudy(this.#id, (summary, entries, first) => {
      this.entries.splice(first, Infinity, ...entries);
      this.#summary = summary;
      this.#lose('');
      this.#ask();
      this.#soon();
    }, (message) => this.#lose(message || 'The server can’t be heard. It is tried again …'));
  }

  /** Stop following. */
  close() {
    this.#closed = true;
    this.#leave();
    clearTimeout(this.#redraw);
    clearTimeout(this.#again);
  }

  /** Ask for the whole when it is another one, though not too often. */
  #ask() {
    const summary = this.#summary;
    if (!summary || this.#asking || this.#closed) return;
    const news = `${summary.state} ${summary.made}`;
    if (news === this.#known) return;
    clearTimeout(this.#again);
    const wait = isUnderWay(summary) ? this.#asked + WHOLE_MS - performance.now() : 0;
    if (wait > 0) this.#again = setTimeout(() => this.#ask(), wait);
    else this.#look(news);
  }

  /** @param {string} news */
  async #look(news) {
    this.#asking = true;
    this.#asked = performance.now();
    try {
      const study = await oneStudy(this.#id);
      this.#known = news;
      this.study = study;
      this.#lose('');
      this.#soon();
    } catch (error) {
      this.#lose(/** @type {Error} */ (error).message);
    }
    this.#asking = false;
    // Without an answer the next news asks again.
    if (!this.lost) this.#ask();
  }

  #soon() {
    if (this.#closed) return;
    this.#redraw ??= setTimeout(() => {
      this.#redraw = undefined;
      if (!this.study || !this.#summary) return;
      this.study = {...this.study, ...this.#summary};
      this.dispatchEvent(new Event('change'));
    }, REDRAW_MS);
  }

  /** @param {string} text */
  #lose(text) {
    if (this.#closed || text === this.lost) return;
    this.lost = text;
    this.dispatchEvent(new Event('lost'));
  }
}
