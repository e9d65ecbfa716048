// @ts-check
/**
 * The network lens: what the Gaussians see, what the weights keep, what f has learnt; or F beside
 * what a disturbance observer, or the integral of super-twisting, makes of it.
 */

import {unitAt} from '../api/arm.js';
import {plain} from '../plots/figure.js';
import {LensCard, choice, percent} from './card.js';
import {LensFigure, axis, faint} from './figure.js';
import {withUnit} from '../fields/quantity.js';
import {threeDigits} from '../figures/columns.js';
import {isSampledEvery} from '../curves/panel_curves.js';

/** @typedef {import('./card.js').Look} Look */
/** @typedef {import('./figure.js').Colors} Colors */

const CURVE_POINTS = 160;
/** As few effective nodes as this are one. */
const ONE_NODE = 1.05;
const INPUTS = /** @type {{[name: string]: [string, string]}} */ ({
  error: ['the error', 'e'], angle: ['the angle', 'q'], desired: ['the desired angle', 'q_d'],
});

/** Shows the network of one joint. */
export class NetworkLens {
  id = 'network';
  title = 'Network';
  element;
  #gaussians = new LensFigure({height: 230});
  #weights = new LensFigure({height: 190});
  #torque = new LensFigure({height: 230});
  #loss = new LensFigure({height: 230});
  #fit = 'visited';
  /** @type {Look|null} */ #look = null;
  #gaussianCard;
  #weightCard;
  #torqueCard;
  #observerCard;
  #networkCards;

  constructor() {
    const fit = choice('Range of the axis', [
      {id: 'visited', title: 'inputs of this run'}, {id: 'centers', title: 'all centres'},
    ], (id) => { this.#fit = id; this.#drawGaussians(); });
    this.#gaussianCard = new LensCard({
      title: 'What the Gaussians see', equation: 'Eq. 19', words: '',
    }, fit, this.#gaussians.element);
    this.#weightCard = new LensCard({
      title: 'What the weights store', equation: 'Eq. 21',
      words: 'A weight grows as long as S isn’t zero and its Gaussian is active: dW/dt = φ h S. Left, '
        + 'the ten weights at the end; right, the norm of the weights, √ΣW², over the run. While that '
        + 'still climbs, it still learns.',
    }, this.#weights.element);
    this.#torqueCard = new LensCard({
      title: 'What f has learnt', equation: 'Eq. 9, 20, 22',
      words: 'Dashed: the torque τ_eq + F that exact knowledge of arm and disturbance would '
        + 'give. The reaching law k₁S + k₂sw(S) supplies what f does not, and that takes an error.',
    }, this.#torque.element);
    this.#observerCard = new LensCard({
      title: 'What the model lacks', equation: '', words: '',
    }, this.#loss.element);
    this.#networkCards = [this.#gaussianCard, this.#weightCard, this.#torqueCard];
    this.element = [...this.#networkCards, this.#observerCard].map(({element}) => element);
  }

  /**
   * @param {Look} look
   * @returns {string|undefined} why there is nothing to see
   */
  show(look) {
    const {seen: {network}, joint, lane} = look;
    if (!network) {
      return `${lane} has no network: it computes τ_eq from a model of the arm. Choose an RBFNN lane `
        + 'to see what its network has learnt, or a disturbance observer for this one.';
    }
    const observed = 'observer' in network;
    for (const {element: card} of this.#networkCards) card.hidden = observed;
    this.#observerCard.element.hidden = !observed;
    const one = network.joints[joint - 1];
    if (observed) {
      this.#look = null;
      this.#showObserver(look, one);
      return undefined;
    }
    this.#look = look;
    const [name, symbol] = INPUTS[network.input] ?? ['the input', 'x'];
    this.#gaussianCard.words = `Each curve is one Gaussian’s activation h over ${name} ${symbol} of joint `
      + `${joint}; the bars are this run’s inputs. Only where the curves bend within the bars can `
      + 'the network distinguish one input from another.';
    this.#gaussianCard.facts = gaussianFacts(one, network.centers, unitAt('rad', joint));
    this.#gaussianCard.finding = gaussianFinding(one, network.input, unitAt('rad', joint));
    this.#drawGaussians();
    const drawn = `Joint ${joint}: the ten weights at the end, the norm of the weights over time`;
    this.#weights.draw(drawn, (colors) => weightFigure(colors, look, network, one));
    const torque = unitAt('N·m', joint);
    this.#torqueCard.facts = [
      {name: 'needed', value: `${threeDigits(one.needed_rms)} ${torque}`,
        title: 'Root mean square of τ_eq + F over the second half of the run'},
      {name: 'left to the reaching law', value: `${threeDigits(one.missing_rms)} ${torque}`},
      {name: 'learnt', value: one.learnt === null ? '–' : percent(one.learnt)},
    ];
    this.#torqueCard.finding = torqueFinding(one, torque);
    this.#torque.draw(`Joint ${joint}: network output f beside the needed torque`, (colors) => (
      torqueFigure(colors, look, network, one)
    ));
    return undefined;
  }

  /**
   * @param {Look} look
   * @param {any} one
   */
  #showObserver(look, one) {
    const {seen: {network}, joint} = look;
    this.#observerCard.words = observerWords(network);
    const torque = unitAt('N·m', joint);
    this.#observerCard.facts = [
      {name: 'lost', value: `${threeDigits(one.lost_rms)} ${torque}`,
        title: 'Root mean square over the second half of the run'},
      {name: 'left to the reaching law', value: `${threeDigits(one.missing_rms)} ${torque}`},
      {name: 'covered', value: one.known === null ? '–' : percent(one.known)},
    ];
    this.#observerCard.finding = observerFinding(one, network, torque);
    this.#loss.draw(`Joint ${joint}: the estimate beside what the model lacks`, (colors) => (
      torqueFigure(colors, look, network, {needed: one.lost, f: one.f}, ['lacking', 'estimate'])
    ));
  }

  #drawGaussians() {
    const look = this.#look;
    if (!look) return;
    const {network} = look.seen;
    const one = network.joints[look.joint - 1];
    const fit = this.#fit;
    this.#gaussians.draw(`Joint ${look.joint}: ten Gaussians over the inputs visited`, (colors) => (
      gaussianFigure(colors, look, network, one, fit)
    ));
  }
}

