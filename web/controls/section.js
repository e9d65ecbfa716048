// @ts-check
/** Controls under headings: the gains of a lane by group, the other parts of the experiment. */

import {ChoiceControl} from './choice.js';
import {ConstantControl} from './constant.js';
import {FractionControl} from './fraction.js';
import {JointsControl} from './joints.js';
import {NumberControl} from './number.js';
import {SwitchControl} from './switch.js';
import {VariantControl} from './variant.js';
import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {valueAt} from '../fields/merge_patch.js';
import {rememberOpen} from '../screen/remembered.js';

/** @typedef {import('../fields/schema.js').Field} Field */
/** @typedef {import('../fields/schema.js').Section} Section */
/** @typedef {import('./control.js').Control} Control */
/** @typedef {import('./control.js').Context} Context */

const KINDS = {
  number: NumberControl,
  joints: JointsControl,
  vector: JointsControl,
  choice: ChoiceControl,
  switch: SwitchControl,
  constant: ConstantControl,
  text: ConstantControl,
};

/**
 * @param {Field} field
 * @param {Context} context
 * @returns {Control}
 */
function controlFor(field, context) {
  const Kind = KINDS[field.kind];
  return new Kind(field, context);
}

/**
 * One control a field; a numerator and its denominator share one.
 *
 * @param {readonly Field[]} fields
 * @param {Context} context
 * @returns {Control[]}
 */
function controlsFor(fields, context) {
  const byKey = new Map(fields.map((field) => [field.path[field.path.length - 1], field]));
  const pairs = fields.flatMap((field) => {
    const below = field.fraction && byKey.get(field.fraction.over);
    return below ? [{field, below}] : [];
  });
  const shared = new Set(pairs.map(({below}) => below));
  return fields.filter((field) => !shared.has(field)).map((field) => {
    const below = pairs.find((pair) => pair.field === field)?.below;
    return below ? new FractionControl(field, below, context) : controlFor(field, context);
  });
}

/** A foldable heading that says how many of its values differ from the preset. */
export class Group {
  element;
  /** @type {Control[]} */ controls = [];
  body = element('div', {class: 'group-body'});
  #changed = element('span', {class: 'group-changed'});

  /**
   * @param {string} title
   * @param {string} key under which its fold is remembered
   * @param {boolean} open at first
   */
  constructor(title, key, open) {
    const head = element('summary', {}, icon('chevron'), element('span', {}, title), this.#changed);
    this.element = element('details', {class: 'group', 'data-group': key}, head, this.body);
    rememberOpen(this.element, key, open);
  }

  /**
   * @param {readonly Field[]} fields
   * @param {Context} context
   */
  add(fields, context) {
    const controls = controlsFor(fields, context);
    this.controls.push(...controls);
    this.body.append(...controls.map((control) => control.element));
  }

  /** @param {{flash?: boolean}} [options] */
  refresh(options) {
    for (const control of this.controls) control.refresh(options);
    const changed = this.controls.filter((control) => control.differs).length;
    this.#changed.textContent = changed ? `${changed} changed` : '';
  }
}

/** One part of the experiment; rebuilt when another variant of it is chosen. */
export class SectionGroup extends Group {
  #schema;
  #section;
  #context;
  #fields = element('div', {class: 'group-fields'});
  /** @type {VariantControl|null} */ #variant = null;
  #built = '';

  /**
   * @param {import('../fields/schema.js').Schema} schema
   * @param {Section} section
   * @param {Context} context
   */
  constructor(schema, section, context) {
    super(section.title, section.path.join('.'), false);
    this.#schema = schema;
    this.#section = section;
    this.#context = context;
    if (section.kind === 'union') {
      this.#variant = new VariantControl(schema, section, context);
      this.body.append(this.#variant.element);
    }
    this.body.append(this.#fields);
  }

  /** @param {{flash?: boolean}} [options] */
  refresh(options) {
    const value = valueAt(this.#context.api.experiment, this.#section.path);
    const variant = this.#variant ? value[this.#schema.tag(this.#section)] : 'only';
    if (variant !== this.#built) {
      this.#built = variant;
      this.controls = this.#variant ? [this.#variant] : [];
      this.#fields.replaceChildren();
      this.#fill(this.#section, value, this.#fields);
    }
    super.refresh(options);
  }

  /**
   * @param {Section} section
   * @param {any} value
   * @param {HTMLElement} place
   */
  #fill(section, value, place) {
    for (const item of this.#schema.contents(section, value)) {
      if ('node' in item) {
        const box = element('section', {class: 'subgroup', 'aria-label': item.title});
        box.append(element('h3', {title: item.description}, item.title));
        place.append(box);
        this.#fill(item, value[item.path[item.path.length - 1]], box);
      } else {
        const control = controlFor(item, this.#context);
        this.controls.push(control);
        place.append(control.element);
      }
    }
  }
}
