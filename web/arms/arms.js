// @ts-check
/** The arm that the experiment is about: which it is, others to begin with, one's own to bring. */

import {ARM, formerExperiment, jointCount} from '../api/arm.js';
import {forgetArm, listArms} from '../api/requests/arms.js';
import {ask, showDialog} from '../dom/dialog.js';
import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {openLesson} from '../lessons/progress.js';
import {isWatching} from '../api/watch_only.js';
import {Doctor} from './doctor.js';
import {pickedFiles} from './dropped.js';

/** @typedef {import('../api/api.js').Api} Api */
/** @typedef {import('./dropped.js').Sent} Sent */
/** @typedef {import('../api/requests/arms.js').ArmSummary} ArmSummary */

/** Which arm there is, and the way to another one. */
export class Arms {
  /** The row of the left column. */
  element;
  #api;
  #history;
  #tell;
  #doctor;

  /**
   * @param {Api} api
   * @param {import('../api/undo.js').History} history
   * @param {import('../dom/notices.js').Tell} tell
   */
  constructor(api, history, tell) {
    this.#api = api;
    this.#history = history;
    this.#tell = tell;
    this.#doctor = new Doctor(api, (name, title) => this.#begin(name, title), (text) => tell(text, {error: true}));
    const button = element('button', {
      class: 'button arm-button', type: 'button', 'aria-haspopup': 'dialog',
      title: `${ARM.meaning} Choose another arm, or bring your own.`,
      on: {click: () => this.open()},
    }, icon('cube'), element('span', {class: 'arm-name'}, ARM.title),
    element('span', {class: 'arm-count'}, jointCount()), icon('down'));
    this.element = element('div', {class: 'arm-row'}, element('span', {class: 'arm-label'}, 'Arm'), button);
    api.addEventListener('hello', () => this.#offerTheWayBack(), {once: true});
  }

  /** Open the list of arms. */
  async open() {
    let arms;
    try {
      arms = await listArms();
    } catch (error) {
      this.#fail(error);
      return;
    }
    const picker = (/** @type {boolean} */ folder) => {
      const input = element('input', {
        type: 'file', multiple: true, accept: folder ? null : '.urdf,.xml,.zip,.stl,.obj,.dae,.glb',
        on: {change: () => { dialog.close(); this.bring(pickedFiles(input.files)); }},
      });
      if (folder) input.webkitdirectory = true;
      input.click();
    };
    const dialog = showDialog('Arms', element('div', {class: 'dialog-text arms'},
      element('div', {class: 'arm-list'}, ...arms.map((arm) => this.#row(arm, () => dialog.close()))),
      element('div', {class: 'arm-bring'},
        element('p', {}, 'Your own arm: drop its URDF anywhere on this window, with its meshes as a ZIP or a '
          + 'folder. The doctor looks at it before anything runs.'),
        element('div', {class: 'dialog-buttons'},
          element('button', {class: 'button', type: 'button', on: {click: () => picker(true)}},
            icon('upload'), 'Choose a folder…'),
          element('button', {class: 'button primary', type: 'button', on: {click: () => picker(false)}},
            icon('upload'), 'Choose files…')))));
    dialog.classList.add('is-wide');
    const first = dialog.querySelector('[aria-current]') ?? dialog.querySelector('.arm-choice');
    /** @type {HTMLElement|null} */ (first)?.focus();
  }

  /** @param {Sent[]} files */
  bring(files) { if (files.length) this.#doctor.examine(files); }

  /**
   * @param {ArmSummary} arm
   * @param {() => void} close
   */
  #row({name, title, meaning, shipped, problem}, close) {
    const choose = element('button', {
      class: 'menu-item arm-choice', type: 'button', disabled: Boolean(problem),
      'aria-current': name === ARM.name ? 'true' : null,
      on: {click: () => { close(); this.#begin(name, title); }},
    }, element('span', {class: 'menu-text'}, element('span', {}, title),
      element('span', {class: 'menu-hint'}, problem || meaning)), element('code', {}, name));
    const remove = shipped || name === ARM.name ? null : element('button', {
      class: 'button icon-only small', type: 'button', 'aria-label': `Forget ${title}`,
      on: {click: () => { close(); this.#askToForget(name, title); }},
    }, icon('trash'));
    return element('div', {class: 'preset-row'}, choose, remove);
  }

  /**
   * @param {string} name
   * @param {string} title
   */
  async #begin(name, title) {
    const waiting = showDialog(title, element('div', {class: 'dialog-text'},
      element('p', {}, 'Its first experiment is made and tried. For a number of joints that is new here the '
        + 'control laws are compiled as well: half a minute, once.'),
      element('progress', {class: 'arm-progress', 'aria-label': 'Under way'})));
    try {
      await this.#history.replace(`first experiment of ${title}`, () => this.#api.beginArm(name));
    } catch (error) {
      this.#fail(error);
    }
    waiting.close();
  }

  #offerTheWayBack() {
    const former = formerExperiment();
    // A lesson has a way back of its own.
    if (!former || former.experiment.robot.model === ARM.name || isWatching() || openLesson()) return;
    const {preset, experiment, title} = former;
    const run = () => { this.#history.restore(preset, experiment).catch((error) => this.#fail(error)); };
    this.#tell(`The arm is ${ARM.title} now.`, {action: {label: `Back to ${title}`, run}, stays: true});
  }

  /**
   * @param {string} name
   * @param {string} title
   */
  #askToForget(name, title) {
    ask(`Forget the arm ${title}?`, [], 'Forget', async () => {
      await forgetArm(name);
      this.#tell(`Forgot ${title}. Presets that name ${name} can’t be loaded until it is brought again.`);
    });
  }

  /** @param {unknown} error */
  #fail(error) { this.#tell(/** @type {Error} */ (error).message, {error: true}); }
}