/**
 * @param {any} one
 * @param {number[]} centers
 * @param {string} unit of the inputs
 */
function gaussianFacts({width, coverage, spread, effective_nodes: nodes, low, high}, centers, unit) {
  return [
    {name: 'centres', value: `${centers.length}, ${threeDigits(Math.min(...centers))} to `
      + `${threeDigits(Math.max(...centers))} ${unit}`},
    {name: 'width', value: `b = ${withUnit(width, unit)}`},
    {name: 'inputs', value: `${threeDigits(low)} to ${threeDigits(high)} ${unit}`},
    {name: 'coverage', value: percent(coverage),
      title: 'Share of the run in which at least one Gaussian is above 0.1'},
    {name: 'spread', value: threeDigits(spread),
      title: 'Largest change of any Gaussian’s activation over these inputs, 0 to 1'},
    {name: 'independent', value: `${nodes.toFixed(2)} of 10`,
      title: 'How many Gaussians act independently of each other over these inputs'},
  ];
}

/**
 * @param {any} one
 * @param {string} input
 * @param {string} unit of the inputs
 */
function gaussianFinding({coverage, effective_nodes: nodes, low, high}, input, unit) {
  if (coverage < 0.9) {
    return `For ${percent(1 - coverage)} of the run no Gaussian is active: there the network does not respond. `
      + 'Wider ones, or centres that span the inputs, would help.';
  }
  if (nodes < ONE_NODE) {
    const other = input === 'error' ? ', or the network look at q_d, which ranges wider' : '';
    return 'All ten respond alike, whatever the input: together they act as one weight, an integrator '
      + `of S. To distinguish inputs, b and the spacing of the centres would have to be smaller than the range `
      + `of the inputs, ${threeDigits(high - low)} ${unit}${other}.`;
  }
  return `Over these inputs the ten act as ${nodes.toFixed(1)} independent ones: the network can `
    + 'store a different torque for each.';
}

