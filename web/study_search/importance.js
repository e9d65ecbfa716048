// @ts-check
/** How much each gain counted, as bars. */

import {element} from '../dom/element.js';
import {gainName} from '../trials/gain_names.js';
import {percent} from '../lenses/card.js';

/** @typedef {import('../trials/trials.js').Study} Study */

/** The server tells it of as many trials or more; see robot/study/importance.py. */
export const FEWEST = 24;
const LITTLE = 'A gain that counts little can be left as it is.';
const MEANING = `Share of what makes the best tenth of the trials differ from all of them (PED-ANOVA). ${LITTLE}`;
const OF_EVOLUTION = 'Share of what is lost where the order of the trials is told by all gains but this one. '
  + LITTLE;

/** A list of bars, the longest first. */
export class Importance {
  element = element('div', {class: 'search-importance'});
  #names;
  #built = '';

  /** @param {import('../fields/field_names.js').FieldNames} names */
  constructor(names) { this.#names = names; }

  /**
   * @param {Study} study
   * @param {number} count of the trials so far
   * @param {number} gains that are searched
   */
  show({lane, result, wanted}, count, gains) {
    const shares = /** @type {[string, number][]} */ (Object.entries(result?.importance ?? {}));
    const built = JSON.stringify([lane, shares, shares.length || count, gains]);
    if (built === this.#built) return;
    this.#built = built;
    if (!shares.length) {
      this.element.replaceChildren(element('p', {class: 'search-empty'}, why(count, gains)));
      return;
    }
    const most = shares[0][1] || 1;
    const rows = shares.map(([name, share]) => {
      const bar = element('div', {class: 'search-bar', 'aria-hidden': 'true'});
      bar.style.inlineSize = `${(100 * share) / most}%`;
      return element('li', {}, element('span', {class: 'search-bar-name'},
        gainName(this.#names, lane, name)),
      element('div', {class: 'search-bar-track'}, bar),
      element('span', {class: 'search-bar-share'}, percent(share)));
    });
    this.element.replaceChildren(element('p', {class: 'search-note'},
      wanted.sampler === 'cmaes' ? OF_EVOLUTION : MEANING),
      element('ul', {class: 'search-bars', 'aria-label': 'Importance of the gains'}, ...rows));
  }
}

/**
 * @param {number} count
 * @param {number} gains
 */
function why(count, gains) {
  if (gains < 2) return 'One gain alone is searched: nothing to compare it with.';
  if (count >= FEWEST) return 'It is told with the next news of the search.';
  return `After ${FEWEST} trials; there ${count === 1 ? 'is' : 'are'} ${count}.`;
}
