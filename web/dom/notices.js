// @ts-check
/** Messages in words that belong to no control; they stay long enough to be read. */

import {element} from './element.js';
import {icon} from './icons.js';

const STAY_MS = 12_000;
const MOST = 4;

/** @typedef {{label: string, run: () => void}} Action */
/**
 * `stays`: until it is dismissed, as what offers something once.
 * @typedef {(text: string, options?: {error?: boolean, action?: Action, stays?: boolean})
 *   => (() => void)} Tell says it, and returns what takes it back
 */

/**
 * @param {HTMLElement} place
 * @returns {Tell}
 */
export function mountNotices(place) {
  place.classList.add('notices');
  return (text, {error = false, action, stays = false} = {}) => {
    for (const shown of place.querySelectorAll('.notice')) {
      if (shown.querySelector('.notice-text')?.textContent === text) shown.remove();
    }
    const box = notice(text, error, action, stays);
    place.append(box);
    while (place.children.length > MOST) place.firstElementChild?.remove();
    return () => box.remove();
  };
}

/**
 * @param {string} text
 * @param {boolean} error
 * @param {Action|undefined} action
 * @param {boolean} stays
 */
function notice(text, error, action, stays) {
  const remove = () => box.remove();
  const act = action && element('button', {
    class: 'button small', type: 'button',
    on: {click: () => { remove(); action.run(); }},
  }, action.label);
  const close = element('button', {
    class: 'button icon-only small', type: 'button', 'aria-label': 'Dismiss', on: {click: remove},
  }, icon('close'));
  const box = element('div', {
    class: error ? 'notice is-error' : 'notice', role: error ? 'alert' : 'status',
  }, element('span', {class: 'notice-text'}, text), act, close);
  if (stays) return box;
  let timer = setTimeout(remove, STAY_MS);
  box.addEventListener('pointerenter', () => clearTimeout(timer));
  box.addEventListener('focusin', () => clearTimeout(timer));
  box.addEventListener('pointerleave', () => { timer = setTimeout(remove, STAY_MS); });
  return box;
}
