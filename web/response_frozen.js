// @ts-check
/** Which lanes left their bounds in the whole response: when, where and why, in words. */

import {element} from './element.js';

/** @typedef {import('./preview_message.js').Response} Response */

/** A list that is there when there is something to say. */
export class ResponseFrozen {
  element = element('ul', {class: 'response-frozen', 'aria-live': 'polite', hidden: true});
  #shown = '';

  /**
   * @param {import('./api.js').Lane[]} lanes
   * @param {Response|null} response
   */
  show(lanes, response) {
    const said = lanes.flatMap(({name, color}) => {
      const frozen = response?.lanes.get(name)?.frozen;
      return frozen ? [{name, color, cause: frozen.cause}] : [];
    });
    const shown = JSON.stringify(said);
    if (shown === this.#shown) return;
    this.#shown = shown;
    this.element.hidden = !said.length;
    this.element.replaceChildren(...said.map(({name, color, cause}) => {
      const dot = element('span', {class: 'plots-dot', 'aria-hidden': 'true'});
      dot.style.setProperty('--lane', color);
      return element('li', {}, dot, element('b', {}, name), element('span', {}, cause));
    }));
  }
}
