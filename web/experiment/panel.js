// @ts-check
/** The left column: what the experiment is, its lanes, and a control for every number. */

import {mountAbout} from './about.js';
import {element, withIndices} from '../dom/element.js';
import {fieldPath} from '../fields/field_path.js';
import {Knobs} from '../knobs/knobs.js';
import {mount as mountLanes} from './lanes.js';
import {mountLawFiles} from './law_files.js';
import {leaves} from '../fields/merge_patch.js';
import {SCHEMA, replaceSchema} from '../api/schema_document.js';
import {Schema} from '../fields/schema.js';
import {Goals} from '../goals/goals.js';
import {Group, SectionGroup} from '../controls/section.js';

/** @typedef {import('../controls/control.js').Control} Control */
/** @typedef {import('../fields/schema.js').Field} Field */

/** Groups in the order of the theory; any further ones come after. */
const ORDER = ['Sliding surface', 'Reaching', 'RBF network', 'PD'];

/**
 * @param {HTMLElement} place
 * @param {import('../api/api.js').Api} api
 * @param {import('../api/undo.js').History} history
 * @param {import('../dom/notices.js').Tell} tell
 * @param {import('../api/preview.js').Preview} preview
 * @param {import('../arms/arms.js').Arms} arms
 */
export function mount(place, api, history, tell, preview, arms) {
  const about = mountAbout(api);
  const lanes = element('section', {class: 'lanes', 'aria-label': 'Lanes'});
  const gains = element('section', {class: 'gains', 'aria-label': 'Gains of the selected lane'});
  const rest = element('section', {class: 'sections', 'aria-label': 'Experiment'});
  place.append(about, arms.element, lanes, gains, rest);
  api.addEventListener('laws', (event) => {
    const {schema} = detail(event);
    if (schema) replaceSchema(schema);
  });
  api.addEventListener('hello', () => {
    const schema = new Schema(SCHEMA);
    lanes.append(mountLawFiles(api));
    mountLanes(lanes, api, history, schema, tell);
    new Tuning(schema, api, history, tell).mount(place, gains, rest);
    const goals = new Goals(api, history, preview).element;
    goals.dataset.group = 'goals';
    rest.append(goals);
  }, {once: true});
  // Where one part is seen at a time, this one is shown first.
  api.addEventListener('group', (event) => queueMicrotask(() => (
    open(place, /** @type {CustomEvent} */ (event).detail)
  )));
}

/**
 * @param {HTMLElement} column
 * @param {string} key of a group
 */
function open(column, key) {
  const group = column.querySelector(`details[data-group="${CSS.escape(key)}"]`);
  if (!(group instanceof HTMLDetailsElement)) return;
  group.open = true;
  const head = group.querySelector('summary');
  head?.focus();
  head?.scrollIntoView({block: 'start'});
}

/** Keeps the controls and the experiment in step. */
class Tuning {
  #schema;
  #api;
  #history;
  #tell;
  /** @type {Group[]} */ #gains = [];
  /** @type {Group[]} */ #sections = [];
  #built = '';
  /** @type {HTMLElement} */ #place = element('div');
  /** @type {Knobs|null} */ #knobs = null;

  /**
   * @param {Schema} schema
   * @param {import('../api/api.js').Api} api
   * @param {import('../api/undo.js').History} history
   * @param {import('../dom/notices.js').Tell} tell
   */
  constructor(schema, api, history, tell) {
    this.#schema = schema;
    this.#api = api;
    this.#history = history;
    this.#tell = tell;
  }