/**
 * @param {any} one
 * @param {string} unit of its torque
 */
function torqueFinding({learnt, needed_rms: needed, missing_rms: missing}, unit) {
  if (learnt === null) return 'This joint needs no torque: there is nothing to learn.';
  const [all, rest] = [threeDigits(needed), threeDigits(missing)];
  if (learnt < 0.1) {
    return `f supplies hardly any of the ${all} ${unit}: the reaching law does the work, with an `
      + 'error that stays. A higher φ learns faster.';
  }
  return `In the second half of the run f supplies ${percent(learnt)} of the ${all} ${unit} that are `
    + `needed; ${rest} ${unit} are left to the reaching law.`;
}

/** @param {any} network */
function observerWords({observer, adds}) {
  const lost = 'Dashed: the torque that the model lacks: disturbance and friction F, and where the model '
    + 'is not the arm, the difference. ';
  if (observer === 'twisting') {
    return `${lost}The integral z of super-twisting comes to balance it: the curve is M·z. What it `
      + 'misses is left to k₁|S|^½.';
  }
  return `${lost}The observer infers it from how the arm moved under the torque, by the model, and adds `
    + `it${adds ? '; the curve is its estimate and M·z, the integral of super-twisting, together' : ''}. `
    + 'What is missed is left to the reaching law.';
}

/**
 * @param {any} one
 * @param {any} network
 * @param {string} unit of its torque
 */
function observerFinding({known, lost_rms: lost, missing_rms: missing}, {observer}, unit) {
  const [all, rest] = [threeDigits(lost), threeDigits(missing)];
  if (known === null) {
    return `The model lacks nothing on this joint. What is estimated, ${rest} ${unit}, is noise.`;
  }
  if (known < 0.1) {
    return `The estimate misses ${rest} ${unit} of the ${all} ${unit} that the model lacks: `
      + `${observer === 'twisting' ? 'k₂ is' : 'K_o is'} too low for how fast that changes, or noise drowns it.`;
  }
  return `In the second half of the run the estimate covers ${percent(known)} of the ${all} ${unit} `
    + `that the model lacks; ${rest} ${unit} are left to the reaching law.`;
}

/**
 * @param {Colors} colors
 * @param {Look} look
 * @param {any} network
 * @param {any} one
 * @param {string} fit
 */
function gaussianFigure(colors, {color, joint, lane}, {input, centers}, one, fit) {
  const span = Math.max(one.high - one.low, 1e-6);
  const visited = [one.low - 0.1 * span, one.high + 0.1 * span];
  const [first, last] = [centers[0], centers[centers.length - 1]];
  const margin = 0.15 * (last - first);
  const range = fit === 'visited' ? visited
    : [Math.min(first - margin, visited[0]), Math.max(last + margin, visited[1])];
  const x = Array.from({length: CURVE_POINTS}, (_, index) => (
    range[0] + ((range[1] - range[0]) * index) / (CURVE_POINTS - 1)
  ));
  const bins = one.visits.length;
  const most = Math.max(...one.visits);
  const curves = centers.map((/** @type {number} */ center, /** @type {number} */ index) => ({
    type: 'scatter', mode: 'lines', uid: `h${index}`, x,
    y: x.map((value) => Math.exp(-0.5 * ((value - center) / one.width) ** 2)),
    hovertemplate: `c = ${threeDigits(center)} ${unitAt('rad', joint)}<br>h = %{y:.4f}<extra></extra>`,
    line: {color: colors.muted, width: 1.2},
  }));
  const [, symbol] = INPUTS[input] ?? ['', 'x'];
  return {
    data: [{
      type: 'bar', uid: 'visits', width: span / bins,
      x: one.visits.map((/** @type {number} */ _, /** @type {number} */ index) => (
        one.low + (span * (index + 0.5)) / bins
      )),
      y: one.visits.map((/** @type {number} */ share) => (0.6 * share) / most),
      customdata: one.visits.map((/** @type {number} */ share) => 100 * share),
      hovertemplate: '%{customdata:.2~g} % of the run<extra></extra>',
      marker: {color: faint(color, 0.35), line: {width: 0}},
    }, ...curves, {
      type: 'scatter', mode: 'markers', uid: 'centers', x: centers,
      y: centers.map(() => 0), hovertemplate: `centre %{x:.4~g} ${unitAt('rad', joint)}<extra></extra>`,
      marker: {symbol: 'line-ns-open', size: 9, color: colors.text, line: {width: 1.5}},
    }],
    layout: {
      uirevision: `${lane}-${joint}-${fit}`,
      bargap: 0,
      xaxis: axis(colors, {title: `${symbol.replace('_d', '<sub>d</sub>')} [${unitAt('rad', joint)}]`, range}),
      yaxis: axis(colors, {title: 'h', range: [-0.04, 1.08], nticks: 6}),
    },
  };
}

