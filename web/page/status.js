// @ts-check
/** Whether it is live, how fast, at what time; and what to do when the line is lost. */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';

/** Without a word from the server for this long, say so. */
const SILENCE_MS = 3000;
/** A little less than asked is rounding. */
const BEHIND = 0.97;

/**
 * @param {HTMLElement} place
 * @param {import('../api/api.js').Api} api
 */
export function mountStatus(place, api) {
  const lamp = element('span', {class: 'lamp'});
  const word = element('span', {class: 'status-word'});
  const factor = element('span', {class: 'status-factor'});
  const time = element('span', {class: 'status-time'});
  const capped = element('span', {class: 'status-capped', role: 'status'});
  const revision = element('span', {class: 'status-revision', 'data-revision': '0'});
  place.append(capped, element('span', {class: 'status-live'}, lamp, word, factor), time, revision);
  let heard = performance.now();

  const show = () => {
    const {session, connected} = api;
    const silent = connected && performance.now() - heard > SILENCE_MS;
    const text = wording(connected, silent, session?.playing ?? false);
    if (word.textContent !== text) word.textContent = text;
    lamp.dataset.lamp = text;
    if (!session) return;
    const running = connected && session.playing;
    factor.textContent = running ? `${session.real_time_factor.toFixed(2)}×` : '';
    time.replaceChildren(element('i', {class: 'symbol'}, 't'), ` ${session.time.toFixed(2)} s`);
    const behind = running && session.capped && session.real_time_factor < BEHIND * session.speed;
    warn(capped, behind ? `${session.real_time_factor.toFixed(2)}×` : '', session.speed);
  };
  const showRevision = () => {
    revision.dataset.revision = String(api.revision);
    revision.textContent = `rev ${api.revision}`;
    revision.title = `Revision ${api.revision} of the experiment`;
  };
  for (const type of ['hello', 'patch', 'state']) {
    api.addEventListener(type, () => { heard = performance.now(); show(); showRevision(); });
  }
  // Which revision the newest rows on the screen were computed with.
  api.addEventListener('frame', (event) => {
    revision.dataset.frame = String(/** @type {CustomEvent} */ (event).detail.revision);
  });
  api.addEventListener('connection', show);
  setInterval(show, SILENCE_MS / 2);
  show();
}

/**
 * @param {HTMLElement} badge
 * @param {string} factor reached, or '' where there is nothing to warn of
 * @param {number} asked
 */
function warn(badge, factor, asked) {
  if (badge.dataset.factor === factor) return;
  badge.dataset.factor = factor;
  badge.title = factor ? `slower than requested: ${factor} of ${asked}×` : '';
  const words = (/** @type {string} */ text) => element('span', {class: 'wide-only'}, text);
  const text = [element('span', {class: 'narrow-only'}, 'slow '), words('slower than requested: '),
    factor, words(` of ${asked}×`)];
  badge.replaceChildren(...(factor ? text : []));
}

/**
 * @param {boolean} connected
 * @param {boolean} silent
 * @param {boolean} playing
 */
function wording(connected, silent, playing) {
  if (!connected) return 'offline';
  if (silent) return 'no answer';
  return playing ? 'live' : 'paused';
}

/**
 * @param {HTMLElement} place
 * @param {import('../api/api.js').Api} api
 */
export function mountBanner(place, api) {
  const text = element('span', {});
  // Not for listeners: it would be read out every second.
  const countdown = element('span', {'aria-hidden': 'true'});
  const retry = element('button', {
    class: 'button small', type: 'button', on: {click: () => api.reconnect()},
  }, 'Try now');
  const box = element('div', {class: 'banner', hidden: true}, icon('warning'), text, countdown, retry);
  place.append(box);
  let ticking = 0;
  api.addEventListener('connection', (event) => {
    const {connected, reason, wait} = /** @type {CustomEvent} */ (event).detail;
    clearInterval(ticking);
    box.hidden = connected;
    document.body.classList.toggle('is-offline', !connected);
    if (connected) return;
    const until = performance.now() + wait * 1000;
    const count = () => {
      const left = Math.ceil((until - performance.now()) / 1000);
      countdown.textContent = left > 0 ? `Trying again in ${left} s.` : 'Trying…';
    };
    if (text.textContent !== reason) text.textContent = reason;
    ticking = setInterval(count, 1000);
    count();
  });
}
