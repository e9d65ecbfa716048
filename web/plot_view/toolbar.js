// @ts-check
/** Below the plots: joints, cursors, downloads, and what else their source has. */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {JointToggles} from './joint_toggles.js';
import {openMenu} from '../dom/menu.js';

/**
 * @typedef {{joint: (joint: number) => void, cursors: () => void, png: () => void,
 *   svg: () => void, csv: () => void}} Actions
 */

/** Shows the choices and reports new ones. */
export class PlotToolbar {
  /** @type {HTMLElement} */ element;
  #joints;
  #cursors;

  /**
   * @param {{toolbar: string, table: string}} words its name, and what a CSV holds
   * @param {Actions} actions
   */
  constructor({toolbar, table}, actions) {
    this.#joints = new JointToggles(actions.joint);
    this.#cursors = element('button', {
      type: 'button', class: 'plots-button plots-cursors', 'aria-pressed': 'false',
      title: 'Two cursors to read times and values at (keys A and B)',
      on: {click: actions.cursors},
    }, icon('cursors'), 'A B');
    this.element = element(
      'div', {class: 'plots-toolbar', role: 'group', 'aria-label': toolbar},
      this.#joints.element, this.#cursors, downloadButton(actions, table),
    );
  }

  /** @param {HTMLElement[]} elements to stand after the joints */
  afterJoints(elements) { this.#joints.element.after(...elements); }

  /**
   * @param {{joints: number[], perJoint: boolean, cursors: boolean|null}} choices `cursors`: null
   *   where there can't be any
   */
  show({joints, perJoint, cursors}) {
    this.#joints.show(joints, perJoint);
    this.#cursors.setAttribute('aria-pressed', String(Boolean(cursors)));
    this.#cursors.disabled = cursors === null;
  }
}

/**
 * @param {Pick<Actions, 'png'|'svg'|'csv'>} actions
 * @param {string} table what it holds
 * @returns {HTMLButtonElement}
 */
function downloadButton({png, svg, csv}, table) {
  const button = element('button', {
    type: 'button', class: 'plots-button', 'aria-haspopup': 'menu', 'aria-expanded': 'false',
    'aria-label': 'Download these plots', title: 'Download these plots',
  }, icon('download'));
  button.addEventListener('click', () => openMenu(button, [
    {label: 'PNG image', run: png},
    {label: 'SVG image', run: svg},
    {label: 'CSV table', hint: table, run: csv},
  ]));
  return button;
}
