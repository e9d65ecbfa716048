// @ts-check
/** Accuracy against chattering over the boundary layer: each point is a run, and sets its ε. */

import {unitOfAll} from '../api/arm.js';
import {element} from '../dom/element.js';
import {plain} from '../plots/figure.js';
import {LensCard} from './card.js';
import {LensFigure, axis} from './figure.js';
import {knee} from './knee.js';
import {keyOf} from '../fields/response_key.js';
import {figureHeading, figureNumber, figureText} from '../figures/columns.js';
import {figureOf} from '../figures/figure.js';
import {written} from '../fields/quantity.js';
import {RUNS_ARE_THE_OWNERS, isWatching} from '../api/watch_only.js';

/** @typedef {import('./card.js').Look} Look */
/** @typedef {import('./figure.js').Colors} Colors */
/**
 * `count`: of all runs that the study makes.
 * @typedef {{count: number, name: string, value: any, present: boolean, mae: number|null,
 *   chattering: number|null, state: string, reason: string}} Row
 */

const [ERROR, CHATTERING] = ['mae', 'chattering'].map(figureOf);
const HEIGHT = 270;
/** Below this ratio of chattering, ε costs nothing. */
const FREE = 1.2;
const LEAST_DECADES = 0.5;
/** What the curve itself varies; any other change makes it old. */
const VARIED = ['epsilon', 'switching'];

/** Measures the curve when asked, point by point. */
export class SmoothingCard {
  element;
  #api;
  #desk;
  #figure = new LensFigure({height: HEIGHT, click: (point) => this.#use(point?.customdata)});
  #button;
  #note = element('p', {class: 'lens-note', role: 'status'});
  #table = element('tbody');
  #details;
  #card;
  /** @type {Row[]} */ #rows = [];
  #measured = '';
  /** @type {AbortController|null} */ #running = null;
  /** @type {Look|null} */ #look = null;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../page/right_panel.js').Desk} desk
   */
  constructor(api, desk) {
    this.#api = api;
    this.#desk = desk;
    this.#button = element('button', {
      class: 'button small', type: 'button', on: {click: () => this.#pressed()},
    }, 'Measure the curve');
    this.#details = element(
      'details', {class: 'lens-details'}, element('summary', {}, 'All points as a table'),
      element('table', {class: 'lens-table'}, heading(), this.#table),
    );
    this.#card = new LensCard({
      title: 'What smoothing costs', equation: 'Eq. 13 with tanh(S/ε)',
      words: 'The same lane over a range of boundary layers ε, one whole run per point: left is '
        + 'quiet, low is accurate. Click a point to set its ε.',
    }, element('div', {class: 'lens-row'}, this.#button, this.#note), this.#figure.element,
    this.#details);
    this.element = this.#card.element;
  }

  /** @param {Look} look */
  show(look) {
    const other = this.#look && this.#look.lane !== look.lane;
    this.#look = look;
    if (other) {
      this.#running?.abort();
      this.#rows = [];
    }
    this.#draw();
  }

  #key() { return keyOf(this.#api.experiment, this.#look?.lane ?? '', VARIED); }

  get #gains() { return this.#api.experiment.lanes?.[this.#look?.lane ?? ''] ?? {}; }

  async #pressed() {
    if (this.#running) {
      this.#running.abort();
      return;
    }
    const lane = this.#look?.lane;
    if (!lane) return;
    this.#running = new AbortController();
    const {signal} = this.#running;
    this.#rows = [];
    this.#measured = this.#key();
    this.#draw();
    try {
      await this.#api.settled();
      await this.#api.runs.study('switching', {lane}, (row) => {
        if (signal.aborted) return;
        this.#rows.push(/** @type {Row} */ (row));
        this.#draw();
      }, signal);
    } catch (error) {
      if (!signal.aborted) this.#desk.tell(/** @type {Error} */ (error).message, {error: true});
    }
    this.#running = null;
    this.#draw();
  }

  /** @param {number|undefined} epsilon */
  async #use(epsilon) {
    const lane = this.#look?.lane;
    if (!lane || typeof epsilon !== 'number') return;
    try {
      const gains = {epsilon: Number(epsilon.toPrecision(4)), switching: 'tanh'};
      await this.#desk.history.change({lanes: {[lane]: gains}}, `ε of ${lane}`);
    } catch (error) {
      this.#desk.tell(/** @type {Error} */ (error).message, {error: true});
    }
  }

  #draw() {
    const look = this.#look;
    if (!look) return;
    const switches = 'switching' in this.#gains;
    const rows = this.#rows;
    this.#button.disabled = !switches;
    this.#button.textContent = this.#running ? 'Stop' : rows.length ? 'Measure again'
      : 'Measure the curve';
    const old = rows.length > 0 && this.#key() !== this.#measured;
    this.#note.textContent = this.#says(switches, old);
    const points = curve(rows);
    this.#figure.element.hidden = !points.length;
    this.#details.hidden = !rows.length;
    this.#table.replaceChildren(...rows.map((row) => this.#tableRow(row)));
    this.#card.finding = finding(points, this.#api.experiment.simulation?.mode);
    const present = old ? null : presentPoint(points, rows, this.#gains);
    if (points.length) {
      this.#figure.draw('Mean error over chattering, one point for each ε', (colors) => (
        curveFigure(colors, look, points, others(rows), present)
      ));
    }
  }

  /**
   * @param {boolean} switches
   * @param {boolean} old
   */
  #says(switches, old) {
    if (isWatching()) return RUNS_ARE_THE_OWNERS;
    if (!switches) return 'This law has no switching function to smooth.';
    const [row] = this.#rows;
    if (this.#running) return row ? `${this.#rows.length} of ${row.count} runs …` : 'The first run …';
    if (old) return 'Measured before the last change.';
    return row ? '' : 'Some short runs, some seconds.';
  }

  /** @param {Row} row */
  #tableRow({name, value, mae, chattering, state, reason}) {
    const isCurve = name === 'epsilon';
    const use = isCurve && mae !== null && element('button', {
      class: 'button small', type: 'button', 'aria-label': `Set ε to ${short(value)}`,
      on: {click: () => this.#use(value)},
    }, 'use');
    return element(
      'tr', {title: reason || null},
      element('th', {scope: 'row'}, isCurve ? `ε = ${short(value)}` : `${value}, now`),
      element('td', {}, figureNumber(ERROR, mae)),
      element('td', {}, figureNumber(CHATTERING, chattering)), element('td', {}, state), element('td', {}, use),
    );
  }
}

