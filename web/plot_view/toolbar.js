// @ts-check
/** Below the plots: joints, window, live or held, downloads. */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {JointToggles} from './joint_toggles.js';
import {openMenu} from '../dom/menu.js';
import {LENGTHS} from './window.js';

/**
 * @typedef {{joint: (joint: number) => void, length: (seconds: number) => void,
 *   live: () => void, cursors: () => void, png: () => void, svg: () => void, csv: () => void}}
 *   Actions
 */

/** Shows the choices and reports new ones. */
export class PlotToolbar {
  /** @type {HTMLElement} */ element;
  #joints;
  #length;
  #live;
  #cursors;

  /** @param {Actions} actions */
  constructor(actions) {
    this.#joints = new JointToggles(actions.joint);
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
    this.#cursors = cursorsButton(actions.cursors);
    this.element = element(
      'div', {class: 'plots-toolbar', role: 'group', 'aria-label': 'Plot settings'},
      this.#joints.element,
      element('label', {class: 'plots-window'},
        element('span', {class: 'plots-label'}, 'window'), this.#length),
      this.#live, this.#cursors, downloadButton(actions),
    );
  }

  /**
   * @param {{joints: number[], perJoint: boolean, length: number, live: boolean,
   *   cursors: boolean|null}} choices `cursors`: null where there can't be any
   */
  show({joints, perJoint, length, live, cursors}) {
    this.#joints.show(joints, perJoint);
    this.#cursors.setAttribute('aria-pressed', String(Boolean(cursors)));
    this.#cursors.disabled = cursors === null;
    this.#length.value = String(length);
    this.#live.setAttribute('aria-pressed', String(live));
    this.#live.title = live
      ? 'Follows the newest data. Click to hold; drag in a plot to zoom, with Shift to pan.'
      : 'Held. Click, or double-click a plot, to follow the newest data again.';
  }
}

/**
 * @param {() => void} toggle
 * @returns {HTMLButtonElement}
 */
export function cursorsButton(toggle) {
  return element('button', {
    type: 'button', class: 'plots-button plots-cursors', 'aria-pressed': 'false',
    title: 'Two cursors to read times and values at (keys A and B)', on: {click: toggle},
  }, icon('cursors'), 'A B');
}

/**
 * @param {Pick<Actions, 'png'|'svg'|'csv'>} actions
 * @param {string} [samples] what the table holds
 * @returns {HTMLButtonElement}
 */
export function downloadButton({png, svg, csv}, samples = 'every sample in sight, all joints') {
  const button = element('button', {
    type: 'button', class: 'plots-button', 'aria-haspopup': 'menu', 'aria-expanded': 'false',
    'aria-label': 'Download these plots', title: 'Download these plots',
  }, icon('download'));
  button.addEventListener('click', () => openMenu(button, [
    {label: 'PNG image', run: png},
    {label: 'SVG image', run: svg},
    {label: 'CSV table', hint: samples, run: csv},
  ]));
  return button;
}
