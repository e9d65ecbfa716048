// @ts-check
/** What the experiment is and what to look at: a few lines, and all of them when asked. */

import {element, freshId} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {rememberOpen} from '../screen/remembered.js';

/**
 * @param {import('../api/api.js').Api} api
 * @returns {HTMLElement}
 */
export function mountAbout(api) {
  const id = freshId('about');
  const title = element('span', {});
  const text = element('p', {id, class: 'about-text', role: 'note', 'aria-label': 'What to look at'});
  const more = element('button', {
    class: 'about-more', type: 'button', 'aria-controls': id, hidden: true,
    on: {click: () => unfold(!text.classList.contains('is-whole'))},
  });
  const box = element('details', {class: 'about'},
    element('summary', {}, icon('chevron'), title), text, more);
  const unfold = (/** @type {boolean} */ whole) => {
    text.classList.toggle('is-whole', whole);
    more.setAttribute('aria-expanded', String(whole));
    more.textContent = whole ? 'Show less' : 'Read all';
    measure();
  };
  const measure = () => {
    const whole = text.classList.contains('is-whole');
    more.hidden = !whole && text.scrollHeight <= text.clientHeight;
  };
  const show = () => {
    title.textContent = api.experiment.title || api.preset || 'Untitled experiment';
    const words = asParagraphs(api.experiment.description) || 'No description.';
    if (words === text.textContent) return;
    text.textContent = words;
    unfold(false);
  };
  rememberOpen(box, 'about', true);
  new ResizeObserver(measure).observe(text);
  api.addEventListener('hello', show);
  api.addEventListener('patch', show);
  return box;
}

/**
 * Lines broken for a file's width flow together again; empty lines stay.
 *
 * @param {string} text
 */
function asParagraphs(text) { return text.trim().replace(/(?<!\n)\n(?![\n*-])/g, ' '); }
