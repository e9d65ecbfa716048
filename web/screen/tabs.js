// @ts-check
/** On a narrow screen one part at a time, chosen by tabs. */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {recall, remember} from './remembered.js';

/** @typedef {{id: string, label: string, icon: import('../dom/icons.js').IconName}} Tab */

/** @type {Tab[]} */
const TABS = [
  {id: 'tune', label: 'Tune', icon: 'tune'},
  {id: 'scene', label: '3D', icon: 'cube'},
  {id: 'plots', label: 'Plots', icon: 'plots'},
  {id: 'metrics', label: 'Metrics', icon: 'table'},
];

/**
 * @param {HTMLElement} place
 * @param {HTMLElement} workspace its `data-tab` says which part is chosen
 * @param {import('../api/api.js').Api} api its event `show` is about the plots, `goal` about a form
 */
export function mountTabs(place, workspace, api) {
  const choose = (/** @type {string} */ id) => {
    workspace.dataset.tab = id;
    remember('tab', id);
    for (const button of buttons) {
      const chosen = button.dataset.tab === id;
      button.setAttribute('aria-selected', String(chosen));
      button.tabIndex = chosen ? 0 : -1;
    }
  };
  const buttons = TABS.map(({id, label, icon: name}) => element('button', {
    class: 'tab', type: 'button', role: 'tab', 'data-tab': id, 'aria-controls': id,
    on: {click: () => choose(id)},
  }, icon(name), element('span', {}, label)));
  place.append(...buttons);
  place.addEventListener('keydown', ({key}) => {
    const way = {ArrowRight: 1, ArrowLeft: -1}[key];
    if (!way) return;
    const at = TABS.findIndex(({id}) => id === workspace.dataset.tab);
    const next = (at + way + TABS.length) % TABS.length;
    choose(TABS[next].id);
    buttons[next].focus();
  });
  api.addEventListener('show', () => choose('plots'));
  api.addEventListener('goal', () => choose('tune'));
  const last = recall('tab');
  choose(TABS.find(({id}) => id === last)?.id ?? 'tune');
}
