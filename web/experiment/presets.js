// @ts-check
/** Presets: the list to load from, saving under a name, deleting one's own, YAML out. */

import {BOUNDS, SCHEMA} from '../api/schema_document.js';
import {ask} from '../dom/dialog.js';
import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {placeAt} from '../dom/menu.js';
import {fileName, saveFile} from '../dom/save_file.js';
import {Schema} from '../fields/schema.js';
import {same} from '../fields/merge_patch.js';

/** @typedef {import('../api/api.js').Preset} Preset */
/** @typedef {import('../dom/notices.js').Tell} Tell */

/** What the server takes as a name, and how it says so. */
const NAME = /^[a-z0-9][a-z0-9-]{0,59}$/;
const NAME_RULE = `Use 1 to ${BOUNDS.preset_name} of a-z, 0-9 and -, such as my-gains`;

/** Presets of the live session. */
export class Presets {
  /** Shows which preset is loaded and whether it was changed; opens the list. */
  button;
  #api;
  #history;
  #tell;
  #name = element('span', {class: 'preset-name'});

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../api/undo.js').History} history
   * @param {Tell} tell
   */
  constructor(api, history, tell) {
    this.#api = api;
    this.#history = history;
    this.#tell = tell;
    this.button = element('button', {
      class: 'button preset-button', type: 'button', 'aria-haspopup': 'dialog',
      'aria-expanded': 'false', on: {click: () => this.open()},
    }, this.#name, element('span', {class: 'preset-changed'}), icon('down'));
    for (const type of ['hello', 'patch', 'saved']) api.addEventListener(type, () => this.#show());
  }

  #show() {
    const {preset, experiment, baseline} = this.#api;
    const changed = !same(experiment, baseline);
    this.#name.textContent = preset || experiment.title || 'No preset';
    this.button.classList.toggle('is-changed', changed);
    this.button.title = `Presets${changed ? ' (changed since it was loaded)' : ''}`;
    this.button.setAttribute('aria-label', `Preset: ${this.#name.textContent}${changed ? ', changed' : ''}`);
  }

  /** Open the list of presets. */
  async open() {
    const list = element('div', {
      class: 'menu preset-list', popover: 'auto', role: 'dialog', 'aria-label': 'Presets',
    });
    document.body.append(list);
    list.addEventListener('toggle', (event) => {
      const open = /** @type {ToggleEvent} */ (event).newState === 'open';
      this.button.setAttribute('aria-expanded', String(open));
      if (!open) list.remove();
    });
    list.addEventListener('keydown', (event) => browsed(list, event));
    try {
      const presets = await this.#api.listPresets();
      list.append(...this.#parts(presets, list));
      list.showPopover();
      placeAt(list, this.button);
      const first = list.querySelector('[aria-current]') ?? list.querySelector('.preset-load');
      /** @type {HTMLElement|null} */ (first)?.focus();
    } catch (error) {
      list.remove();
      this.#fail(error);
    }
  }

  /**
   * @param {Preset[]} presets
   * @param {HTMLElement} list
   */
  #parts(presets, list) {
    const own = presets.filter(({shipped}) => !shipped);
    const shipped = presets.filter((preset) => preset.shipped);
    const heading = (/** @type {string} */ text) => element('div', {class: 'menu-heading'}, text);
    const rows = (/** @type {Preset[]} */ some) => some.map((preset) => this.#row(preset, list));
    return [
      ...(own.length ? [heading('Yours'), ...rows(own)] : []),
      ...(shipped.length ? [heading('Shipped'), ...rows(shipped)] : []),
    ];
  }

  /**
   * @param {Preset} preset
   * @param {HTMLElement} list
   */
  #row({name, title, description, shipped}, list) {
    const load = element('button', {
      class: 'menu-item preset-load', type: 'button',
      'aria-current': name === this.#api.preset ? 'true' : null,
      on: {click: () => { list.hidePopover(); this.load(name); }},
    }, element('span', {class: 'menu-text'}, element('span', {}, title || name),
      element('span', {class: 'menu-hint'}, firstSentence(description))),
    element('code', {}, name));
    const remove = shipped ? null : element('button', {
      class: 'button icon-only small', type: 'button', 'aria-label': `Delete ${name}`,
      on: {click: () => { list.hidePopover(); this.#askToDelete(name); }},
    }, icon('trash'));
    return element('div', {class: 'preset-row'}, load, remove);
  }

  /** @param {string} name */
  async load(name) {
    try {
      await this.#history.replace(`loading of ${name}`, () => this.#api.loadPreset(name));
    } catch (error) {
      this.#fail(error);
    }
  }

  /** Ask for a name and save the live experiment under it. */
  save() { this.#askHow(new Schema(SCHEMA)); }

  /** @param {Schema} schema */
  #askHow(schema) {
    const {preset, experiment} = this.#api;
    const questions = [
      {name: 'name', label: 'Name', value: preset, required: true, length: BOUNDS.preset_name,
        hint: 'Small letters, digits and -; it becomes the file’s name.'},
      {name: 'title', label: 'Title', value: experiment.title,
        length: schema.longest('title')},
      {name: 'description', label: 'What to look at', value: experiment.description, long: true,
        length: schema.longest('description')},
    ];
    let agreed = '';
    ask('Save as preset', questions, 'Save', async ({name: typed, ...about}, {relabel}) => {
      const name = typed.trim();
      // Before asking: an address can't carry every name as it is.
      if (!NAME.test(name)) throw new Error(`${NAME_RULE}, got ${name}.`);
      const there = (await this.#api.listPresets()).find((one) => one.name === name);
      if (there?.shipped) {
        throw new Error(`${name} ships with Slidetune and is read-only: choose another name.`);
      }
      if (there && agreed !== name) {
        agreed = name;
        relabel('Overwrite');
        throw new Error(`You already have a preset ${name}. Overwrite it?`);
      }
      await this.#describe(about.title, about.description);
      await this.#api.savePreset(name, {overwrite: Boolean(there)});
      this.#tell(`Saved as ${name}.`);
    });
  }

  /**
   * @param {string} title
   * @param {string} description
   */
  async #describe(title, description) {
    const {experiment} = this.#api;
    if (experiment.title === title && experiment.description === description) return;
    await this.#history.change({title, description}, 'title and description');
  }

  /** @param {string} name */
  #askToDelete(name) {
    ask(`Delete the preset ${name}?`, [], 'Delete', async () => {
      await this.#api.deletePreset(name);
      this.#tell(`Deleted ${name}. The live experiment stays as it is.`);
    });
  }

  /** Download the live experiment as YAML. */
  async export() {
    try {
      const text = await this.#api.exportYaml();
      const {preset, experiment} = this.#api;
      const name = fileName(preset || experiment.title) || 'experiment';
      saveFile(`${name}.yaml`, text, 'application/yaml');
    } catch (error) {
      this.#fail(error);
    }
  }

  /** @param {unknown} error */
  #fail(error) { this.#tell(/** @type {Error} */ (error).message, {error: true}); }
}

/**
 * An abbreviation's full stop has no capital letter after it.
 *
 * @param {string} text
 */
function firstSentence(text) { return /^.*?[.!?](?=\s+\p{Lu}|\s*$)/su.exec(text)?.[0] ?? text; }

/**
 * @param {HTMLElement} list
 * @param {KeyboardEvent} event
 */
function browsed(list, event) {
  // It keeps the focus for a moment after it has closed: that key is the page's.
  if (!list.matches(':popover-open')) return;
  const way = {ArrowDown: 1, ArrowUp: -1}[event.key];
  event.stopPropagation();
  if (!way) return;
  event.preventDefault();
  const rows = [...list.querySelectorAll('.preset-load')];
  const at = rows.findIndex((row) => row === document.activeElement);
  /** @type {HTMLElement} */ (rows[(at + way + rows.length) % rows.length]).focus();
}
