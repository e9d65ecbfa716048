// @ts-check
/** The form that begins a study: its kind, its lane, what it is told, and what is still missing. */

import {element, freshId} from '../dom/element.js';
import {ApiError} from '../api/api.js';
import {SCHEMA} from '../api/schema_document.js';
import {beginStudy, studyKinds} from '../api/requests/studies.js';
import {RUNS_ARE_THE_OWNERS, isWatching} from '../api/watch_only.js';
import {Schema} from '../fields/schema.js';
import {recall, remember} from '../screen/remembered.js';
import {Axes} from './axes.js';
import {FormField} from './form_field.js';
import {GainTable} from './gain_table.js';
import {isUncertain, lacks, risk} from './readiness.js';
import {gainsOf, numbersOf} from './tunable.js';
import {KINDS} from './words.js';

/** @typedef {import('../api/api.js').Api} Api */
/** @typedef {import('../api/requests/studies.js').Kind} Kind */
/** @typedef {import('../api/requests/studies.js').Summary} Summary */
/** @typedef {import('../fields/merge_patch.js').Document} Document */

/** What has a control of its own. */
const OWN = new Set(['lane', 'gains', 'axes']);
/** As the server has it where nobody says how many. */
const USUAL_DRAWS = 50;
const NO_NUMBER = 'Give a number.';

