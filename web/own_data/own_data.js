// @ts-check
/** A file of the real arm: brought, read, and what can be done with it. */

import {bringLog} from '../api/requests/logs.js';
import {ARM} from '../api/arm.js';
import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {showDialog} from '../dom/dialog.js';
import {written} from '../fields/quantity.js';
import {showIdentification} from './identification.js';
import {askForColumns} from './columns.js';
import {showTrajectory} from './trajectory.js';
import {listOf, waitFor} from './waiting.js';

/** @typedef {import('../api/requests/logs.js').Log} Log */
/** @typedef {import('../api/requests/logs.js').LogReport} LogReport */
/** @typedef {import('../api/requests/logs.js').Said} Said */
/**
 * @typedef {{history: import('../api/undo.js').History, tell: import('../dom/notices.js').Tell,
 *   logs: import('../logs/logs.js').Logs}} Desk
 */

const RECORDING = /\.(csv|tsv|txt|dat|mcap)$/i;
const MEBIBYTE = 2 ** 20;

/**
 * @param {File} file
 * @returns {boolean} whether its name is that of a table or of an MCAP file
 */
export function isRecording({name}) { return RECORDING.test(name); }

/** Takes files, and shows what comes of them. */
export class OwnData {
  #api;
  #desk;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {Desk} desk
   */
  constructor(api, desk) {
    this.#api = api;
    this.#desk = desk;
    desk.logs.addEventListener('open', (event) => this.#show(/** @type {CustomEvent} */ (event).detail));
    desk.logs.addEventListener('bring', () => this.pick());
    desk.logs.addEventListener('found', (event) => { desk.tell(/** @type {CustomEvent} */ (event).detail); });
    desk.logs.addEventListener('failed', (event) => this.#fail(/** @type {CustomEvent} */ (event).detail));
  }

  /** Open the file picker. */
  pick() {
    const input = element('input', {
      type: 'file', accept: '.csv,.tsv,.txt,.dat,.mcap',
      on: {change: () => { if (input.files?.[0]) this.take(input.files[0]); }},
    });
    input.click();
  }

  /**
   * @param {File} file
   * @param {Said} [said] how it is to be read
   */
  async take(file, said = {}) {
    const size = `${(file.size / MEBIBYTE).toFixed(1)} MB`;
    try {
      const report = await waitFor('Reading the log', `${file.name}, ${size}: columns, units, every row.`, async () => {
        const {log_bytes: most} = await this.#api.limits();
        if (file.size > most) throw new Error(`it has ${size}, at most ${most / MEBIBYTE} MB are read.`);
        return bringLog(file, said);
      });
      if (!report) return;
      await this.#desk.logs.refresh();
      if (report.log) this.#show(report.log, {file, report, said});
      else this.#refused(file, report, said);
    } catch (error) {
      this.#fail(`No log was read: ${/** @type {Error} */ (error).message}`);
    }
  }

  /**
   * @param {File} file
   * @param {LogReport} report
   * @param {Said} said
   */
  #refused(file, report, said) {
    const {message = '', row = null, column = ''} = report.reason ?? {};
    const where = [row === null ? '' : `row ${row}`, column && `column ${column}`].filter(Boolean).join(', ');
    const again = element('button', {
      type: 'button', class: 'button primary',
      on: {click: () => { dialog.close(); this.#askAgain(file, report, said); }},
    }, 'Say which columns…');
    const dialog = showDialog(`${file.name} was not read`, element('div', {class: 'dialog-text own-data'},
      element('p', {class: 'own-data-text', role: 'alert'}, where && element('b', {}, `${where}: `),
        where ? message.replace(/^.*?: (row|column) .*?: /, '') : message),
      element('p', {class: 'dialog-hint'}, 'Correct the file and drop it again, or say what its columns mean.'),
      element('div', {class: 'dialog-buttons'}, again)));
    again.focus();
  }

  /**
   * @param {File} file
   * @param {LogReport} report
   * @param {Said} said
   */
  #askAgain(file, report, said) { askForColumns(file.name, report, said, (more) => this.take(file, more)); }

  /**
   * @param {Log} log
   * @param {{file: File, report: LogReport, said: Said}} [sent] where it has just been read
   */
  #show(log, sent) {
    const {logs, history, tell} = this.#desk;
    const {name, number, rows, duration, rate, holds, remarks} = log;
    const closing = (/** @type {() => void} */ run) => () => { dialog.close(); run(); };
    const choice = (
      /** @type {import('../dom/icons.js').IconName} */ image, /** @type {string} */ title,
      /** @type {string} */ hint, /** @type {() => void} */ run, /** @type {string} */ lacking = '',
    ) => element('button', {
      type: 'button', class: 'menu-item own-data-choice', disabled: Boolean(lacking), on: {click: closing(run)},
    }, icon(image), element('span', {class: 'menu-text'}, element('span', {}, title),
      element('span', {class: 'menu-hint'}, lacking || hint)));
    const torques = holds.includes('torques') || holds.includes('currents');
    const measured = holds.includes('angles') ? '' : 'It has no measured angles, only those that were asked for.';
    const show = choice('plots', 'Show beside the lanes', 'Its error, torque and figures in Response, shifted in time.',
      () => this.#overlay(number), measured);
    const again = sent && element('button', {
      type: 'button', class: 'button',
      on: {click: closing(async () => {
        await logs.remove(number);
        this.#askAgain(sent.file, sent.report, sent.said);
      })},
    }, 'Read it otherwise…');
    const remove = element('button', {
      type: 'button', class: 'button', on: {click: closing(() => logs.remove(number))},
    }, 'Remove');
    const dialog = showDialog(name, element('div', {class: 'dialog-text own-data'},
      element('p', {}, `${rows.toLocaleString('en')} rows, ${written(Number(duration.toPrecision(4)))} s at `
        + `${written(Number(rate.toPrecision(4)))} Hz: ${holds.join(', ')} of ${ARM.title}.`),
      listOf(remarks, 'Assumed and left out'),
      element('div', {class: 'own-data-choices'}, show,
        choice('fork', 'Use as trajectory', 'The lanes follow it: a smoothing spline, checked against limits.',
          () => showTrajectory(this.#api, history, tell, log)),
        choice('tune', 'Fit friction and payload', 'What its torques tell of the arm, each with its interval.',
          () => showIdentification(history, tell, log),
          measured || (torques ? '' : 'It has no torques and no currents.'))),
      element('p', {class: 'dialog-hint'}, 'It is kept until the server ends; its chip below the plots of Response '
        + 'opens this again.'),
      element('div', {class: 'dialog-buttons'}, remove, again)));
    dialog.classList.add('is-wide');
    /** @type {HTMLElement|null} */ (dialog.querySelector('.own-data-choice:enabled'))?.focus();
  }

  /** @param {number} number */
  async #overlay(number) {
    await this.#desk.logs.show(number, true);
    this.#api.dispatchEvent(new CustomEvent('show', {detail: {view: 'response'}}));
  }

  /** @param {string} text */
  #fail(text) { this.#desk.tell(text, {error: true}); }
}
