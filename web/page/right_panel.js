// @ts-check
/** The right column: one of several views at a time, chosen by tabs. All of them stay mounted. */

import {element, freshId} from '../dom/element.js';
import {mount as mountLenses} from '../lenses/lenses.js';
import {mount as mountPlots} from '../live/live_plots.js';
import {recall, remember} from '../screen/remembered.js';
import {mount as mountResponse} from '../response/response.js';
import {mount as mountStudies} from '../studies/studies.js';

/** @typedef {import('../api/api.js').Api} Api */
/**
 * What a view may use beside the server: whole responses, logs of the real arm, undo, presets, and a
 * word in the corner.
 * @typedef {{preview: import('../api/preview.js').Preview,
 *   before: import('../response/before.js').ResponseBefore,
 *   logs: import('../logs/logs.js').Logs,
 *   history: import('../api/undo.js').History, presets: import('../experiment/presets.js').Presets,
 *   tell: import('../dom/notices.js').Tell}} Desk
 */
/**
 * A view's own tab: choose it, or mark that there is something new behind it.
 * @typedef {{open: () => void, mark: (news: boolean) => void}} Tab
 */
/**
 * A hidden view has no size, so that it draws and asks for nothing; it begins to when it is shown.
 * @typedef {{id: string, title: string,
 *   mount: (element: HTMLElement, api: Api, desk: Desk & {tab: Tab}) => void}} Entry
 */

/** @type {Entry[]} A further view is a line here. */
export const ENTRIES = [
  {id: 'live', title: 'Live', mount: mountPlots},
  {id: 'response', title: 'Response', mount: mountResponse},
  {id: 'lenses', title: 'Lenses', mount: mountLenses},
  {id: 'studies', title: 'Studies', mount: mountStudies},
];

/**
 * @param {HTMLElement} root
 * @param {Api} api
 * @param {Desk} desk
 * @param {Entry[]} [entries]
 */
export function mount(root, api, desk, entries = ENTRIES) {
  const views = entries.map((entry) => {
    const place = element('div', {id: freshId('right-view'), class: 'right-view', role: 'tabpanel'});
    const tab = element('button', {
      id: freshId('right-tab'), type: 'button', role: 'tab', class: 'right-tab',
      'data-view': entry.id, 'aria-controls': place.id, on: {click: () => choose(entry.id)},
    }, entry.title);
    place.setAttribute('aria-labelledby', tab.id);
    return {entry, place, tab};
  });
  const choose = (/** @type {string} */ id) => {
    for (const {entry, place, tab} of views) {
      const chosen = entry.id === id;
      place.hidden = !chosen;
      tab.setAttribute('aria-selected', String(chosen));
      tab.tabIndex = chosen ? 0 : -1;
    }
    remember('right.view', id);
  };
  const row = element('div', {
    class: 'right-tabs', role: 'tablist', 'aria-label': 'Views of the right column',
    on: {keydown: (event) => moved(event, views.map(({tab}) => tab))},
  }, ...views.map(({tab}) => tab));
  root.classList.add('right-panel');
  root.append(row, ...views.map(({place}) => place));
  api.addEventListener('show', (event) => (
    choose(/** @type {CustomEvent} */ (event).detail.view ?? 'live')
  ));
  const last = recall('right.view');
  choose(entries.find(({id}) => id === last)?.id ?? entries[0].id);
  for (const {entry, place, tab} of views) {
    const open = () => choose(entry.id);
    entry.mount(place, api, {...desk, tab: {open, mark: (news) => mark(tab, news)}});
  }
}

/**
 * @param {HTMLElement} tab
 * @param {boolean} news
 */
function mark(tab, news) {
  if (news === Boolean(tab.querySelector('.right-news'))) return;
  if (!news) { tab.querySelector('.right-news')?.remove(); return; }
  tab.append(element(
    'span', {class: 'right-news'}, element('span', {class: 'visually-hidden'}, ' changed'),
  ));
}

/**
 * @param {KeyboardEvent} event
 * @param {HTMLButtonElement[]} tabs
 */
function moved(event, tabs) {
  const at = tabs.findIndex((tab) => tab === document.activeElement);
  const to = new Map([
    ['ArrowRight', (at + 1) % tabs.length],
    ['ArrowLeft', (at - 1 + tabs.length) % tabs.length],
    ['Home', 0],
    ['End', tabs.length - 1],
  ]).get(event.key);
  if (to === undefined) return;
  event.preventDefault();
  // The page takes arrow keys for itself elsewhere.
  event.stopPropagation();
  tabs[to].focus();
  tabs[to].click();
}
