// @ts-check
/** Undo and redo of this screen's own edits, by patches that touch nothing else. */

import {inverse, joined, leaves, difference} from '../fields/merge_patch.js';
import {presetAddress} from './api.js';
import {request} from './http.js';

/** @typedef {import('../fields/merge_patch.js').Document} Document */
/** @typedef {{label: string, back: () => Promise<any>, forward: () => Promise<any>}} Entry */

const MOST = 200;

/**
 * Event `change`: what can be undone or redone is different now. Event `refused`: the server
 * didn't take an undo or redo; `detail` is its ApiError and the entry is gone. Event `interrupt`: an
 * undo or redo ends the movement under way.
 */
export class History extends EventTarget {
  #api;
  /** @type {Entry[]} */ #done = [];
  /** @type {Entry[]} */ #undone = [];
  /** @type {{before: Document, patch: Document, label: string}|null} */ #gesture = null;
  /** @type {Promise<void>} */ #queue = Promise.resolve();
  /** @type {Promise<void>} kept when every edit has been made or refused */ #edits = Promise.resolve();

  /** @param {import('./api.js').Api} api */
  constructor(api) {
    super();
    this.#api = api;
  }

  /** @returns {string|undefined} what undo would take back */
  get undoLabel() { return this.#done.at(-1)?.label; }

  /** @returns {string|undefined} what redo would do again */
  get redoLabel() { return this.#undone.at(-1)?.label; }

  /**
   * Send one value of a movement that goes on; nothing to undo yet.
   *
   * @param {Document} patch
   * @param {string} label
   */
  move(patch, label) {
    if (this.#gesture && this.#gesture.label !== label) this.commit();
    this.#gesture ??= {before: this.#api.experiment, patch: {}, label};
    this.#gesture.patch = joined(this.#gesture.patch, patch);
    this.#api.patch(patch);
  }

  /**
   * End the movement: it becomes one entry, if the server took any of it.
   *
   * @returns {Promise<void>} kept when the server has answered all of it
   */
  async commit() {
    const gesture = this.#gesture;
    this.#gesture = null;
    await this.#api.settled();
    if (gesture) this.#remember(gesture.label, gesture.before, gesture.patch);
  }

  /**
   * Give the movement up: every value is again as before it, and there is nothing to undo.
   *
   * @returns {Promise<void>} kept when the server has answered
   */
  async cancel() {
    const gesture = this.#gesture;
    this.#gesture = null;
    if (gesture) {
      const {before, patch} = gesture;
      // Some of it may be on its way still.
      const back = inverse(before, joined(before, patch), patch);
      if (leaves(back).length) this.#api.patch(back);
    }
    await this.#api.settled();
  }

  /**
   * Make one change that is complete in itself.
   *
   * @param {Document} patch
   * @param {string} label
   * @throws {import('./api.js').ApiError} when the server refuses; nothing has changed then
   */
  change(patch, label) {
    return this.#making(async () => {
      await this.commit();
      const before = this.#api.experiment;
      await this.#api.change(patch);
      this.#remember(label, before, patch);
    });
  }

  /**
   * Do something that is no patch.
   *
   * @param {string} label
   * @param {() => Promise<any>} action
   * @param {Document} back the patch that takes it back
   */
  perform(label, action, back) {
    return this.#making(async () => {
      await this.commit();
      await action();
      this.#push({label, back: () => this.#api.change(back), forward: action});
    });
  }

  /**
   * Replace the whole experiment; undo brings the former one back with its preset.
   *
   * @param {string} label
   * @param {() => Promise<{experiment: Document}>} action
   * @throws {import('./api.js').ApiError} when the server refuses; nothing has changed then
   */
  replace(label, action) {
    return this.#making(async () => {
      await this.commit();
      const {preset, experiment} = this.#api;
      await action();
      this.#push({label, back: () => this.restore(preset, experiment), forward: action});
    });
  }

  /**
   * Do something by which the server changes any number of fields; undo takes back just those.
   *
   * @param {string} label
   * @param {() => Promise<{experiment: Document}>} action
   * @throws {import('./api.js').ApiError} when the server refuses; nothing has changed then
   */
  travelTo(label, action) {
    return this.#making(async () => {
      await this.commit();
      const before = this.#api.experiment;
      const {experiment} = await action();
      const back = difference(experiment, before);
      const forward = difference(before, experiment);
      if (!Object.keys(back).length) return;
      this.#push({label, back: () => this.#apply(back), forward: () => this.#apply(forward)});
    });
  }

  /** Take the last edit back. */
  undo() { return this.#travel('back'); }

  /** Do the last undone edit again. */
  redo() { return this.#travel('forward'); }

  /**
   * Bring back an experiment that came from a preset.
   *
   * @param {string} preset name, or '' for none
   * @param {Document} experiment
   */
  async restore(preset, experiment) {
    const presets = await this.#api.listPresets();
    const isThere = presets.some(({name}) => name === preset);
    // A page begins anew once its arm is another one: what comes after that request would be lost.
    const atOnce = experiment.robot.model !== this.#api.experiment.robot.model;
    if (!isThere || (atOnce && !await isPreset(preset, experiment))) {
      await this.#api.replaceExperiment(experiment);
      return;
    }
    const loaded = await this.#api.loadPreset(preset);
    const rest = difference(loaded.experiment, experiment);
    if (!Object.keys(rest).length) return;
    await this.#api.change(rest);
    // The state begins as this experiment has it, not as the preset does.
    this.#api.reset();
  }

  /**
   * Make an edit; an undo that is asked for before it is made takes it back, not the one before.
   *
   * @param {() => Promise<void>} edit
   * @returns {Promise<void>}
   */
  #making(edit) {
    const made = edit();
    const ended = made.catch(() => {}); // whoever asked is told
    this.#edits = Promise.all([this.#edits, ended]).then(() => {});
    return made;
  }

  /**
   * @param {string} label
   * @param {Document} before
   * @param {Document} patch
   */
  #remember(label, before, patch) {
    const after = this.#api.experiment;
    const back = inverse(before, after, patch);
    const forward = inverse(after, before, patch);
    if (!leaves(back).length) return;
    this.#push({
      label,
      back: () => this.#apply(back),
      forward: () => this.#apply(forward),
    });
  }

  /** @param {Document} patch */
  async #apply(patch) {
    await this.#api.change(patch);
    const changed = Object.keys(patch.lanes ?? {}).find((name) => name in this.#api.experiment.lanes);
    if (changed) this.#api.select(changed);
  }

  /** @param {Entry} entry */
  #push(entry) {
    this.#done = [...this.#done, entry].slice(-MOST);
    this.#undone = [];
    this.dispatchEvent(new Event('change'));
  }

  /**
   * @param {'back'|'forward'} way
   * @returns {Promise<void>}
   */
  #travel(way) {
    this.dispatchEvent(new Event('interrupt'));
    // One after the other: the second of two quick presses must see what the first one did.
    const step = this.#queue.then(() => this.#edits).then(() => this.commit()).then(async () => {
      const stacks = way === 'back' ? [this.#done, this.#undone] : [this.#undone, this.#done];
      const entry = stacks[0].pop();
      if (!entry) return;
      await entry[way]();
      stacks[1].push(entry);
    });
    this.#queue = step.catch((error) => {
      this.dispatchEvent(new CustomEvent('refused', {detail: error}));
    }).then(() => { this.dispatchEvent(new Event('change')); });
    return this.#queue;
  }
}

/**
 * @param {string} name of a preset
 * @param {Document} experiment
 */
async function isPreset(name, experiment) {
  const found = await request('GET', presetAddress(name));
  return !Object.keys(difference(found.experiment, experiment)).length;
}
