// @ts-check
/** Borders between columns that can be moved by hand and by arrow keys; double click resets. */

import {element} from '../dom/element.js';
import {recall, remember} from './remembered.js';

const KEY_STEP = 16;

/**
 * @typedef {object} Splitter
 * @property {string} property custom property of the workspace that holds the size in px
 * @property {string} label
 * @property {'vertical'|'horizontal'} line
 * @property {1|-1} way whether the size grows with the coordinate
 * @property {() => HTMLElement} sized the part whose size it sets
 * @property {number} least
 * @property {() => number} most
 */

/**
 * @param {HTMLElement} workspace
 * @param {Splitter} splitter
 * @returns {HTMLElement}
 */
export function splitter(workspace, {property, label, line, way, sized, least, most}) {
  const set = (/** @type {number|null} */ size) => {
    const fitting = size === null ? null : Math.round(Math.min(most(), Math.max(least, size)));
    if (fitting === null) workspace.style.removeProperty(property);
    else workspace.style.setProperty(property, `${fitting}px`);
    remember(property, fitting === null ? null : String(fitting));
  };
  const measured = () => {
    const {width, height} = sized().getBoundingClientRect();
    return line === 'vertical' ? width : height;
  };
  const bar = element('div', {
    class: `splitter is-${line}`, role: 'separator', tabindex: 0, 'aria-label': label,
    'aria-orientation': line, 'aria-valuemin': least, 'data-splits': property.slice(2),
  });
  const at = (/** @type {PointerEvent} */ event) => (
    line === 'vertical' ? event.clientX : event.clientY
  );
  bar.addEventListener('pointerdown', (start) => {
    const [from, size] = [at(start), measured()];
    bar.setPointerCapture(start.pointerId);
    document.body.classList.add('is-splitting');
    const moved = (/** @type {PointerEvent} */ event) => set(size + way * (at(event) - from));
    bar.addEventListener('pointermove', moved);
    bar.addEventListener('lostpointercapture', () => {
      bar.removeEventListener('pointermove', moved);
      document.body.classList.remove('is-splitting');
    }, {once: true});
  });
  bar.addEventListener('dblclick', () => set(null));
  bar.addEventListener('keydown', ({key}) => {
    const [less, more] = line === 'vertical' ? ['ArrowLeft', 'ArrowRight'] : ['ArrowUp', 'ArrowDown'];
    if (key === less) set(measured() - way * KEY_STEP);
    if (key === more) set(measured() + way * KEY_STEP);
    if (key === 'Home') set(null);
  });
  const last = Number(recall(property));
  if (last) set(last);
  new ResizeObserver(() => {
    bar.setAttribute('aria-valuenow', String(Math.round(measured())));
  }).observe(sized());
  return bar;
}

/**
 * @param {HTMLElement} workspace
 * @param {{[name: string]: HTMLElement}} parts
 */
export function mountSplitters(workspace, {tune, plots, metrics}) {
  const third = () => innerWidth * 0.45;
  workspace.append(
    splitter(workspace, {
      property: '--tune-width', label: 'Width of the controls', line: 'vertical', way: 1,
      sized: () => tune, least: 260, most: third,
    }),
    splitter(workspace, {
      property: '--plots-width', label: 'Width of the plots', line: 'vertical', way: -1,
      sized: () => plots, least: 320, most: () => innerWidth * 0.6,
    }),
    splitter(workspace, {
      property: '--metrics-height', label: 'Height of the table', line: 'horizontal', way: -1,
      sized: () => metrics, least: 72, most: () => innerHeight * 0.5,
    }),
  );
}
