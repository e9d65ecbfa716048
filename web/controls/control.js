// @ts-check
/** What every control has: a label, a way back to the preset, an explanation, refusals. */

import {element, freshId, symbol} from '../dom/element.js';
import {fieldPath} from '../fields/field_path.js';
import {icon} from '../dom/icons.js';
import {patchAt, same, valueAt} from '../fields/merge_patch.js';
import {withUnit} from '../fields/quantity.js';
import {attachTooltip, facts} from '../dom/tooltip.js';

/** @typedef {import('../fields/schema.js').Field} Field */
/** @typedef {{api: import('../api/api.js').Api, history: import('../api/undo.js').History}} Context */

const FLASH_MS = 700;

/** One field of the experiment. Each kind draws its own input and shows its own value. */
export class Control {
  field;
  element;
  /** Where the kind puts its input. */
  place = element('div', {class: 'control-input'});
  /** Where the kind puts what belongs beside the label. */
  beside = element('span', {class: 'control-beside'});
  /** @protected */ id = freshId('control');
  /** @protected */ describedBy = freshId('meaning');
  /** @protected */ label;
  #context;
  #dot;
  #note = element('span', {class: 'control-note'});
  #alert = element('p', {class: 'control-alert', role: 'alert'});
  #meaning;
  /** What was shown last: value, baseline, why it has no effect. */
  /** @type {any[]} */ #last = [];

