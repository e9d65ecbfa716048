// @ts-check
/** A page that may watch and nothing else: it says so, offers no change and asks for none. */

import {element} from '../dom/element.js';

/** Said wherever a change is tried all the same. */
export const WATCH_ONLY = 'You are watching: this address shows the live session and changes nothing. '
  + 'Whoever started Slidetune has the address that does.';

/** Said of what would take runs of its own. */
export const RUNS_ARE_THE_OWNERS = 'Only the owner’s page can start runs.';

/** Whose keys work: joints, cursors, the camera, the list of edits and that of keys. */
const KEYS = new Set([...'123456789', 'a', 'b', 'h', 'v', '?']);
/** What would change something. What makes no sense while watching is hidden by watch_only.css. */
const CONTROLS = [
  ':is(.gains, .sections) :is(input, select, textarea, button:not(.disclosure))',
  '.transport :is(button, input, select)', '.scene-bar input', '.preset-button',
].join(', ');

let watching = false;

/** @returns {boolean} whether the server lets this page watch only */
export function isWatching() { return watching; }

/**
 * The server has said what this page may do. A page that has another role than before begins anew.
 *
 * @param {string} role `owner` or `viewer`
 * @param {boolean} again whether it said so before
 */
export function takeRole(role, again) {
  const now = role === 'viewer';
  if (again && now !== watching) location.reload();
  watching = now;
}

/**
 * What a watching page shows was computed for the owner's.
 *
 * @param {string} what
 * @param {number} of its revision
 * @param {number} now the experiment's
 * @returns {string}
 */
export function ownersLast(what, of, now) {
  const text = `the owner’s last ${what}, rev ${of}`;
  return of < now ? `${text}; out of date, the experiment is at rev ${now}` : text;
}

/**
 * @param {string} key
 * @returns {boolean} whether it does something that is allowed
 */
export function isKeyAllowed(key) { return !watching || KEYS.has(key.toLowerCase()); }

/**
 * @param {import('./api.js').Api} api
 * @param {HTMLElement[]} parts of the screen that hold controls
 */
export function mountWatchOnly(api, parts) {
  api.addEventListener('hello', () => {
    if (!watching || document.body.classList.contains('is-watching')) return;
    document.body.classList.add('is-watching');
    const badge = element('span', {class: 'watching', role: 'status', title: WATCH_ONLY}, 'Watching');
    document.querySelector('.header .status')?.before(badge);
    // On a narrow screen one part is seen at a time: not the one that can't be used.
    /** @type {HTMLElement|null} */ (document.querySelector('.tab[data-tab="plots"]'))?.click();
    for (const part of parts) keepDisabled(part);
  });
}

/** @param {HTMLElement} part */
function keepDisabled(part) {
  const disable = () => {
    for (const control of part.querySelectorAll(CONTROLS)) {
      if (!control.hasAttribute('disabled')) control.setAttribute('disabled', '');
    }
  };
  // Controls come and go with lanes, and enable themselves.
  new MutationObserver(disable).observe(part, {
    childList: true, subtree: true, attributes: true, attributeFilter: ['disabled'],
  });
  disable();
}
