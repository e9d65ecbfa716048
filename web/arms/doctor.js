// @ts-check
/** What the doctor says of an arm that was brought, and what can be said to it in turn. */

import {bringArm} from '../api/requests/arms.js';
import {ask, showDialog} from '../dom/dialog.js';
import {element} from '../dom/element.js';

/** @typedef {import('../api/api.js').Api} Api */
/** @typedef {import('../api/http.js').ApiError} ApiError */
/** @typedef {import('./dropped.js').Sent} Sent */
/** @typedef {import('../api/requests/arms.js').Finding} Finding */
/** @typedef {import('../api/requests/arms.js').Report} Report */
/** @typedef {import('../api/requests/arms.js').Said} Said */

const WORDS = {refused: 'Refused', assumed: 'Assumed', noted: 'To look at'};

/** Has an arm examined, and shows what comes of it until it is used or given up. */
export class Doctor {
  #api;
  #use;
  #fail;

  /**
   * @param {Api} api
   * @param {(name: string, title: string) => void} use begins with an arm
   * @param {(text: string) => void} fail
   */
  constructor(api, use, fail) {
    this.#api = api;
    this.#use = use;
    this.#fail = fail;
  }

  /**
   * @param {Sent[]} files
   * @param {Said} [said]
   */
  async examine(files, said = {}) {
    const size = files.reduce((sum, {file}) => sum + file.size, 0);
    const waiting = showDialog('Looking at the arm', element('div', {class: 'dialog-text'},
      element('p', {}, `${files.length} ${files.length === 1 ? 'file' : 'files'}, `
        + `${(size / 1e6).toFixed(1)} MB: reading, then joint by joint and link by link.`),
      element('progress', {class: 'arm-progress', 'aria-label': 'Under way'})));
    try {
      const {arm_bytes: most} = await this.#api.limits();
      if (size > most) throw new Error(`all files together are larger than ${Math.round(most / 2 ** 20)} MiB.`);
      const report = await bringArm(files, said);
      if (!waiting.open) return;
      waiting.close();
      this.#show(report, files, said);
    } catch (error) {
      waiting.close();
      this.#refused(/** @type {ApiError} */ (error), files, said);
    }
  }

  /**
   * @param {ApiError} error
   * @param {Sent[]} files
   * @param {Said} said
   */
  #refused({message, fields}, files, said) {
    const several = fields?.find(({path, allowed}) => path === 'urdf' && allowed);
    if (!several) {
      this.#fail(`No arm was read: ${message}`);
      return;
    }
    const choices = (several.allowed ?? '').split('\n').map((name) => element('button', {
      class: 'menu-item', type: 'button',
      on: {click: () => { dialog.close(); this.examine(files, {...said, urdf: name}); }},
    }, element('code', {}, name)));
    const dialog = showDialog('Which description?', element('div', {class: 'dialog-text'},
      element('p', {}, 'There are several. Choose the arm:'), ...choices));
  }

  /**
   * @param {Report} report
   * @param {Sent[]} files
   * @param {Said} said
   */
  #show(report, files, said) {
    const again = element('button', {
      class: 'button', type: 'button',
      on: {click: () => { dialog.close(); this.#askAgain(report, files, said); }},
    }, 'Another tip or mass…');
    const use = report.name && element('button', {
      class: 'button primary', type: 'button',
      on: {click: () => { dialog.close(); this.#use(report.name, report.robot); }},
    }, 'Begin with this arm');
    const way = report.name
      ? 'It is kept. Its first experiment has gains, a motion and a disturbance that fit it.'
      : 'Nothing was kept. Mend what is refused, then drop it again.';
    const dialog = showDialog(report.name ? `${report.robot} can be used` : `${report.robot} is refused`,
      element('div', {class: 'dialog-text arm-report'},
        element('p', {}, report.summary),
        report.joints.length ? element('p', {class: 'arm-joints'}, `Joints: ${report.joints.join(', ')}`) : null,
        list(report.findings),
        element('p', {class: 'dialog-hint'}, way),
        element('div', {class: 'dialog-buttons'}, again, use)));
    dialog.classList.add('is-wide');
    /** @type {HTMLElement} */ (use || again).focus();
  }

  /**
   * @param {Report} report
   * @param {Sent[]} files
   * @param {Said} said
   */
  #askAgain(report, files, said) {
    const questions = [
      {name: 'tip', label: 'Tip: the link that is the flange', value: said.tip ?? report.tip,
        hint: 'Empty for the end of the longest chain.'},
      {name: 'total_mass', label: 'Mass of the whole arm in kg', value: said.total_mass ?? '',
        hint: 'From the datasheet: spread by volume over links that have none. Empty to use the file’s own.'},
    ];
    ask('Examine again', questions, 'Examine', async ({tip, total_mass: mass}) => {
      const typed = mass.trim().replace(',', '.');
      if (typed && !(Number(typed) > 0)) throw new Error(`The mass must be a number above 0 kg, got ${mass}.`);
      queueMicrotask(() => { this.examine(files, {...said, tip: tip.trim(), total_mass: typed}); });
    });
  }
}

/** @param {Finding[]} findings */
function list(findings) {
  if (!findings.length) return element('p', {}, 'Nothing is missing.');
  const kinds = Object.entries(WORDS).map(([kind, title]) => ({
    kind, title, some: findings.filter((finding) => finding.kind === kind),
  })).filter(({some}) => some.length);
  return element('div', {class: 'arm-findings'}, ...kinds.map(({kind, title, some}) => (
    element('details', {'data-kind': kind, open: kind !== 'noted' || some.length < 6},
      element('summary', {}, `${title} (${some.length})`),
      element('ul', {}, ...some.map(row)))
  )));
}

/** @param {Finding} finding */
function row({where, line, text, remedy}) {
  const place = line === null ? where : `${where}, line ${line}`;
  return element('li', {}, element('code', {}, place), element('span', {}, ` ${text}. `),
    remedy ? element('span', {class: 'arm-remedy'}, `Way out: ${remedy}.`) : null);
}
