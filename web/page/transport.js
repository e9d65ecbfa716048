// @ts-check
/** Play, step, reset, kick, and how fast. */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10];

/**
 * @param {import('../dom/icons.js').IconName} name
 * @param {string} label
 * @param {string} title
 * @param {() => void} run
 */
function key(name, label, title, run) {
  return element('button', {class: 'button', type: 'button', title, on: {click: run}},
    icon(name), element('span', {}, label));
}

/**
 * @param {HTMLElement} place
 * @param {import('../api/api.js').Api} api
 */
export function mount(place, api) {
  const play = key('play', 'Play', 'Play or pause (space)', () => (
    api.session?.playing ? api.pause() : api.play()
  ));
  play.classList.add('primary', 'play');
  const step = key('step', 'Step', 'One control step (→)', () => {
    if (api.session?.playing) api.pause();
    api.step(1);
  });
  const reset = key('reset', 'Reset', 'Back to t = 0 (Backspace)', () => api.reset());
  const kick = key('kick', 'Kick', 'Push the joints for a moment (K)', () => api.kick());
  const speed = element('select', {
    class: 'select', 'aria-label': 'Speed', title: 'Speed, as a multiple of real time',
    on: {change: () => api.speed(Number(speed.value))},
  }, ...SPEEDS.map((value) => element('option', {value}, `${value}×`)));
  place.append(play, step, reset, kick, element('div', {class: 'spring'}), speed);

  const show = () => {
    const {session} = api;
    if (!session) return;
    const name = session.playing ? 'pause' : 'play';
    if (play.dataset.shows !== name) {
      play.dataset.shows = name;
      const word = session.playing ? 'Pause' : 'Play';
      play.replaceChildren(icon(name), element('span', {}, word));
    }
    if (document.activeElement !== speed) showSpeed(speed, session.speed);
  };
  for (const type of ['hello', 'state']) api.addEventListener(type, show);
}

/**
 * @param {HTMLSelectElement} select
 * @param {number} speed any that the server allows, also one that is not in the list
 */
function showSpeed(select, speed) {
  const value = String(speed);
  if (select.value === value) return;
  if (![...select.options].some((option) => option.value === value)) {
    select.append(element('option', {value}, `${value}×`));
  }
  select.value = value;
}
