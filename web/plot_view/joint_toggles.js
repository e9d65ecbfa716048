// @ts-check
/** A row of buttons, one a joint: which joints the plots show. */

import {ARM, JOINTS} from '../api/arm.js';
import {element} from '../dom/element.js';

/** Shows the choice and reports a press. */
export class JointToggles {
  /** @type {HTMLElement} */ element;
  #buttons;

  /** @param {(joint: number) => void} toggle */
  constructor(toggle) {
    this.#buttons = JOINTS.map((joint) => element('button', {
      type: 'button', class: 'plots-toggle', 'aria-label': `Joint ${joint}`,
      title: `Show or hide joint ${joint}, ${ARM.joints[joint - 1].name}${joint < 10 ? ` (key ${joint})` : ''}`, 'aria-pressed': 'false',
      on: {click: () => toggle(joint)},
    }, String(joint)));
    this.element = element(
      'div', {class: 'plots-joints', role: 'group', 'aria-label': 'Joints'},
      element('span', {class: 'plots-label', 'aria-hidden': 'true'}, 'joints'), ...this.#buttons,
    );
  }

  /**
   * @param {number[]} joints
   * @param {boolean} apply whether what is shown has joints
   */
  show(joints, apply) {
    this.#buttons.forEach((button, index) => {
      button.setAttribute('aria-pressed', String(joints.includes(JOINTS[index])));
      button.disabled = !apply;
    });
    this.element.classList.toggle('is-off', !apply);
    this.element.setAttribute('aria-disabled', String(!apply));
  }
}