function heading() {
  const titles = ['', figureHeading(ERROR), figureHeading(CHATTERING), 'state', ''];
  return element('thead', {}, element('tr', {}, ...titles.map((text) => (
    element('th', {scope: 'col'}, text)
  ))));
}

/** @param {Row} row */
function drawn({mae, chattering}) { return mae !== null && chattering !== null && chattering > 0; }

/** @param {Row[]} rows */
function curve(rows) { return rows.filter((row) => row.name === 'epsilon' && drawn(row)); }

/** @param {Row[]} rows */
function others(rows) {
  return rows.filter((row) => row.name === 'switching' && row.value !== 'tanh' && drawn(row));
}

/** @param {number} epsilon */
function short(epsilon) { return written(Number(epsilon.toPrecision(3))); }

/** @param {Row} row */
function told({value, mae, chattering}) {
  const figures = `${figureText(ERROR, mae)}, ${figureText(CHATTERING, chattering)}`;
  return `ε = ${short(value)} (${figures})`;
}

/**
 * @param {Row[]} points
 * @param {string} mode
 */
function finding(points, mode) {
  if (points.length < 3) return '';
  const least = (/** @type {'mae'|'chattering'} */ figure) => points.reduce((one, row) => (
    Number(row[figure]) < Number(one[figure]) ? row : one
  ));
  const [exact, quiet] = [least('mae'), least('chattering')];
  const restless = Math.max(...points.map(({chattering}) => Number(chattering)));
  if (restless < FREE * Number(quiet.chattering)) {
    const where = mode === 'continuous'
      ? ' A continuous controller does not chatter; the cost shows when it is sampled.' : '';
    return `A small ε costs nothing here; most accurate is ${told(exact)}.${where}`;
  }
  const bend = knee(points);
  const turn = bend ? ` The knee is at ${told(bend)}: a thinner layer adds much chattering for little `
    + 'accuracy, a wider one costs accuracy and hardly reduces chattering.' : '';
  return `Most accurate is ${told(exact)}, quietest ${told(quiet)}.${turn}`;
}

/**
 * @param {(number|null)[]} values
 * @returns {[number, number]} decades around them, enough that small differences look small
 */
function span(values) {
  const known = values.map(Number);
  const [low, high] = [Math.log10(Math.min(...known)), Math.log10(Math.max(...known))];
  const half = Math.max(0.56 * (high - low), LEAST_DECADES / 2);
  return [(low + high) / 2 - half, (low + high) / 2 + half];
}

