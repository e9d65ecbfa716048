// @ts-check
/** Files of laws of one's own: what became of each when it was saved, and its errors in full. */

import {element} from '../dom/element.js';

/** @typedef {import('../api/api.js').LawFile} LawFile */

const KEPT = 'The last good version is in use.';

/**
 * @param {import('../api/api.js').Api} api
 * @returns {HTMLElement}
 */
export function mountLawFiles(api) {
  const box = element('div', {class: 'law-files', role: 'status', 'aria-label': 'Your own laws'});
  let shown = '';
  const show = () => {
    const text = JSON.stringify(api.lawFiles);
    if (text === shown) return;
    shown = text;
    box.replaceChildren(...api.lawFiles.map(row));
  };
  api.addEventListener('hello', show);
  api.addEventListener('laws', show);
  show();
  return box;
}

/** @param {LawFile} file */
function row({file, state, message, trace}) {
  const words = {good: 'in use', trying: 'being tried …', refused: 'refused'};
  const head = element('p', {class: 'law-file-head'},
    element('code', {}, file), element('span', {class: 'law-file-state'}, words[state]));
  const why = message && element('p', {class: 'law-file-why'}, message);
  const way = trace && element('pre', {class: 'law-trace', tabindex: '0'}, trace);
  const kept = state === 'refused' && element('p', {class: 'law-file-kept'}, KEPT);
  return element('div', {class: 'law-file', 'data-state': state}, head, why, way, kept);
}
