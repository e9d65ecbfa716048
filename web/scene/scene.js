// @ts-check
/** The 3D scene and what is laid over it. */

import {BOUNDS} from '../api/schema_document.js';
import {element, freshId} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {bare, goHome, holdShift} from './frame.js';

const ADDRESS = {light: '/scene/', dark: '/scene/?darkMode'};
const MOST = BOUNDS.exaggeration;
const PUSH = 'Drag the arm to push it, with the mouse or with a finger. Without this switch: '
  + 'hold Shift and drag the arm.';

/**
 * @param {HTMLElement} place
 * @param {import('../api/api.js').Api} api
 * @param {(event: KeyboardEvent) => void} pressed keys pressed in the scene count as well
 */
export function mount(place, api, pressed) {
  const frame = element('iframe', {title: '3D scene', class: 'scene-frame'});
  const veil = element('p', {class: 'scene-veil', role: 'status'}, 'Loading the scene…');
  const push = element('input', {type: 'checkbox', role: 'switch', class: 'switch'});
  frame.addEventListener('load', () => {
    if (!frame.src) return;
    bare(frame);
    holdShift(frame, () => push.checked);
    veil.hidden = true;
    // Arrows move the camera there.
    frame.contentWindow?.addEventListener('keydown', (event) => {
      if (!event.key.startsWith('Arrow')) pressed(event);
    });
  });
  // Only once it can be seen: on a telephone the scene is behind a tab.
  const load = () => {
    const address = ADDRESS[document.documentElement.dataset.theme === 'dark' ? 'dark' : 'light'];
    if (place.clientWidth && frame.getAttribute('src') !== address) frame.src = address;
  };
  new ResizeObserver(load).observe(place);
  new MutationObserver(load).observe(document.documentElement, {attributeFilter: ['data-theme']});
  const home = () => { if (frame.src) goHome(frame); };
  api.addEventListener('home', home);
  place.append(frame, veil, homeButton(home), bar(api, push));
}

/** @param {() => void} home */
function homeButton(home) {
  return element('button', {
    type: 'button', class: 'button icon-only scene-home', 'aria-label': 'Home view',
    title: 'Home view: reset the camera (V)', on: {click: home},
  }, icon('home'));
}

/**
 * @param {import('../api/api.js').Api} api
 * @param {HTMLInputElement} push
 */
function bar(api, push) {
  const id = freshId('exaggeration');
  const value = element('output', {for: id});
  const slider = element('input', {
    id, type: 'range', class: 'slider', min: 0, max: 100, step: 1,
    on: {input: () => later(() => api.view({exaggeration: along(slider.valueAsNumber)}))},
  });
  const ghosts = element('input', {
    type: 'checkbox', role: 'switch', class: 'switch',
    on: {change: () => api.view({ghosts: ghosts.checked})},
  });
  const write = (/** @type {number} */ times) => {
    const text = times === 1 ? 'deviations true to scale' : `deviations shown ${times}× larger`;
    value.textContent = text;
    slider.setAttribute('aria-valuetext', text);
    slider.style.setProperty('--to', String(slider.valueAsNumber / 100));
  };
  slider.addEventListener('input', () => write(along(slider.valueAsNumber)));
  slider.addEventListener('dblclick', () => { api.view({exaggeration: 1}); show(); });
  const show = () => {
    const {exaggeration, ghosts: on} = api.drawn;
    if (document.activeElement !== slider || exaggeration === 1) {
      slider.value = String((100 * Math.log(exaggeration)) / Math.log(MOST));
    }
    write(exaggeration);
    ghosts.checked = on;
  };
  api.addEventListener('hello', show);
  api.addEventListener('state', show);
  const label = element('label', {for: id, class: 'visually-hidden'}, 'Exaggeration of deviations');
  const lanes = element('label', {class: 'scene-ghosts'}, ghosts, 'ghosts');
  const pushes = element('label', {class: 'scene-ghosts', title: PUSH}, push, 'push');
  return element('div', {class: 'scene-bar'}, label, slider, value, lanes, pushes);
}

/**
 * @param {number} percent of the slider
 * @returns {number} 1 to the greatest, evenly in its logarithm
 */
function along(percent) {
  const times = MOST ** (percent / 100);
  return times < 10 ? Math.round(times * 10) / 10 : Math.round(times);
}

let waiting = 0;

/** @param {() => void} run at the next frame, the last one wins */
function later(run) {
  cancelAnimationFrame(waiting);
  waiting = requestAnimationFrame(run);
}
