// @ts-check
/** The figures of the whole response, each lane beside its baselines. */

import {element} from '../dom/element.js';
import {COLUMNS, best, figureNumber, figureText, inDigits} from '../figures/columns.js';
import {figureOf} from '../figures/figure.js';
import {changeOf} from '../figures/change.js';
import {dashOf} from '../logs/look.js';
import {boundedFigure} from '../goals/words.js';
import {icon} from '../dom/icons.js';
import {isWatching} from '../api/watch_only.js';
import {withScrollCue} from '../dom/scroll_cue.js';
import {written} from '../fields/quantity.js';

/** @typedef {import('../figures/columns.js').Column} Column */
/** @typedef {import('../api/preview_message.js').LaneResponse} LaneResponse */
/** @typedef {import('../api/preview_message.js').Response} Response */
/** @typedef {import('./baselines.js').Baseline} Baseline */
/**
 * @typedef {{lanes: import('../api/api.js').Lane[], selected: string, joints: number[],
 *   current: Response|null, baselines: Baseline[],
 *   logs: import('./curves.js').Logged[]}} Compared
 */
/**
 * @typedef {{row: HTMLTableRowElement, cells: HTMLTableCellElement[],
 *   estimate: HTMLTableCellElement}} Row
 */

const DIVERGED = 'diverged';
/** Error of an angle [rad] above which a run is not to be trusted blindly; ours. */
const GOOD = 1e-3;
const ACCURACY = figureOf('error_estimate');
const ESTIMATE = {
  id: 'estimate', title: ACCURACY.short, unit: ACCURACY.shown_unit, meaning: `${ACCURACY.meaning}.`,
};

/** A margin is no figure of a run; of the columns of six joints the chosen ones' are shown. */
function columnsFor(/** @type {number[]} */ joints) {
  return COLUMNS.filter(({of, isMargin}) => !isMargin && (!of || joints.includes(of)));
}

/** The table; its rows are built when there are others, and filled in place. */
export class ResponseMetrics {
  element;
  #table = element('table', {class: 'metrics-table response-table'});
  /** @type {Map<string, Row>} */ #rows = new Map();
  #until = element('span', {class: 'metrics-unit'});
  #built = '';
  /** @type {HTMLButtonElement[]} */ #goalButtons = [];
  #setGoal;
  /** @type {Compared|null} */ #compared = null;

