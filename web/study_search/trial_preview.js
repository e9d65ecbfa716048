// @ts-check
/** What a trial's response looks like beside the gains before: |e| over the horizon. */

import {JOINTS, unitOfAll} from '../api/arm.js';
import {choice} from '../lenses/card.js';
import {LensFigure, axis} from '../lenses/figure.js';
import {decodedResponse} from '../api/preview_message.js';
import {element} from '../dom/element.js';
import {heightHere} from '../screen/low_screen.js';
import {plain} from '../plots/figure.js';
import {laneOf} from '../trials/trials.js';
import {RUNS_ARE_THE_OWNERS, isWatching} from '../api/watch_only.js';

/** @typedef {import('../api/preview_message.js').LaneResponse} LaneResponse */
/** @typedef {import('../trials/trials.js').Study} Study */
/** @typedef {import('../trials/trials.js').Trial} Trial */

const HEIGHT = heightHere(190, 110);
/** A pointer that moves on sooner asks for nothing; in [ms], ours. */
const REST_MS = 80;
const KEPT = 60;
/** Of another purpose than the view of the response, whose runs it must not end. */
const PURPOSE = 'study';
/** Smaller errors than this share of the greatest are not worth the height; ours. */
const DEEPEST = 1e-5;

/** Asks for the runs of two trials and draws them; the newest trial wins. */
export class TrialPreview {
  element;
  #api;
  #figure = new LensFigure({height: HEIGHT});
  #words = element('p', {class: 'search-note', role: 'status'});
  /** @type {number} 0 for the worst of all joints */ #joint = 0;
  /** @type {Study|null} */ #study = null;
  /** @type {Trial|null} */ #trial = null;
  /** @type {Map<number, LaneResponse>} by the trial's number */ #known = new Map();
  /** @type {AbortController|null} */ #running = null;
  /** @type {ReturnType<typeof setTimeout>|undefined} */ #timer;
  #failure = '';

