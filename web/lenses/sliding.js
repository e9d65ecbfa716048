// @ts-check
/** The sliding-mode lens: a joint's error in its plane with the sliding curve, and V over time. */

import {unitAt} from '../api/arm.js';
import {plain} from '../plots/figure.js';
import {LensCard, choice, percent} from './card.js';
import {LensFigure, axis, faint} from './figure.js';
import {energyFigure} from './energy.js';
import {RESTLESS, energyFinding, inEffect, planeFinding} from './verdicts.js';
import {withUnit} from '../fields/quantity.js';
import {figureText, threeDigits} from '../figures/columns.js';
import {figureOf} from '../figures/figure.js';

/** @typedef {import('./card.js').Look} Look */
/** @typedef {import('./figure.js').Colors} Colors */
/** @typedef {{time: number, e: number[], de: number[]}|null} Trail */

const PLANE_HEIGHT = 300;
const ENERGY_HEIGHT = 250;
/** Distance of two points, in widths of the picture, across which no line belongs. */
const APART = 0.05;
const REACHING = figureOf('reaching_time');

/** Shows the plane of one joint, and V of all. */
export class SlidingLens {
  id = 'sliding';
  title = 'Sliding mode';
  element;
  #plane = new LensFigure({height: PLANE_HEIGHT});
  #energy = new LensFigure({height: ENERGY_HEIGHT});
  #fit = 'response';
  /** @type {Look|null} */ #look = null;
  /** @type {(joint: number) => Trail} */ #trail;
  #planeCard;
  #energyCard;

  /** @param {{trail: (joint: number) => Trail}} desk */
  constructor({trail}) {
    this.#trail = trail;
    const fit = choice('Range of the axes', [
      {id: 'response', title: 'fit the response'}, {id: 'layer', title: 'fit the layer'},
    ], (id) => { this.#fit = id; this.#drawPlane(); });
    this.#planeCard = new LensCard({
      title: 'Where the error goes', equation: 'Eq. 5', words: '',
    }, fit, this.#plane.element);
    this.#energyCard = new LensCard({
      title: 'Does V fall?', equation: 'Eq. 23, first term',
      words: 'V = ½ SᵀMS measures how far all joints together are from S = 0. Where '
        + 'dV/dt > 0, the motion and the disturbance outrun the controller.',
    }, this.#energy.element);
    this.element = [this.#planeCard.element, this.#energyCard.element];
  }

  /** @param {Look} look */
  show(look) {
    this.#look = look;
    const {seen, joint, horizon, color, hold} = look;
    const gains = inEffect(look.gains, hold);
    const one = seen.sliding.joints[joint - 1];
    this.#planeCard.words = `Each point is one moment of joint ${joint}: how far it is off (e) and `
      + 'how fast that changes (de). The controller pulls it onto the line S = 0, along which the '
      + 'error slides to zero.';
    const sign = gains.switching === 'sign';
    this.#planeCard.facts = planeFacts(one, sign, unitAt('rad/s', joint));
    this.#planeCard.finding = planeFinding(one, horizon, gains);
    this.#drawPlane();
    this.#energyCard.facts = energyFacts(seen.sliding);
    this.#energyCard.finding = energyFinding(seen.sliding, horizon, gains);
    this.#energy.draw('V and its derivative over time', (colors) => (
      energyFigure(colors, seen.sliding, color, seen.sliding.turns < RESTLESS)
    ));
  }

  /** Only what moves while the session plays. */
  move() { if (this.#look) this.#drawPlane(); }

  #drawPlane() {
    const look = this.#look;
    if (!look) return;
    const one = look.seen.sliding.joints[look.joint - 1];
    const trail = this.#trail(look.joint);
    const fit = this.#fit;
    this.#plane.draw(
      `Joint ${look.joint}: velocity error over error, with the line S = 0`,
      (colors) => planeFigure(colors, look, one, trail, fit),
    );
  }
}

/** @param {any} sliding */
function energyFacts({growing, outside, turns, quiet_turns: quiet, joints}) {
  const layered = joints.some((/** @type {{layer: number}} */ {layer}) => layer);
  const beside = quiet === null ? '' : `, ${threeDigits(quiet)} without sensor noise`;
  return [
    {name: 'V grows', value: `${percent(growing)} of the time`},
    ...(layered ? [{
      name: 'some S outside its layer', value: outside ? `${percent(outside)} of the time` : 'never',
    }] : []),
    {name: 'turns', value: `${threeDigits(turns)} /s${beside}`,
      title: 'How often V turns between growing and falling, per second'},
  ];
}

/**
 * @param {any} one
 * @param {boolean} sign whether it switches by sign(S)
 * @param {string} unit of S
 */
function planeFacts(one, sign, unit) {
  const {layer, reaching_time: reached, last_outside: left, inside} = one;
  const constant = {
    name: 'on the line',
    value: one.time_constant === null ? 'e stays: S does not depend on it'
      : `time constant ${threeDigits(one.time_constant)} s`,
    title: '(∂S/∂de) / (∂S/∂e) for a small error: c/ν, or 1/λ',
  };
  if (!layer) return [constant];
  return [
    {name: sign ? 'practically zero' : 'layer', value: `|S| ≤ ${withUnit(layer, unit)}`},
    {name: 'reached', value: reached === null ? 'never' : `at ${figureText(REACHING, reached)}`,
      title: sign ? 'When S first was practically zero or passed it'
        : 'When |S| first was within the boundary layer, or S passed zero'},
    {name: 'last outside', value: left === null ? 'never' : `at ${threeDigits(left)} s`},
    {name: 'inside', value: `${percent(inside)} of the time`},
    constant,
  ];
}

