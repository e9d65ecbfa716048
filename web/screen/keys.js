// @ts-check
/** Keys of the whole page. Never while typing in a box. */

import {showDialog} from '../dom/dialog.js';
import {element} from '../dom/element.js';
import {JOINTS} from '../api/arm.js';
import {isKeyAllowed} from '../api/watch_only.js';

/** @typedef {{[key: string]: () => void}} Actions */

/** Joints that have a digit for a key. */
const KEYED = Math.min(JOINTS.length, 9);

const HELP = [
  ['Space', 'Play, pause'],
  ['→', 'One control step (pauses first)'],
  ['Backspace', 'Reset to t = 0'],
  ['K', 'Kick: a push on the joints'],
  ['V', 'Home view of the 3D scene'],
  ['Shift drag', 'In the 3D scene: push the arm where you grab it'],
  ['L', 'Lessons'],
  ['H', 'Edits of this session, and undo'],
  [KEYED > 1 ? `1 to ${KEYED}` : '1', 'Show or hide a joint in the plots'],
  ['A, B', 'Set a cursor in the plots, where the pointer is'],
  ['← →, Shift ← →', 'Move the chosen cursor, a little or more'],
  ['Ctrl Z', 'Undo'],
  ['Ctrl Shift Z, Ctrl Y', 'Redo'],
  ['Ctrl V', 'Import an experiment, or open a link, from the clipboard'],
  ['↑ ↓, Shift ↑ ↓', 'In a number box: one step, ten steps'],
  ['↑ ↓, ← →, Shift ← →', 'On a goal in the list: move its bound, its beginning, its end'],
  ['Esc', 'Discard what is typed; take a drag back; remove cursors; close'],
  ['?', 'This list'],
];

const REPEATED = new Set(['ArrowRight', 'z', 'Z', 'y']);
/** Input types that take no text, so that letters and digits pass. */
const SILENT = new Set(['range', 'checkbox', 'radio', 'button', 'submit', 'file']);

/**
 * @param {EventTarget|null} target
 * @returns {boolean} whether keys belong to what is being typed there
 */
export function isTyping(target) {
  if (!isElement(target)) return false;
  if (target.matches('input')) return !SILENT.has(/** @type {HTMLInputElement} */ (target).type);
  return target.matches('textarea, select, [contenteditable=""], [contenteditable="true"]');
}

/**
 * @param {KeyboardEvent} event
 * @returns {boolean} whether it asks for undo or redo
 */
export function isTravel({key, ctrlKey, metaKey, altKey}) {
  return (ctrlKey || metaKey) && !altKey && /^[yz]$/i.test(key);
}

/**
 * A number box takes back itself what is typed in it; what it took before is the page's to undo.
 *
 * @param {KeyboardEvent} event
 */
function isBoxTravel(event) {
  return isTravel(event) && isElement(event.target) && event.target.matches('.number-box');
}

/**
 * By its look: an element of the scene's frame is an instance of that frame's classes.
 *
 * @param {EventTarget|null} target
 * @returns {target is Element}
 */
function isElement(target) { return target !== null && 'matches' in target; }

/**
 * What has a use of its own for a key keeps it.
 *
 * @param {EventTarget|null} target
 * @param {string} key
 */
function isTaken(target, key) {
  if (!isElement(target)) return false;
  if (key === ' ' || key === 'Enter') {
    return target.matches('button, a[href], summary, input:not([type="range"], [type="radio"]:checked)');
  }
  if (!key.startsWith('Arrow')) return false;
  return target.matches('input, [role="tab"], [role="separator"], [role="slider"]');
}

/** Show what the keys do. */
export function showKeys() {
  const table = element('dl', {class: 'key-list'});
  for (const [keys, meaning] of HELP) {
    const caps = keys.split(', ').map((one) => element('kbd', {}, one));
    table.append(element('dt', {}, ...caps), element('dd', {}, meaning));
  }
  showDialog('Keys', table);
}

/**
 * @param {import('../api/api.js').Api} api
 * @param {import('../api/undo.js').History} history
 * @returns {(event: KeyboardEvent) => void} does what a key asks for
 */
export function keyHandler(api, history) {
  const actions = {
    ' ': () => (api.session?.playing ? api.pause() : api.play()),
    ArrowRight: () => {
      if (api.session?.playing) api.pause();
      api.step(1);
    },
    Backspace: () => api.reset(),
    k: () => api.kick(),
    a: () => setCursor(api, 'A'),
    b: () => setCursor(api, 'B'),
    v: () => { api.dispatchEvent(new CustomEvent('home')); },
    l: () => { api.dispatchEvent(new CustomEvent('learn')); },
    h: () => { api.dispatchEvent(new CustomEvent('edits')); },
    '?': showKeys,
  };
  return (event) => {
    const {key, target} = event;
    if (event.defaultPrevented || document.querySelector('dialog[open], .menu:popover-open')) return;
    if ((isTyping(target) && !isBoxTravel(event)) || !isKeyAllowed(key) || (event.repeat && !REPEATED.has(key))) return;
    const action = event.ctrlKey || event.metaKey
      ? travel(event, history)
      : !event.altKey && (joint(key, api) ?? chosen(actions, key));
    if (!action || isTaken(target, key)) return;
    event.preventDefault();
    action();
  };
}

/**
 * @param {Actions} actions
 * @param {string} key
 */
function chosen(actions, key) {
  const name = key.length === 1 ? key.toLowerCase() : key;
  return Object.hasOwn(actions, name) ? actions[name] : null;
}

/**
 * @param {import('../api/api.js').Api} api
 * @param {'A'|'B'} name
 */
function setCursor(api, name) {
  api.dispatchEvent(new CustomEvent('cursor', {detail: name}));
}

/**
 * @param {string} key
 * @param {import('../api/api.js').Api} api
 */
function joint(key, api) {
  if (!/^[1-9]$/.test(key) || Number(key) > KEYED) return null;
  return () => { api.dispatchEvent(new CustomEvent('joint', {detail: Number(key)})); };
}

/**
 * @param {KeyboardEvent} event
 * @param {import('../api/undo.js').History} history
 */
function travel({key, shiftKey}, history) {
  const letter = key.toLowerCase();
  if (letter === 'z') return () => { (shiftKey ? history.redo() : history.undo()); };
  return letter === 'y' ? () => { history.redo(); } : null;
}