/** A form; whoever submits it begins a study, or reads what is wrong with it. */
export class NewStudy {
  element;
  #api;
  #begun;
  #schema = new Schema(SCHEMA);
  /** @type {{[kind: string]: FormField[]}} */ #fields = {};
  /** @type {Kind} */ #kind = 'tune';
  #lane = element('select', {
    id: freshId('study-lane'), class: 'select', on: {change: () => this.refresh()},
  });
  #title = element('input', {
    id: freshId('study-title'), class: 'text-box', maxlength: 200, autocomplete: 'off', placeholder: 'optional',
  });
  #gains = new GainTable(() => this.#check());
  #axes = new Axes(() => this.#check());
  #does = element('p', {class: 'study-does'});
  #told = element('div', {class: 'study-fields'});
  #risk = element('p', {class: 'study-risk', hidden: true});
  #missing = element('ul', {id: freshId('study-missing'), class: 'study-missing'});
  #alert = element('p', {class: 'control-alert', role: 'alert'});
  #submit = element('button', {
    class: 'button primary', type: 'submit', 'aria-describedby': this.#missing.id,
  }, 'Begin');
  #lanes = '';
  #shown = '';
  #asked = false;
  #busy = false;

  /**
   * @param {Api} api
   * @param {(summary: Summary) => void} begun
   */
  constructor(api, begun) {
    this.#api = api;
    this.#begun = begun;
    const last = recall('studies.kind');
    if (last && last in KINDS) this.#kind = /** @type {Kind} */ (last);
    this.element = element('form', {class: 'study-new', novalidate: true, 'aria-label': 'New study', on: {
      submit: (event) => { event.preventDefault(); this.#send(); },
    }}, this.#kinds(), this.#does,
    element('div', {class: 'study-field'}, element('label', {for: this.#lane.id}, 'Lane'), this.#lane),
    this.#told,
    element('div', {class: 'study-field'}, element('label', {for: this.#title.id}, 'Title'), this.#title),
    this.#risk, this.#missing, this.#alert, element('div', {class: 'study-row'}, this.#submit));
    for (const type of ['hello', 'patch', 'connection']) api.addEventListener(type, () => this.refresh());
    api.addEventListener('select', () => { this.#follow(); this.refresh(); });
  }

  #kinds() {
    const group = freshId('study-kind');
    return element('div', {class: 'segments study-kinds', role: 'radiogroup', 'aria-label': 'Kind of study'},
      ...Object.entries(KINDS).map(([kind, {title}]) => element('label', {}, element('input', {
        type: 'radio', name: group, value: kind, checked: kind === this.#kind,
        on: {change: () => this.#choose(/** @type {Kind} */ (kind))},
      }), element('span', {}, title))));
  }

  /** @param {Kind} kind */
  #choose(kind) {
    this.#kind = kind;
    remember('studies.kind', kind);
    this.refresh();
  }

  /** Ask once what studies are told. */
  async ask() {
    if (this.#asked) return;
    this.#asked = true;
    try {
      const kinds = await studyKinds();
      for (const [kind, node] of Object.entries(kinds)) {
        const section = {kind: /** @type {const} */ ('object'), path: [], title: '', description: '', node};
        const fields = new Schema(node).contents(section, {})
          .filter((item) => 'options' in item && !OWN.has(item.path[0]));
        this.#fields[kind] = fields.map((field) => (
          new FormField(/** @type {import('../fields/schema.js').Field} */ (field), () => this.#check())
        ));
      }
      this.#alert.textContent = '';
    } catch (error) {
      this.#asked = false;
      this.#alert.textContent = /** @type {Error} */ (error).message;
    }
    this.refresh();
  }

  #follow() {
    const {selected, lanes} = this.#api;
    if (lanes.some(({name}) => name === selected)) this.#lane.value = selected;
  }

  /** Show the experiment as it is now. */
  refresh() {
    const {lanes, experiment} = this.#api;
    if (!lanes.length || !experiment.lanes) return;
    const names = JSON.stringify(lanes.map(({name}) => name));
    if (names !== this.#lanes) {
      const before = this.#lanes && this.#lane.value;
      this.#lanes = names;
      this.#lane.replaceChildren(...lanes.map(({name}) => element('option', {value: name}, name)));
      if (before && lanes.some(({name}) => name === before)) this.#lane.value = before;
      else this.#follow();
    }
    this.#does.textContent = KINDS[this.#kind].does;
    const fields = this.#fields[this.#kind] ?? [];
    const gains = gainsOf(this.#schema, experiment, this.#lane.value);
    if (this.#kind === 'tune') {
      this.#gains.show(this.#lane.value, gains);
      fields.find(({name}) => name === 'draws')?.suggest(isUncertain(experiment) ? USUAL_DRAWS : 0);
    }
    if (this.#kind === 'sweep') this.#axes.show([...gains, ...numbersOf(this.#schema, experiment)]);
    const shown = `${this.#kind} ${fields.length}`;
    if (shown !== this.#shown) {
      this.#shown = shown;
      this.#clear();
      this.#told.replaceChildren(
        ...(this.#kind === 'tune' ? [this.#gains.element] : []),
        ...(this.#kind === 'sweep' ? [this.#axes.element] : []), ...fields.map((field) => field.element),
      );
    }
    this.#check();
  }

  /** @returns {Document} */
  get #wanted() {
    const fields = this.#fields[this.#kind] ?? [];
    return {
      lane: this.#lane.value, ...Object.fromEntries(fields.map((field) => [field.name, field.value])),
      ...(this.#kind === 'tune' && {gains: this.#gains.value}),
      ...(this.#kind === 'sweep' && {axes: this.#axes.value}),
    };
  }

  /** Say what is missing. */
  #check() {
    const found = lacks(this.#kind, this.#api.experiment, this.#wanted);
    if (isWatching()) found.unshift({text: RUNS_ARE_THE_OWNERS, group: '', action: ''});
    const warning = risk(this.#kind, this.#api.experiment, this.#wanted);
    this.#risk.hidden = !warning;
    if (this.#risk.textContent !== warning) this.#risk.textContent = warning;
    const texts = JSON.stringify(found);
    if (this.#missing.dataset.texts !== texts) {
      this.#missing.dataset.texts = texts;
      this.#missing.replaceChildren(...found.map(({text, group, action}) => element('li', {},
        element('span', {}, text), group && !isWatching() && element('button', {
          class: 'button small', type: 'button',
          on: {click: () => this.#api.dispatchEvent(new CustomEvent('group', {detail: group}))},
        }, action))));
    }
    this.#submit.disabled = this.#busy || found.length > 0 || !this.#api.connected;
  }

  #clear() {
    this.#alert.textContent = '';
    this.#gains.clear();
    this.#axes.clear();
    for (const field of this.#fields[this.#kind] ?? []) field.refuse('');
  }

  /**
   * @param {Document} wanted
   * @returns {boolean} whether everything typed is a number
   */
  #numbers(wanted) {
    const places = [
      ...(this.#fields[this.#kind] ?? []).map(({name}) => ({path: name, numbers: [wanted[name]]})),
      ...Object.entries(wanted.gains ?? {}).map(([name, {low, high}]) => (
        {path: `gains.${name}`, numbers: [low, high]}
      )),
      ...(wanted.axes ?? []).map((/** @type {Document} */ {low, high, count}, /** @type {number} */ index) => (
        {path: `axes.${index}`, numbers: [low, high, count]}
      )),
    ].filter(({numbers}) => numbers.some(Number.isNaN));
    for (const {path} of places) this.#refuse(path, NO_NUMBER);
    return !places.length;
  }

  /**
   * @param {string} path
   * @param {string} text
   * @returns {boolean} whether it has a place in the form
   */
  #refuse(path, text) {
    const own = path.replace(/^wanted\./, '');
    const gain = /^gains\.("(?:[^"\\]|\\.)*"|[^.]+)/.exec(own)?.[1];
    if (gain && this.#gains.refuse(gain.startsWith('"') ? JSON.parse(gain) : gain, text)) return true;
    if (this.#kind === 'sweep' && this.#axes.refuse(own, text)) return true;
    const field = (this.#fields[this.#kind] ?? []).find(({name}) => name === own);
    field?.refuse(text);
    return field !== undefined;
  }

  async #send() {
    const wanted = this.#wanted;
    this.#clear();
    if (this.#busy || !this.#numbers(wanted)) return;
    this.#busy = true;
    this.#check();
    try {
      // What is typed beside it counts as well.
      await this.#api.settled();
      const summary = await beginStudy({kind: this.#kind, wanted, title: this.#title.value.trim()});
      this.#title.value = '';
      this.#begun(summary);
    } catch (error) {
      this.#fail(error);
    }
    this.#busy = false;
    this.#check();
  }

  /** @param {unknown} error */
  #fail(error) {
    const fields = error instanceof ApiError ? error.fields : [];
    const rest = fields.filter(({path, message}) => !this.#refuse(path, message));
    if (fields.length && !rest.length) return;
    const {message} = /** @type {Error} */ (error);
    this.#alert.textContent = rest.map((one) => one.message).join('; ') || message;
  }
}
