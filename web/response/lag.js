// @ts-check
/** Curves and figures that are still those of a former experiment are drawn as such. */

import {isWatching} from '../api/watch_only.js';

/** A response that is late by less is on its way, as during a drag; ours. */
const LAG_MS = 500;

/**
 * Give an element the class `is-behind` while the response is another experiment's than the live
 * one and no newer one has come for a while. A page that watches says so in words: there it may stay
 * behind for long, and is to be read.
 *
 * @param {HTMLElement} root
 * @param {import('../api/preview.js').Preview} preview
 * @param {import('../api/api.js').Api} api
 */
export function markLag(root, preview, api) {
  /** @type {ReturnType<typeof setTimeout>|undefined} */
  let timer;
  const arrived = () => {
    clearTimeout(timer);
    timer = undefined;
    root.classList.remove('is-behind');
  };
  const compare = () => {
    const {latest} = preview;
    const isBehind = latest !== null && latest.revision !== api.revision;
    if (isBehind && !isWatching()) timer ??= setTimeout(() => root.classList.add('is-behind'), LAG_MS);
    else arrived();
  };
  preview.addEventListener('response', () => { arrived(); compare(); });
  for (const type of ['patch', 'hello']) api.addEventListener(type, compare);
}