/**
 * @param {Colors} colors
 * @param {Look} look
 * @param {any} network
 * @param {any} one
 */
function weightFigure(colors, {color, joint, lane}, {centers, norm_time: time}, one) {
  const torque = unitAt('N·m', joint);
  return {
    data: [{
      type: 'bar', uid: 'weights', x: centers.map((/** @type {number} */ _, /** @type {number} */ index) => index + 1),
      y: one.weights, customdata: centers, marker: {color},
      hovertemplate: `c = %{customdata:.4~g} ${unitAt('rad', joint)}<br>W = %{y:.4~g} ${torque}<extra></extra>`,
    }, {
      type: 'scatter', mode: 'lines', uid: 'norm', x: time, y: one.norm, xaxis: 'x2', yaxis: 'y2',
      hovertemplate: `t = %{x:.3f} s<br>norm of the weights %{y:.4~g} ${torque}<extra></extra>`,
      line: {color, width: 1.6},
    }],
    layout: {
      uirevision: `${lane}-${joint}`,
      bargap: 0.25,
      xaxis: axis(colors, {title: 'node', domain: [0, 0.4], dtick: 1, tickangle: 0, showgrid: false}),
      yaxis: axis(colors, {title: `W [${torque}]`, nticks: 5}),
      xaxis2: axis(colors, {title: 't [s]', domain: [0.56, 1], anchor: 'y2', zeroline: false}),
      yaxis2: axis(colors, {title: `norm of the weights [${torque}]`, anchor: 'x2', nticks: 5, rangemode: 'tozero'}),
    },
  };
}

/**
 * @param {Colors} colors
 * @param {Look} look
 * @param {any} network
 * @param {any} one
 * @param {[string, string]} [names] of what f is held against, and of f
 */
function torqueFigure(colors, {color, joint, lane, hold}, {torque_time: x}, one, names = ['needed', 'f']) {
  const torque = unitAt('N·m', joint);
  // Of a long run only some samples are here.
  const steps = isSampledEvery(hold, (x[x.length - 1] - x[0]) / (x.length - 1));
  const line = (/** @type {string} */ uid, /** @type {string} */ name, /** @type {number[]} */ y,
    /** @type {object} */ style) => ({
    type: 'scatter', mode: 'lines', uid, name: plain(name), x, y,
    hovertemplate: `%{y:.4~g} ${torque}`, line: {simplify: false, ...style},
  });
  return {
    data: [
      line('needed', names[0], one.needed, {color: colors.desired, width: 1.4, dash: '6px,4px'}),
      line('f', names[1], one.f, {color, width: 1.8, shape: steps ? 'hv' : 'linear'}),
    ],
    layout: {
      uirevision: `${lane}-${joint}`,
      hovermode: 'x unified',
      xaxis: axis(colors, {
        title: 't [s]', zeroline: false, unifiedhovertitle: {text: 't = %{x:.3f} s'},
      }),
      yaxis: axis(colors, {title: `torque [${torque}]`, nticks: 7}),
    },
  };
}
