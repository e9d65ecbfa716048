// @ts-check
/** Compromises: any two ratios or figures of all trials, with the front that no trial beats. */

import {element, freshId} from '../dom/element.js';
import {plain} from '../plots/figure.js';
import {scaleOf} from '../trials/scales.js';
import {fateOf, measuresOf, softGoals} from '../trials/trials.js';

/** @typedef {import('../trials/point_plot.js').PointSheet} PointSheet */
/** @typedef {import('../trials/trials.js').Measure} Measure */
/** @typedef {import('../trials/trials.js').Study} Study */
/** @typedef {import('../trials/trials.js').Trial} Trial */

/** What is shown against each other where fewer than two goals are soft. */
const USUAL = ['figure.chattering', 'figure.mae'];

/** Two lists, and the sheet of what they name. */
export class Compromises {
  element = element('div', {class: 'search-row'});
  #lists = [];
  /** @type {Measure[]} */ #measures = [];
  #changed;

  /** @param {() => void} changed */
  constructor(changed) { this.#changed = changed; }

  /** @param {Study} study another one than before */
  begin(study) {
    this.#measures = measuresOf(study);
    const soft = softGoals(study);
    const first = soft.length > 1 ? soft.slice(0, 2).map((name) => `ratio.${name}`) : USUAL;
    this.#lists = ['Across', 'Up'].map((title, at) => {
      const id = freshId('search-axis');
      const select = element('select', {id, class: 'select', on: {change: () => this.#changed()}},
        ...this.#measures.map((one) => element('option', {
          value: one.id, selected: one.id === first[at],
        }, titleOf(one))));
      return {select, label: element('label', {class: 'search-axis', for: id}, title)};
    });
    this.element.replaceChildren(...this.#lists.map(({select, label}) => (
      element('span', {class: 'search-axis-pair'}, label, select)
    )));
  }

  /**
   * @param {Study} study
   * @param {Trial[]} trials
   * @param {Pick<PointSheet, 'passes'|'marked'>} rest
   * @returns {PointSheet}
   */
  sheet(study, trials, {passes, marked}) {
    const [across, up] = this.#lists.map(({select}) => (
      /** @type {Measure} */ (this.#measures.find(({id}) => id === select.value))
    ));
    const values = (/** @type {Measure} */ {of}) => (
      Float64Array.from(trials, (trial) => of(trial) ?? NaN)
    );
    const [x, y] = [values(across), values(up)];
    const front = (study.result?.front ?? []).filter((/** @type {number} */ one) => one < trials.length);
    const needed = [...front, ...marked.map(([, number]) => number)];
    const line = joinsFront(study, [across, up])
      ? [...front].sort((one, other) => x[one] - x[other]) : [];
    return {
      label: `${across.title} against ${up.title}, one point a trial; ${front.length} on the front`,
      x, y, passes, fates: trials.map(fateOf),
      across: scaleOf(plain(titleOf(across)), x, needed.map((number) => x[number])),
      up: scaleOf(plain(titleOf(up)), y, needed.map((number) => y[number])),
      marked: [...front.map((number) => (
        /** @type {[import('../trials/point_marks.js').Mark, number]} */ (['front', number])
      )), ...marked],
      lines: (colors) => [{
        type: 'scatter', mode: 'lines', uid: 'front', hoverinfo: 'skip',
        x: line.map((number) => x[number]), y: line.map((number) => y[number]),
        line: {color: colors.good, width: 1.6},
      }],
      key: `${across.id} ${up.id} ${line.join()}`,
    };
  }
}

/** @param {Measure} measure */
function titleOf({title, unit}) { return unit ? `${title} [${unit}]` : title; }

/**
 * The front is a line where the axes are all that it is of.
 *
 * @param {Study} study
 * @param {Measure[]} axes
 */
function joinsFront(study, axes) {
  const soft = softGoals(study).map((name) => `ratio.${name}`);
  return soft.length === 2 && soft.every((id) => axes.some((axis) => axis.id === id));
}