/**
 * Where the lane is now: as measured, or else between its neighbours on the curve.
 *
 * @param {Row[]} points
 * @param {Row[]} rows
 * @param {{epsilon?: number|number[], switching?: string}} gains
 * @returns {{x: number, y: number}|null}
 */
function presentPoint(points, rows, {epsilon, switching}) {
  if (switching === 'tanh' && typeof epsilon === 'number') {
    const after = points.findIndex(({value}) => value >= epsilon * (1 - 1e-3));
    const [one, two] = [points[Math.max(after - 1, 0)], points[after]];
    if (!two || (after === 0 && two.value > epsilon * (1 + 1e-3))) return null;
    const share = one === two ? 1 : Math.log(epsilon / one.value) / Math.log(two.value / one.value);
    const between = (/** @type {number|null} */ low, /** @type {number|null} */ high) => (
      Number(low) ** (1 - share) * Number(high) ** share
    );
    return {x: between(one.chattering, two.chattering), y: between(one.mae, two.mae)};
  }
  const row = rows.find(({name, value}) => name === 'switching' && value === switching);
  return row && drawn(row) ? {x: Number(row.chattering), y: Number(row.mae)} : null;
}

/**
 * @param {Colors} colors
 * @param {Look} look
 * @param {Row[]} points
 * @param {Row[]} functions
 * @param {{x: number, y: number}|null} present
 */
function curveFigure(colors, {lane, color}, points, functions, present) {
  const places = (/** @type {Row[]} */ rows) => ({
    x: rows.map(({chattering}) => CHATTERING.factor * Number(chattering)),
    y: rows.map(({mae}) => ERROR.factor * Number(mae)),
  });
  const {x, y} = places([...points, ...functions]);
  const numbers = `%{y:.${ERROR.digits}~g} ${ERROR.shown_unit}, `
    + `%{x:.${CHATTERING.digits}~g} ${CHATTERING.shown_unit}`;
  return {
    data: [{
      type: 'scatter', mode: 'lines+markers+text', uid: 'curve', name: plain(lane),
      ...places(points), customdata: points.map(({value}) => value),
      text: points.map(({value}, index) => (index % 3 ? '' : short(value))),
      textposition: 'top center', textfont: {color: colors.muted, size: 10}, cliponaxis: false,
      hovertemplate: `ε = %{customdata:.3~g} ${unitOfAll('rad/s')}<br>${numbers}<br>click to set<extra></extra>`,
      line: {color, width: 1.4}, marker: {color, size: 9},
    }, {
      type: 'scatter', mode: 'markers+text', uid: 'functions', ...places(functions),
      text: functions.map(({value}) => value), textposition: 'bottom center', cliponaxis: false,
      textfont: {color: colors.text, size: 10},
      hovertemplate: `%{text}, now<br>${numbers}<extra></extra>`,
      marker: {symbol: 'diamond-open', size: 10, color: colors.text, line: {width: 1.8}},
    }, {
      type: 'scatter', mode: 'markers', uid: 'present', x: present ? [CHATTERING.factor * present.x] : [],
      y: present ? [ERROR.factor * present.y] : [], hoverinfo: 'skip', cliponaxis: false,
      marker: {symbol: 'circle-open', size: 17, color: colors.text, line: {width: 2}},
    }],
    layout: {
      annotations: kneeMark(colors, knee(points)),
      uirevision: `${lane}-${points.length}`,
      xaxis: axis(colors, {title: axisTitle(CHATTERING), type: 'log', range: span(x)}),
      yaxis: axis(colors, {title: axisTitle(ERROR), type: 'log', range: span(y), nticks: 6}),
    },
  };
}

/** @param {import('../figures/figure.js').Figure} figure */
function axisTitle({title, shown_unit: unit}) { return `${title} [${unit}]`; }

/**
 * @param {Colors} colors
 * @param {Row|null} bend
 */
function kneeMark(colors, bend) {
  if (!bend) return [];
  return [{
    x: Math.log10(CHATTERING.factor * Number(bend.chattering)),
    y: Math.log10(ERROR.factor * Number(bend.mae)),
    text: `knee, ε = ${short(bend.value)}`, showarrow: true, arrowhead: 0, arrowcolor: colors.muted,
    ax: 34, ay: -34, xanchor: 'left', font: {color: colors.text},
  }];
}
