// @ts-check
/** Lanes and their colours above the plots; a click hides some curves or shows them again. */

import {element} from '../dom/element.js';

/** @typedef {{name: string, color: string}} Lane */

/** The legend. */
export class PlotLegend {
  element = element('div', {class: 'plots-legend', role: 'group', 'aria-label': 'Curves'});
  #drawn = '';
  #toggle;
  #toggleBefore;

  /**
   * @param {(lane: string) => void} toggle
   * @param {() => void} [toggleBefore] the curves before the last change
   */
  constructor(toggle, toggleBefore = () => {}) {
    this.#toggle = toggle;
    this.#toggleBefore = toggleBefore;
  }

  /**
   * @param {{lanes: Lane[], hidden: Set<string>, selected: string, desired: boolean,
   *   frozen: Map<string, {text: string}>, before?: boolean|null}} shown `before`: whether the
   *   curves before the last change are shown; null where there never are any
   */
  show({lanes, hidden, selected, desired, frozen, before = null}) {
    const drawn = JSON.stringify([lanes, [...hidden], selected, desired, [...frozen], before]);
    if (drawn === this.#drawn) return;
    this.#drawn = drawn;
    const focused = [...this.element.children].indexOf(
      /** @type {Element} */ (document.activeElement),
    );
    this.element.replaceChildren(...lanes.map((lane) => this.#entry(
      lane, !hidden.has(lane.name), lane.name === selected, frozen.get(lane.name)?.text,
    )), ...(desired ? [desiredEntry()] : []),
    ...(before === null ? [] : [this.#beforeEntry(before)]));
    if (focused >= 0) /** @type {HTMLElement} */ (this.element.children[focused])?.focus();
  }

  /**
   * @param {Lane} lane
   * @param {boolean} visible
   * @param {boolean} selected
   * @param {string|undefined} frozen why it stopped
   */
  #entry({name, color}, visible, selected, frozen) {
    const dot = element('span', {class: 'plots-dot', 'aria-hidden': 'true'});
    dot.style.setProperty('--lane', color);
    return element(
      'button', {
        type: 'button', class: selected ? 'plots-lane is-selected' : 'plots-lane',
        'aria-pressed': String(visible), title: frozen ?? `${visible ? 'Hide' : 'Show'} ${name}`,
        on: {click: () => this.#toggle(name)},
      },
      dot, element('span', {class: 'plots-lane-name'}, name),
      frozen && element('span', {class: 'plots-frozen'}, 'frozen'),
    );
  }

  /** @param {boolean} visible */
  #beforeEntry(visible) {
    return element(
      'button', {
        type: 'button', class: 'plots-lane plots-before', 'aria-pressed': String(visible),
        title: `${visible ? 'Hide' : 'Show'} the response before the last change, an undo included`,
        on: {click: () => this.#toggleBefore()},
      },
      element('span', {class: 'plots-shadow', 'aria-hidden': 'true'}), 'before the last change',
    );
  }
}

function desiredEntry() {
  return element(
    'span', {class: 'plots-desired'},
    element('span', {class: 'plots-dash', 'aria-hidden': 'true'}), 'desired',
  );
}