/**
 * @param {any} one
 * @param {Trail} trail
 * @param {string} fit
 * @returns {{x: [number, number], y: [number, number]}}
 */
function ranges(one, trail, fit) {
  const most = (/** @type {number[][]} */ ...lists) => (
    1.15 * Math.max(1e-6, ...lists.flat().map(Math.abs))
  );
  let [x, y] = [most(one.e, trail?.e ?? []), most(one.de, trail?.de ?? [])];
  if (fit === 'layer' && one.layer) {
    x = Math.max(x, 1.3 * one.layer_width);
    y = Math.max(y, (1.3 * one.layer_width) / one.time_constant);
  }
  return {x: [-x, x], y: [-y, y]};
}

/**
 * @param {Colors} colors
 * @param {Look} look
 * @param {any} one
 * @param {Trail} trail
 * @param {string} fit
 */
function planeFigure(colors, {color, joint, lane, horizon}, one, trail, fit) {
  const {x, y} = ranges(one, trail, fit);
  const beside = (/** @type {number} */ by) => one.curve_e.map((/** @type {number} */ e) => e + by);
  const width = one.layer_width;
  const line = (/** @type {object} */ style) => ({
    type: 'scatter', mode: 'lines', hoverinfo: 'skip', ...style,
  });
  const layer = !one.layer ? [] : [
    line({
      uid: 'layer', x: [...beside(width), ...beside(-width).reverse()],
      y: [...one.curve_de, ...[...one.curve_de].reverse()],
      fill: 'toself', fillcolor: faint(color, 0.1), line: {width: 0},
    }),
    ...[width, -width].map((by, index) => line({
      uid: `edge${index}`, x: beside(by), y: one.curve_de,
      line: {color: colors.muted, width: 1, dash: 'dot'},
    })),
  ];
  const angle = unitAt('rad', joint);
  const point = `%{customdata:.3f} s<br>e %{x:.4~g} ${angle}<br>de %{y:.4~g} ${angle}/s`;
  const data = [
    ...layer,
    line({
      uid: 'curve', x: one.curve_e, y: one.curve_de, line: {color: colors.text, width: 1.6},
    }),
    line({
      uid: 'path', x: one.e, y: one.de, customdata: one.time, hoverinfo: undefined,
      hovertemplate: point, name: plain(lane), mode: isCloud(one) ? 'markers' : 'lines',
      marker: {color, size: 3}, line: {color, width: 1.3, simplify: false},
    }),
    {
      type: 'scatter', mode: 'markers', uid: 'start', x: one.e.slice(0, 1), y: one.de.slice(0, 1),
      hovertemplate: 'begins here', name: '', cliponaxis: false,
      marker: {symbol: 'circle-open', size: 9, color, line: {width: 2}},
    },
    ...live(colors, trail, color),
  ];
  return {data, layout: {
    uirevision: `${lane}-${joint}-${fit}-${horizon}`,
    xaxis: axis(colors, {title: `e [${angle}]`, range: x}),
    yaxis: axis(colors, {title: `de [${angle}/s]`, range: y}),
    annotations: notes(colors, one, x, y),
  }};
}

/**
 * Whether the moments jump about so that lines between the chosen ones would be invented.
 *
 * @param {{e: number[], de: number[]}} one
 */
function isCloud({e, de}) {
  const size = (/** @type {number[]} */ list) => Math.max(...list) - Math.min(...list) || 1;
  const [width, height] = [size(e), size(de)];
  const steps = e.slice(1).map((value, index) => (
    Math.hypot((value - e[index]) / width, (de[index + 1] - de[index]) / height)
  )).sort((first, second) => first - second);
  return steps.length > 0 && steps[Math.floor(steps.length / 2)] > APART;
}

/**
 * @param {Colors} colors
 * @param {Trail} trail
 * @param {string} color
 */
function live(colors, trail, color) {
  if (!trail) return [];
  return [{
    type: 'scatter', mode: isCloud(trail) ? 'markers' : 'lines', uid: 'trail', x: trail.e,
    y: trail.de, hoverinfo: 'skip', marker: {color: faint(color, 0.45), size: 6},
    line: {color: faint(color, 0.45), width: 4, simplify: false},
  }, {
    type: 'scatter', mode: 'markers', uid: 'live', x: trail.e.slice(-1), y: trail.de.slice(-1),
    cliponaxis: false, name: '', hovertemplate: `live, ${trail.time.toFixed(2)} s`,
    marker: {size: 11, color, line: {color: colors.background, width: 2}},
  }];
}

/**
 * Says in the picture which line is S = 0, at its highest point in sight.
 *
 * @param {Colors} colors
 * @param {any} one
 * @param {[number, number]} x
 * @param {[number, number]} y
 */
function notes(colors, one, x, y) {
  const seen = one.curve_e.findIndex((/** @type {number} */ e, /** @type {number} */ index) => (
    e !== null && e < 0.8 * x[1] && one.curve_de[index] > 0.85 * y[0]
  ));
  if (seen < 0) return [];
  return [{
    x: one.curve_e[seen], y: one.curve_de[seen], text: 'S = 0', showarrow: false, yshift: 10,
    xanchor: 'left', font: {color: colors.text},
  }];
}
