// @ts-check
/** The first stops of the Tab key: past everything else to what one came for. */

import {element} from '../dom/element.js';

const LINKS = [
  {label: 'Skip to controls', part: 'tune', to: 'summary'},
  {label: 'Skip to play', part: 'transport', to: 'button'},
  {label: 'Skip to plots', part: 'plots', to: '[role="tab"][aria-selected="true"]'},
];

/**
 * @param {HTMLElement} place
 * @param {HTMLElement} workspace holds the parts
 */
export function mountSkipLinks(place, workspace) {
  place.append(...LINKS.map(({label, part, to}) => element('a', {
    class: 'button', href: `#${part}`,
    on: {
      click: (event) => {
        event.preventDefault();
        visible(document, `.tab[data-tab="${part}"]`)?.click();
        visible(workspace, `#${part} ${to}`)?.focus();
      },
    },
  }, label)));
}

/**
 * @param {ParentNode} place
 * @param {string} selector
 * @returns {HTMLElement|undefined} the first one that can be seen
 */
function visible(place, selector) {
  const found = /** @type {HTMLElement[]} */ ([...place.querySelectorAll(selector)]);
  return found.find((node) => node.checkVisibility());
}