  /**
   * @param {HTMLElement} column
   * @param {HTMLElement} gains
   * @param {HTMLElement} rest
   */
  mount(column, gains, rest) {
    this.#place = gains;
    const context = {api: this.#api, history: this.#history};
    this.#sections = this.#schema.sections()
      .map((section) => new SectionGroup(this.#schema, section, context));
    rest.append(...this.#sections.map((section) => section.element));
    this.#refresh();
    const desk = {...context, tell: this.#tell, schema: this.#schema};
    for (const type of ['select', 'saved']) this.#api.addEventListener(type, () => this.#refresh());
    this.#api.addEventListener('hello', () => {
      for (const control of this.#controls) control.refuse('');
      this.#refresh();
    });
    this.#api.addEventListener('patch', (event) => this.#patched(detail(event)));
    this.#api.addEventListener('laws', (event) => { if (detail(event).schema) this.#built = ''; });
    this.#api.addEventListener('error', (event) => this.#refused(detail(event)));
    // After the listeners above: what it has to say stands beside controls that are up to date.
    this.#knobs = new Knobs(desk, column, gains, (path) => this.#fieldAt(path));
    gains.querySelector('.gains-head')?.after(this.#knobs.element);
  }

  get #groups() { return [...this.#gains, ...this.#sections]; }

  get #controls() { return this.#groups.flatMap((group) => group.controls); }

  /** @param {{flash?: boolean}} [options] */
  #refresh(options) {
    const {selected, experiment, lanes} = this.#api;
    const law = experiment.lanes[selected]?.law;
    if (!law) return;
    const color = lanes.find((lane) => lane.name === selected)?.color ?? '';
    this.#place.style.setProperty('--fill', color);
    if (this.#built !== `${law} ${selected}`) this.#build(law, selected);
    for (const group of this.#groups) group.refresh(options);
  }

  /**
   * @param {string} law
   * @param {string} lane
   */
  #build(law, lane) {
    this.#built = `${law} ${lane}`;
    const fields = Map.groupBy(this.#schema.laneFields(law, lane), ({group}) => group || 'Gains');
    const rank = (/** @type {string} */ name) => (ORDER.indexOf(name) + 1 || ORDER.length + 1);
    const names = [...fields.keys()].sort((a, b) => rank(a) - rank(b));
    this.#gains = names.map((name) => {
      const group = new Group(name, `lane.${name}`, true);
      group.add(fields.get(name) ?? [], {api: this.#api, history: this.#history});
      return group;
    });
    const knobs = this.#knobs ? [this.#knobs.element] : [];
    const groups = this.#gains.map((group) => group.element);
    this.#place.replaceChildren(this.#heading(law, lane), ...knobs, ...groups);
  }

  /** @param {string} path dotted */
  #fieldAt(path) { return this.#controls.find(({field}) => fieldPath(field.path) === path)?.field; }

  /**
   * @param {string} law
   * @param {string} lane
   */
  #heading(law, lane) {
    const {title = law, summary = ''} = this.#api.laws.find(({name}) => name === law) ?? {};
    const named = lane === title ? lane : `${lane} · ${title}`;
    const dot = element('span', {class: 'lane-dot'});
    const name = element('h2', {}, dot, element('span', {}, named));
    return element('header', {class: 'gains-head'}, name, summary && element('p', {}, withIndices(summary)));
  }

  /** @param {{author: string, patch: any}} message */
  #patched({author, patch}) {
    const own = author === this.#api.client;
    if (own) for (const control of this.#touchedBy(patch)) control.refuse('');
    this.#refresh({flash: true});
  }

  /**
   * The controls that a patch sets.
   *
   * @param {any} patch
   */
  #touchedBy(patch) {
    const paths = leaves(patch).map(fieldPath);
    return this.#controls.filter(({fields}) => (
      fields.some(({path}) => paths.includes(fieldPath(path)))
    ));
  }

  /**
   * Say it next to the control that asked for it, else next to the one that it is about.
   *
   * @param {{error: import('../api/api.js').ApiError, patch: any}} refusal
   */
  #refused({error, patch}) {
    const asked = patch ? this.#touchedBy(patch) : [];
    const about = this.#controls.filter((control) => error.fields.some(within(control)));
    const places = asked.length ? asked : about;
    if (!places.length) this.#tell(this.#inOneLine(error), {error: true});
    for (const control of places) {
      const own = error.fields.filter(within(control));
      const words = own.map(({message}) => message).join('; ');
      control.refuse(words || this.#inOneLine(error));
    }
  }

  /** @param {import('../api/api.js').ApiError} error */
  #inOneLine({message, fields}) {
    const named = fields.map((field) => `${this.#nameOf(field)}: ${field.message}`);
    return named.join('; ') || message;
  }

  /**
   * What it is called on the screen.
   *
   * @param {{path: string}} refused
   */
  #nameOf(refused) {
    return this.#controls.find((control) => within(control)(refused))?.name ?? refused.path;
  }
}

/** @param {Event} event */
function detail(event) { return /** @type {CustomEvent} */ (event).detail; }

/** @param {Control} control */
function within(control) {
  const own = control.fields.map((field) => fieldPath(field.path));
  return (/** @type {{path: string}} */ {path}) => (
    own.some((one) => path === one || path.startsWith(`${one}.`))
  );
}