  /**
   * @param {(goal: {figure: string, joint: number, bound: number|null}) => void} setGoal a figure
   *   is to be bounded, by what the selected lane has, in the unit on the screen
   */
  constructor(setGoal) {
    this.#setGoal = setGoal;
    this.element = withScrollCue(element('div', {
      class: 'response-figures', tabindex: 0, role: 'region',
      'aria-label': 'Metrics of the whole response',
    }, this.#table));
  }

  /** @param {Compared} compared */
  show(compared) {
    const {lanes, joints, baselines, current, logs} = compared;
    this.#compared = compared;
    const columns = columnsFor(joints);
    const shown = baselines.filter((baseline) => baseline.shown);
    const built = JSON.stringify([lanes, joints, shown.map(({id, name}) => [id, name]),
      logs.map(({number}) => number)]);
    if (built !== this.#built) this.#build(lanes, columns, shown, logs);
    this.#built = built;
    for (const button of this.#goalButtons) {
      button.disabled = !current;
      button.title = current ? 'Set a goal' : 'Set a goal: once there is a response';
    }
    setText(this.#until, current ? ` 0 to ${current.horizon} s` : '');
    const merits = meritsOf(lanes, current, columns);
    for (const {name} of lanes) {
      const now = current?.lanes.get(name) ?? null;
      const estimated = current?.estimated ?? true;
      this.#fillCurrent(
        name, now, columns, {selected: name === compared.selected, estimated, merits},
      );
      for (const baseline of shown) {
        this.#fillBaseline(name, baseline, now, columns);
      }
    }
    for (const log of logs) this.#fillLog(log, columns);
  }

  /**
   * @param {import('../api/api.js').Lane[]} lanes
   * @param {Column[]} columns
   * @param {Baseline[]} baselines
   * @param {import('./curves.js').Logged[]} logs
   */
  #build(lanes, columns, baselines, logs) {
    this.#rows.clear();
    this.#goalButtons = [];
    const bodies = lanes.map(({name, color}) => {
      const dot = element('span', {class: 'metrics-dot', 'aria-hidden': 'true'});
      dot.style.setProperty('--lane', color);
      const body = element('tbody', {}, this.#row(
        key(name), columns, element('span', {class: 'response-lane'}, dot,
          element('span', {class: 'response-lane-name', title: name}, name),
        element('span', {class: 'response-state'})),
      ));
      for (const {id, name: title} of baselines) {
        const words = element('span', {class: 'response-against'}, title);
        body.append(this.#row(key(name, id), columns, words));
        this.#rows.get(key(name, id))?.row.classList.add('is-baseline');
      }
      return body;
    });
    bodies.push(...logs.map(({number, name}, index) => {
      const line = element('span', {class: 'log-line', 'aria-hidden': 'true'});
      const head = element('span', {class: 'response-lane', 'data-line': dashOf(index).name}, line,
        element('span', {class: 'response-lane-name', title: name}, name));
      return element('tbody', {}, this.#row(logKey(number), columns, head));
    }));
    this.#table.replaceChildren(
      element('caption', {class: 'metrics-caption'}, 'The whole response of each lane, and how it '
        + 'changed against its baselines'),
      heading(columns, this.#until, (column) => this.#goalButton(column)), ...bodies,
    );
  }

  /** @param {Column} column */
  #goalButton(column) {
    const {figure, of = 0, title} = column;
    if (!boundedFigure(figure.name) || isWatching()) return null;
    const button = element('button', {
      type: 'button', class: 'response-goal', 'aria-label': `Set a goal: ${title}`,
      on: {click: () => {
        const {current = null, selected = ''} = this.#compared ?? {};
        const bound = valueOf(column, current?.lanes.get(selected) ?? null);
        this.#setGoal({figure: figure.name, joint: of, bound});
      }},
    }, icon('target'));
    this.#goalButtons.push(button);
    return button;
  }

  /**
   * @param {string} at
   * @param {Column[]} columns
   * @param {HTMLElement} head
   */
  #row(at, columns, head) {
    // First, where it is seen before the figures that it is about.
    const [estimate, ...cells] = [ESTIMATE, ...columns].map(({id}) => (
      element('td', {class: `metrics-number metrics-${id}`})
    ));
    const row = element('tr', {}, element('th', {scope: 'row'}, head), estimate, ...cells);
    this.#rows.set(at, {row, cells, estimate});
    return row;
  }

  /**
   * @param {string} name
   * @param {LaneResponse|null} now
   * @param {Column[]} columns
   * @param {{selected: boolean, estimated: boolean, merits: (string|null)[]}} how
   */
  #fillCurrent(name, now, columns, {selected, estimated, merits}) {
    const {row, cells, estimate} = /** @type {Row} */ (this.#rows.get(key(name)));
    const frozen = now?.frozen;
    row.classList.toggle('is-selected', selected);
    row.classList.toggle('is-frozen', Boolean(frozen));
    const state = /** @type {HTMLElement} */ (row.querySelector('.response-state'));
    setText(state, frozen ? DIVERGED : '');
    state.title = frozen?.cause ?? '';
    fillEstimate(estimate, now, estimated);
    columns.forEach((column, index) => {
      const text = textOf(column, now);
      setText(cells[index], text);
      cells[index].classList.toggle('is-best', text === merits[index]);
      const unknown = now && valueOf(column, now) === null ? column.figure.unknown : '';
      if (cells[index].title !== unknown) cells[index].title = unknown;
    });
  }

  /**
   * @param {string} name
   * @param {Baseline} baseline
   * @param {LaneResponse|null} now
   * @param {Column[]} columns
   */
  #fillBaseline(name, {id, response, failure}, now, columns) {
    const {row, cells, estimate} = /** @type {Row} */ (this.#rows.get(key(name, id)));
    const then = response?.lanes.get(name) ?? null;
    fillEstimate(estimate, then);
    const reason = incomparable(now, then, failure || (response ? '' : 'being computed'));
    row.title = reason;
    columns.forEach((column, index) => {
      const change = reason ? /** @type {const} */ ({kind: 'none', text: ''})
        : changeOf(valueOf(column, then), valueOf(column, now), column.figure.better);
      fill(cells[index], textOf(column, then), change);
    });
  }

  /**
   * @param {import('./curves.js').Logged} log
   * @param {Column[]} columns
   */
  #fillLog({number, overlay: {response, begin, end, against}}, columns) {
    const {row, cells, estimate} = /** @type {Row} */ (this.#rows.get(logKey(number)));
    const [lane = null] = response.lanes.values();
    row.title = `the log’s rows from ${written(begin)} to ${written(end)} s, `
      + `against ${against === 'log' ? 'its own' : 'the experiment’s'} desired motion`;
    setText(estimate, '–');
    columns.forEach((column, index) => setText(cells[index], textOf(column, lane)));
  }
}

/** @param {number} number of a log */
function logKey(number) { return `log ${number}`; }

/**
 * @param {string} lane
 * @param {number} [baseline] 0: the current response
 */
function key(lane, baseline = 0) { return JSON.stringify([lane, baseline]); }

/**
 * What a lane reached before it left its bounds is no figure of the whole response.
 *
 * @param {Column} column
 * @param {LaneResponse|null} lane
 */
function valueOf({value}, lane) { return lane && !lane.frozen ? value(lane.metrics, null) : null; }

/**
 * @param {import('../api/api.js').Lane[]} lanes
 * @param {Response|null} current
 * @param {Column[]} columns
 * @returns {(string|null)[]} the best of each column as it is written, null where there is none
 */
function meritsOf(lanes, current, columns) {
  const each = lanes.map(({name}) => current?.lanes.get(name) ?? null);
  return columns.map((column) => best(column, each.map((lane) => valueOf(column, lane))));
}

/**
 * @param {Column} column
 * @param {LaneResponse|null} lane
 */
function textOf(column, lane) { return inDigits(valueOf(column, lane), column.figure.digits); }

/**
 * What a lane reached before it left its bounds can't be compared with a whole run.
 *
 * @param {LaneResponse|null} now
 * @param {LaneResponse|null} then
 * @param {string} waiting why the baseline has no response
 * @returns {string} why the two can't be compared, or ''
 */
function incomparable(now, then, waiting) {
  if (waiting) return waiting;
  if (!then) return 'the baseline has no lane of this name';
  if (then.frozen) return `diverged in the baseline: ${then.frozen.cause}`;
  return now?.frozen ? `diverged: ${now.frozen.cause}` : '';
}

/**
 * @param {HTMLElement} cell
 * @param {string} value
 * @param {import('../figures/change.js').Change} change
 */
function fill(cell, value, {kind, text}) {
  const shown = `${value} ${text}`;
  if (cell.dataset.shown === shown) return;
  cell.dataset.shown = shown;
  cell.replaceChildren(
    element('span', {}, value), ' ', element('span', {class: `response-change is-${kind}`}, text),
  );
}

/**
 * @param {HTMLElement} cell
 * @param {LaneResponse|null} lane
 * @param {boolean} [estimated] false: the estimate is asked for on release
 */
function fillEstimate(cell, lane, estimated = true) {
  const {error_estimate: error = null, unconverged = 0, capped = 0, at_least: atLeast = false} =
    lane?.accuracy ?? {};
  // Rows that were not cut as far as they asked count in the estimate; alone they are no warning.
  const doubtful =
    (error ?? 0) > GOOD || unconverged > 0 || atLeast || (error === null && capped > 0);
  const due = error === null && !estimated;
  const known = error === null ? (due ? '…' : '–') : `${atLeast ? '≥' : '±'}${figureNumber(ACCURACY, error)}`;
  setText(cell, `${known}${doubtful ? ' ⚠' : ''}`);
  cell.classList.toggle('is-doubtful', doubtful);
  cell.title = [
    due ? 'estimated on release' : '',
    (error ?? 0) > GOOD ? `above ${figureText(ACCURACY, GOOD)}` : '',
    atLeast ? 'the true error can be many times this' : '',
    unconverged > 0 ? `${counted(unconverged, 'step')} not solved to tolerance` : '',
    capped > 0 ? `${counted(capped, 'row')} not subdivided as far as its error required` : '',
  ].filter(Boolean).join(', ');
}

/**
 * @param {number} count
 * @param {string} what
 */
function counted(count, what) { return `${count} ${what}${count === 1 ? '' : 's'}`; }

/**
 * @param {Column[]} columns
 * @param {HTMLElement} until to where it goes
 * @param {(column: Column) => HTMLElement|null} goalButton
 */
function heading(columns, until, goalButton) {
  return element('thead', {}, element(
    'tr', {}, element('th', {scope: 'col'}, 'Whole response', until),
    headingCell(ESTIMATE, null), ...columns.map((column) => headingCell(column, goalButton(column))),
  ));
}

/**
 * @param {{title: string, unit: string, meaning: string}} column
 * @param {HTMLElement|null} button
 */
function headingCell({title, unit, meaning}, button) {
  return element('th', {scope: 'col', title: meaning}, title,
    element('span', {class: 'metrics-unit'}, button, unit && ` ${unit}`));
}

/**
 * @param {HTMLElement} node
 * @param {string} text
 */
function setText(node, text) { if (node.textContent !== text) node.textContent = text; }
