// @ts-check
/** The form that adds a goal: what is bounded, by how much, of which joint, from when to when. */

import {element} from '../dom/element.js';
import {read, written} from '../fields/quantity.js';
import {BOUNDED} from './words.js';
import {jointOptions} from './row.js';

/** @typedef {import('./words.js').Goal} Goal */

const DIGITS = 3;

/** A form; whoever submits it gets a goal, or reads what is wrong with it. */
export class NewGoal {
  element;
  #what = element('select', {class: 'select', 'aria-label': 'What is bounded'},
    ...BOUNDED.map(({id, title}) => element('option', {value: id}, title)));
  #joint = element('select', {class: 'select', 'aria-label': 'Joint'},
    ...jointOptions());
  #bound = element('input', {class: 'number-box', inputmode: 'decimal', 'aria-label': 'Bound'});
  #unit = element('span', {class: 'unit'});
  #start = element('input', {class: 'number-box', inputmode: 'decimal', 'aria-label': 'From', value: '0'});
  #end = element('input', {class: 'number-box', inputmode: 'decimal', 'aria-label': 'To', placeholder: 'end'});
  #priority = element('select', {class: 'select', 'aria-label': 'Priority'},
    element('option', {value: 'soft', title: 'Made as small as possible'}, 'soft'),
    element('option', {value: 'hard', title: 'Must hold'}, 'hard'));
  #span;
  #alert = element('p', {class: 'control-alert', role: 'alert', hidden: true});
  #add;

  /** @param {(goal: Goal) => Promise<string>} add resolves to why it was refused, or to '' */
  constructor(add) {
    this.#add = add;
    this.#span = element('span', {class: 'goal-span'},
      'from ', this.#start, ' to ', this.#end, element('span', {class: 'unit'}, 's'));
    this.element = element('form', {class: 'goal-new', novalidate: true, on: {
      submit: (event) => { event.preventDefault(); this.#submit(); },
    }},
    element('div', {class: 'goal-new-row'}, this.#what, this.#joint),
    element('div', {class: 'goal-new-row'}, element('span', {}, '≤'), this.#bound, this.#unit, this.#span),
    element('div', {class: 'goal-new-row'}, this.#priority,
      element('button', {class: 'button small', type: 'submit'}, 'Add goal')),
    this.#alert);
    this.#what.addEventListener('change', () => this.#shape());
    this.#shape();
  }

  /**
   * Fill in a figure; whoever sees it may change it.
   *
   * @param {{figure: string, joint: number, bound: number|null}} goal bound in the unit shown
   */
  fill({figure, joint, bound}) {
    this.#what.value = `figure.${figure}`;
    this.#joint.value = String(joint);
    this.#shape();
    // Rounded up: to the nearest, the lane that has it might miss it.
    this.#bound.value = bound === null ? '' : written(roundedUp(bound));
    this.#alert.hidden = true;
    this.element.scrollIntoView({block: 'nearest'});
    this.#bound.focus({preventScroll: true});
    this.#bound.select();
  }

  get #chosen() { return BOUNDED.find(({id}) => id === this.#what.value) ?? BOUNDED[0]; }

  #shape() {
    const {unit, joints, kind} = this.#chosen;
    this.#unit.textContent = unit;
    this.#joint.disabled = !joints;
    if (!joints) this.#joint.value = '0';
    this.#span.hidden = kind === 'figure';
  }

  async #submit() {
    const {kind, name, factor, unit} = this.#chosen;
    const [bound, start] = [read(this.#bound.value, unit), read(this.#start.value, 's')];
    const end = this.#end.value.trim() === '' ? undefined : read(this.#end.value, 's');
    if (![bound, start, end ?? 0].every(Number.isFinite)) {
      this.#tell(`Give the bound${kind === 'response' ? ', and the times in s,' : ''} as numbers.`);
      return;
    }
    /** @type {any} */ const goal = {
      kind, bound: bound / factor, joint: Number(this.#joint.value), priority: this.#priority.value,
      ...(kind === 'response' ? {channel: name, start, ...(end !== undefined && {end})} : {figure: name}),
    };
    this.#tell(await this.#add(goal));
  }

  /** @param {string} text why it was refused, or '' */
  #tell(text) {
    this.#alert.textContent = text;
    this.#alert.hidden = !text;
    if (!text) this.#bound.value = '';
  }
}

/**
 * @param {number} value
 * @returns {number} of three digits, not less
 */
function roundedUp(value) {
  const near = Number(value.toPrecision(DIGITS));
  const unit = 10 ** (Math.floor(Math.log10(Math.abs(value))) - DIGITS + 1);
  return near >= value ? near : Number((near + unit).toPrecision(DIGITS));
}