  /** @param {import('../api/api.js').Api} api */
  constructor(api) {
    this.#api = api;
    const joints = choice('Joint of the error', [
      {id: '0', title: 'worst'}, ...JOINTS.map((joint) => ({id: String(joint), title: String(joint)})),
    ], (id) => { this.#joint = Number(id); this.#draw(); });
    this.element = element('section', {class: 'search-preview', 'aria-label': 'Response of the trial'},
      element('div', {class: 'search-row'}, element('span', {class: 'search-label'}, 'Error of joint'),
        joints, this.#words), this.#figure.element);
  }

  /** @param {Study} study another one than before */
  begin(study) {
    this.#study = study;
    this.#trial = null;
    this.#known.clear();
    this.#running?.abort();
  }

  /**
   * @param {Trial|null} trial to show
   * @param {Trial|null} present the trial of the present gains
   */
  show(trial, present) {
    if (!trial || !present || trial.number === this.#trial?.number) return;
    this.#trial = trial;
    this.#failure = '';
    this.#draw();
    clearTimeout(this.#timer);
    this.#running?.abort();
    this.#timer = setTimeout(() => this.#ask([present, trial]), REST_MS);
  }

  /** @param {Trial[]} trials */
  async #ask(trials) {
    if (isWatching()) return;
    const controller = new AbortController();
    this.#running = controller;
    try {
      for (const trial of trials) {
        if (this.#known.has(trial.number)) continue;
        const found = await this.#run(trial, controller.signal);
        if (controller.signal.aborted) return;
        if (found) this.#keep(trial.number, found);
        this.#draw();
      }
    } catch (error) {
      if (controller.signal.aborted) return;
      this.#failure = /** @type {Error} */ (error).message;
      this.#draw();
    }
  }

  /**
   * @param {Trial} trial
   * @param {AbortSignal} signal
   */
  async #run(trial, signal) {
    const {experiment, lane} = /** @type {Study} */ (this.#study);
    const alone = {...experiment, lanes: {[lane]: laneOf(/** @type {Study} */ (this.#study), trial)}};
    const body = {experiment: alone, estimate: false};
    const buffer = await this.#api.runs.preview(body, signal, PURPOSE);
    return buffer && decodedResponse(buffer).lanes.get(lane);
  }

  /**
   * @param {number} number
   * @param {LaneResponse} response
   */
  #keep(number, response) {
    this.#known.set(number, response);
    const oldest = [...this.#known.keys()].find((one) => one !== 0 && one !== number);
    if (this.#known.size > KEPT && oldest !== undefined) this.#known.delete(oldest);
  }

  #draw() {
    const study = this.#study;
    const trial = this.#trial;
    if (!study || !trial) return;
    const now = this.#known.get(trial.number);
    this.#say(isWatching() ? RUNS_ARE_THE_OWNERS : this.#failure || this.#told(trial, now));
    const curves = [
      {uid: 'present', name: 'gains before', response: this.#known.get(0), dash: 'dot', width: 1.4},
      ...(trial.number ? [{
        uid: 'trial', name: `trial ${trial.number}`, response: now, dash: 'solid', width: 1.6,
      }] : []),
    ].filter(({response}) => response);
    if (!curves.length) return;
    const joint = this.#joint ? `joint ${this.#joint}` : 'the worst joint';
    const label = `|e| of ${joint} over the horizon: ${curves.map(({name}) => name).join(' and ')}`;
    this.#figure.draw(label, (colors) => {
      const color = this.#api.lanes.find(({name}) => name === study.lane)?.color ?? colors.accent;
      return figureOf(study, colors, curves.map(({response, ...look}) => ({
        ...look, color: look.dash === 'dot' ? colors.text : color,
        x: /** @type {LaneResponse} */ (response).time,
        y: errorOf(/** @type {LaneResponse} */ (response), this.#joint),
      })), this.#joint);
    });
  }

  /**
   * @param {Trial} trial
   * @param {LaneResponse|undefined} response
   */
  #told({number}, response) {
    if (!response) return `Running trial ${number} …`;
    const draws = this.#study?.wanted.draws ? ' without draws' : '';
    if (response.frozen) return `Trial ${number}${draws} leaves its bounds.`;
    return `Trial ${number}${draws}, over the horizon`;
  }

  /** @param {string} text */
  #say(text) { if (this.#words.textContent !== text) this.#words.textContent = text; }
}

/**
 * @param {LaneResponse} response
 * @param {number} joint 0 for the worst at each time
 * @returns {Float64Array} |e| in [rad]
 */
function errorOf({time, columns}, joint) {
  const shown = (joint ? [joint] : JOINTS).map((one) => (
    /** @type {Float32Array} */ (columns.get(`e${one}`))
  ));
  return Float64Array.from(time, (_, at) => (
    Math.max(...shown.map((column) => Math.abs(column[at])))
  ));
}

/**
 * @param {Study} study
 * @param {import('../lenses/figure.js').Colors} colors
 * @param {{uid: string, name: string, color: string, dash: string, width: number, x: Float32Array,
 *   y: Float64Array}[]} curves
 * @param {number} joint
 * @returns {import('../lenses/figure.js').Figure}
 */
function figureOf(study, colors, curves, joint) {
  const bounds = boundsOf(study, joint);
  const known = curves.flatMap(({y}) => [...y].filter((value) => value > 0));
  const top = Math.max(...known, ...bounds.map(({y}) => y), 1e-9);
  const least = Math.max(Math.min(...known, top), top * DEEPEST);
  const range = [Math.log10(least) - 0.1, Math.log10(top) + 0.15];
  return {
    data: curves.map(({uid, name, color, dash, width, x, y}) => ({
      type: 'scatter', mode: 'lines', uid, name: plain(name), x, y, connectgaps: false,
      line: {color, width, dash}, hovertemplate: `%{y:.3~g} ${unitOfAll('rad')} at %{x:.3f} s`,
    })),
    layout: {
      uirevision: `${study.id}`,
      xaxis: axis(colors, {title: 't [s]', range: [0, study.experiment.simulation.horizon]}),
      yaxis: axis(colors, {
        title: `|e| [${unitOfAll('rad')}]`, type: 'log', range,
        // Labels between the decades have no room.
        dtick: range[1] - range[0] > 1.2 ? 1 : 'D2',
      }),
      shapes: bounds.map(({from, to, y, hard}) => ({
        type: 'line', x0: from, x1: to, y0: y, y1: y,
        line: {color: colors.bad, width: 1.4, dash: hard ? 'solid' : 'dash'},
      })),
      showlegend: true,
      legend: {orientation: 'h', x: 1, xanchor: 'right', y: 1, yanchor: 'bottom', bgcolor: 'transparent'},
      margin: {l: 66, r: 12, t: 24, b: 34},
    },
  };
}

/**
 * @param {Study} study
 * @param {number} joint
 */
function boundsOf({experiment}, joint) {
  const {horizon} = experiment.simulation;
  return Object.values(experiment.goals).filter((goal) => (
    goal.channel === 'e' && (!goal.joint || !joint || goal.joint === joint)
  )).map(({start = 0, end = horizon, bound, priority}) => ({
    from: start, to: Math.min(end, horizon), hard: priority === 'hard', y: bound,
  })).filter(({from, to}) => from < to);
}