  /**
   * @param {Field} field
   * @param {Context} context
   */
  constructor(field, context) {
    this.field = field;
    this.#context = context;
    const mark = field.symbol && symbol(field.symbol);
    this.label = element('label', {for: this.id, class: 'control-label'}, mark, field.title);
    this.#dot = element('button', {
      class: 'control-dot', type: 'button', on: {click: () => this.reset()},
    });
    this.#meaning = element('span', {id: this.describedBy, hidden: true});
    const name = element('div', {class: 'control-name'}, this.label, this.beside);
    this.element = element(
      'div', {class: `control is-${field.kind}`, 'data-path': fieldPath(field.path)},
      this.#dot, name, this.place, this.#note, this.#alert,
      this.#meaning,
    );
    attachTooltip(this.element, this.label, field);
  }

  /** Name for people who hear the screen. */
  get name() { return this.field.title; }

  /** The fields that it sets. */
  get fields() { return [this.field]; }

  /** The server's value. */
  get current() { return this.currentOf(this.field); }

  /** The value in the loaded preset; in a lane that it doesn't have, the law's own default. */
  get baseline() { return this.baselineOf(this.field); }

  /**
   * @protected
   * @param {Field} field
   */
  currentOf({path}) { return valueAt(this.#context.api.experiment, path); }

  /**
   * @protected
   * @param {Field} field
   */
  baselineOf(field) {
    const {path} = field;
    const {baseline, experiment} = this.#context.api;
    const above = path.slice(0, -1);
    const [was, is] = [valueAt(baseline, above), valueAt(experiment, above)];
    const alike = was && was.law === is?.law && was.kind === is?.kind;
    return alike ? valueAt(baseline, path) : field.default;
  }

  /** Whether the value is not the preset's. */
  get differs() { return !same(this.current, this.baseline); }

  /**
   * Show what the server has.
   *
   * @param {{flash?: boolean, force?: boolean}} [options] flash where another's hand has changed
   *   the value; force also where it hasn't changed
   */
  refresh({flash = false, force = false} = {}) {
    const {current, baseline} = this;
    if (current === undefined) return;
    const idle = this.#idle;
    const now = [current, baseline, idle];
    if (!force && same(now, this.#last)) return;
    if (flash && !same(current, this.#last[0]) && !this.held) this.#flash();
    this.#last = now;
    this.show(current, baseline);
    this.element.classList.toggle('is-changed', this.differs);
    const value = this.inText(baseline);
    this.#dot.setAttribute('aria-label', `${this.name}: back to ${value}`);
    this.#dot.title = `Back to ${value}`;
    this.#dot.disabled = !this.differs;
    this.element.classList.toggle('is-idle', idle !== '');
    this.#note.textContent = idle;
    const told = facts(this.field).map((fact) => fact.join(': '));
    this.#meaning.textContent = [idle, this.field.description, ...told].filter(Boolean).join('. ');
  }

  /**
   * Show a value, unless a person is changing it.
   *
   * @abstract
   * @param {any} _value
   * @param {any} _baseline
   */
  show(_value, _baseline) {}

  /** Whether a person is changing it. */
  get held() { return false; }

  /**
   * @param {any} value
   * @returns {string}
   */
  inText(value) {
    if (value === null) return 'off';
    if (typeof value === 'boolean') return value ? 'on' : 'off';
    if (Array.isArray(value)) return value.map((item) => withUnit(item, '')).join(', ');
    return typeof value === 'number' ? withUnit(value, this.field.unit) : String(value);
  }

  /**
   * Say in words why a value was refused. The next one that is taken clears it.
   *
   * @param {string} text
   */
  refuse(text) {
    this.#alert.textContent = text;
    this.element.classList.toggle('is-refused', text !== '');
  }

  /** Bring the preset's value back. */
  reset() {
    this.refuse('');
    this.set(this.baseline);
  }

  /**
   * A value on the way.
   *
   * @protected
   * @param {any} value
   */
  move(value) {
    this.#context.history.move(patchAt(this.field.path, value), this.#label);
  }

  /**
   * The end of the way.
   *
   * @protected
   */
  commit() { return this.#context.history.commit(); }

  /**
   * Give up the way: the value is again as before it.
   *
   * @protected
   */
  cancel() { return this.#context.history.cancel(); }

  /**
   * Be told when the value is changed by something else than the hand that moves it here.
   *
   * @protected
   * @param {() => void} interrupt
   * @returns {() => void} ends that
   */
  watch(interrupt) {
    const {api, history} = this.#context;
    const watched = new AbortController();
    const {signal} = watched;
    api.addEventListener('patch', (event) => {
      const {author, patch} = /** @type {CustomEvent} */ (event).detail;
      if (author !== api.client && valueAt(patch, this.field.path) !== undefined) interrupt();
    }, {signal});
    api.addEventListener('hello', interrupt, {signal});
    history.addEventListener('interrupt', interrupt, {signal});
    return () => watched.abort();
  }

  /**
   * The server has answered: what it has is what is shown.
   *
   * @protected
   */
  settle() { this.refresh({force: true}); }

  /**
   * A value chosen at once.
   *
   * @protected
   * @param {any} value
   */
  set(value) { return this.setAll(this.field.path, value); }

  /**
   * A value chosen at once for the field or for what it belongs to.
   *
   * @protected
   * @param {readonly string[]} path
   * @param {any} value
   */
  async setAll(path, value) {
    this.#context.history.move(patchAt(path, value), this.#label);
    await this.commit();
    this.settle();
  }

  get #label() {
    const [section, lane] = this.field.path;
    return section === 'lanes' ? `${this.field.title} of ${lane}` : this.field.title;
  }

  /** Why it has no effect as things stand, or ''. */
  get #idle() {
    const {applies, needs, weight, path} = this.field;
    const {experiment} = this.#context.api;
    if (applies && applies !== experiment.simulation.mode) return `Acts in ${applies} mode only`;
    const beside = valueAt(experiment, path.slice(0, -1)) ?? {};
    const [choice] = Object.entries(needs).find(([key, options]) => (
      key in beside && !options.includes(beside[key])
    )) ?? [];
    if (choice) return `No effect under ${beside[choice]} ${choice}`;
    const weighs = !weight || [beside[weight.name]].flat().some((share) => share !== 0);
    return weighs ? '' : `No effect while ${weight.symbol} = 0`;
  }

  #flash() {
    this.element.classList.add('is-flashing');
    setTimeout(() => this.element.classList.remove('is-flashing'), FLASH_MS);
  }
}

/**
 * A button that opens and closes what belongs to it.
 *
 * @param {string} label
 * @param {HTMLElement} content
 * @returns {{button: HTMLButtonElement, open: (open: boolean) => void}}
 */
export function disclosure(label, content) {
  content.id = freshId('disclosed');
  const button = element('button', {
    class: 'disclosure', type: 'button', 'aria-label': label, 'aria-controls': content.id,
    title: label, on: {click: () => open(content.hidden)},
  }, icon('chevron'));
  const open = (/** @type {boolean} */ wanted) => {
    content.hidden = !wanted;
    button.setAttribute('aria-expanded', String(wanted));
  };
  open(false);
  return {button, open};
}
