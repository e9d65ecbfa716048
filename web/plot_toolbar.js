// @ts-check
/** Below the plots: joints, window, live or held, downloads. */

import {element} from './element.js';
import {icon} from './icons.js';
import {openMenu} from './menu.js';
import {LENGTHS} from './plot_window.js';

const JOINTS = [1, 2, 3, 4, 5, 6];

/**
 * @typedef {{joint: (joint: number) => void, length: (seconds: number) => void,
 *   live: () => void, png: () => void, svg: () => void, csv: () => void}} Actions
 */

/** Shows the choices and reports new ones. */
export class PlotToolbar {
  /** @type {HTMLElement} */ element;
  #joints;
  #length;
  #live;
  #group;

  /** @param {Actions} actions */
  constructor(actions) {
    this.#joints = JOINTS.map((joint) => element('button', {
      type: 'button', class: 'plots-toggle', 'aria-label': `Joint ${joint}`,
      title: `Show or hide joint ${joint} (key ${joint})`, 'aria-pressed': 'false',
      on: {click: () => actions.joint(joint)},
    }, String(joint)));
    this.#group = element(
      'div', {class: 'plots-joints', role: 'group', 'aria-label': 'Joints'},
      element('span', {class: 'plots-label', 'aria-hidden': 'true'}, 'joints'), ...this.#joints,
    );
    this.#length = element(
      'select', {
        class: 'plots-select',
        on: {change: (event) => actions.length(Number(event.target.value))},
      }, ...LENGTHS.map((seconds) => element('option', {value: seconds}, `${seconds} s`)),
    );
    this.#live = element('button', {
      type: 'button', class: 'plots-button plots-live', 'aria-pressed': 'true',
      on: {click: actions.live},
    }, element('span', {class: 'plots-live-dot', 'aria-hidden': 'true'}), 'live');
    this.element = element(
      'div', {class: 'plots-toolbar', role: 'group', 'aria-label': 'Plot settings'},
      this.#group,
      element('label', {class: 'plots-window'},
        element('span', {class: 'plots-label'}, 'window'), this.#length),
      this.#live, downloadButton(actions),
    );
  }

  /**
   * @param {{joints: number[], perJoint: boolean, length: number, live: boolean}} choices
   */
  show({joints, perJoint, length, live}) {
    this.#joints.forEach((button, index) => {
      button.setAttribute('aria-pressed', String(joints.includes(JOINTS[index])));
      button.disabled = !perJoint;
    });
    this.#group.classList.toggle('is-off', !perJoint);
    this.#length.value = String(length);
    this.#live.setAttribute('aria-pressed', String(live));
    this.#live.title = live
      ? 'Follows the newest data. Click to hold; drag in a plot to zoom, with Shift to pan.'
      : 'Held. Click, or double-click a plot, to follow the newest data again.';
  }
}

/**
 * @param {Actions} actions
 * @returns {HTMLButtonElement}
 */
function downloadButton({png, svg, csv}) {
  const button = element('button', {
    type: 'button', class: 'plots-button', 'aria-haspopup': 'menu', 'aria-expanded': 'false',
    'aria-label': 'Download these plots', title: 'Download these plots',
  }, icon('download'));
  button.addEventListener('click', () => openMenu(button, [
    {label: 'PNG image', run: png},
    {label: 'SVG image', run: svg},
    {label: 'CSV table', hint: 'every sample in sight, all joints', run: csv},
  ]));
  return button;
}
