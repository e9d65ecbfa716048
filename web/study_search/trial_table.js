// @ts-check
/** A trial against the gains before: goals, figures, gains, and what came of the draws. */

import {changeOf} from '../figures/change.js';
import {element} from '../dom/element.js';
import {FIGURES} from '../figures/figure.js';
import {figureNumber} from '../figures/columns.js';
import {goalWords, ratioText} from '../goals/words.js';
import {gainName} from '../trials/gain_names.js';
import {percent} from '../lenses/card.js';
import {valueText} from '../fields/field_names.js';
import {written} from '../fields/quantity.js';

/** @typedef {import('../trials/trials.js').Study} Study */
/** @typedef {import('../trials/trials.js').Trial} Trial */
/** @typedef {{name: string|HTMLElement, title?: string, before: string, after: string,
 *   change: import('../figures/change.js').Change, tone?: ''|'is-kept'|'is-missed'}} Row */

/** One table, filled anew for each trial. */
export class TrialTable {
  element = element('div', {class: 'search-table-scroll', tabindex: 0, role: 'region',
    'aria-label': 'Before and after'});
  #names;
  #built = '';

  /** @param {import('../fields/field_names.js').FieldNames} names */
  constructor(names) { this.#names = names; }

  /**
   * @param {Study} study
   * @param {Trial|null} trial
   * @param {Trial|null} present
   */
  show(study, trial, present) {
    const built = `${study.id} ${trial?.number}`;
    if (!trial || !present || built === this.#built) return;
    this.#built = built;
    const groups = /** @type {[string, Row[]][]} */ ([
      ['Goals, of their bounds', goalRows(study, present, trial)],
      ['Figures', figureRows(present, trial)],
      ['Gains', this.#gainRows(study, present, trial)],
      ['Draws', study.wanted.draws ? drawRows(present, trial) : []],
    ]).filter(([, rows]) => rows.length);
    this.element.replaceChildren(element('table', {class: 'search-table'},
      element('caption', {}, captionOf(study)),
      element('thead', {}, element('tr', {}, ...[
        '', 'before', `trial ${trial.number}`, 'change',
      ].map((text) => element('th', {scope: 'col'}, text)))),
      ...groups.map(([title, rows]) => element('tbody', {},
        element('tr', {class: 'search-group'}, element('th', {scope: 'rowgroup', colspan: 4}, title)),
        ...rows.map(rowElement)))));
  }

  /**
   * @param {Study} study
   * @param {Trial} present
   * @param {Trial} trial
   * @returns {Row[]}
   */
  #gainRows({lane}, present, trial) {
    return Object.keys(trial.values).map((name) => {
      const [before, after] = [present.values[name], trial.values[name]];
      return {
        name: gainName(this.#names, lane, name, {units: true}),
        before: written(before), after: written(after), change: changeOf(before, after, 'none'),
      };
    });
  }
}

/**
 * @param {Study} study
 * @param {Trial} present
 * @param {Trial} trial
 * @returns {Row[]}
 */
function goalRows({experiment}, present, trial) {
  return Object.entries(experiment.goals).map(([name, goal]) => {
    const [before, after] = [present, trial].map(({outcome}) => outcome.ratios[name] ?? null);
    const kept = typeof after === 'number' && after <= 1;
    return {
      name: `${name}, ${goal.priority}`, title: goalWords(goal, experiment.simulation.horizon),
      before: ratioText(before), after: ratioText(after), change: changeOf(before, after, 'less'),
      tone: kept ? 'is-kept' : 'is-missed',
    };
  });
}

/**
 * @param {Trial} present
 * @param {Trial} trial
 * @returns {Row[]}
 */
function figureRows(present, trial) {
  return FIGURES.filter(({studied}) => studied).map((figure) => {
    const [before, after] = [present, trial].map(({outcome}) => outcome.figures[figure.name] ?? null);
    return {
      name: `${figure.title} [${figure.shown_unit}]`, title: figure.meaning,
      before: figureNumber(figure, before), after: figureNumber(figure, after),
      change: changeOf(before, after, figure.better),
    };
  });
}

/**
 * @param {Trial} present
 * @param {Trial} trial
 * @returns {Row[]}
 */
function drawRows(present, trial) {
  const means = FIGURES.filter(({name}) => name in (present.draws.means ?? {})).map((figure) => {
    const [before, after] = [present, trial].map(({draws, beaten}) => (
      beaten ? null : draws.means?.[figure.name] ?? null
    ));
    return {
      name: `${figure.title}, mean [${figure.shown_unit}]`, title: figure.meaning,
      before: figureNumber(figure, before), after: figureNumber(figure, after),
      change: changeOf(before, after, figure.better),
    };
  });
  const none = /** @type {import('../figures/change.js').Change} */ ({kind: 'none', text: ''});
  const shares = /** @type {const} */ ([['diverged', 'diverged'], ['kept', 'kept the hard goals']]);
  return [
    {name: 'run', before: valueText(present.draws.draws), after: valueText(trial.draws.draws),
      change: none},
    ...means, ...shares.map(([key, name]) => ({
      name, before: percent(present.draws[key]), after: percent(trial.draws[key]), change: none,
    })),
  ];
}

/** @param {Study} study */
function captionOf({wanted}) {
  if (!wanted.draws) return 'Before: the gains that the search began with.';
  const which = wanted.judged_by === 'worst' ? 'the worst draw'
    : 'the draw that 95 % of the draws keep below';
  return `Before: the gains that the search began with. Goals and figures are those of ${which}.`;
}

/** @param {Row} row */
function rowElement({name, title, before, after, change, tone = ''}) {
  return element('tr', {}, element('th', {scope: 'row', title}, name),
    element('td', {}, before), element('td', {class: tone || null}, after),
    element('td', {class: `search-change is-${change.kind}`}, change.text));
}
