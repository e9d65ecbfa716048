// @ts-check
/**
 * The server: the only module that knows its addresses and messages.
 *
 * Views read the state fields and listen to the events:
 * `hello`, `patch`, `state`, `metrics`, `notice`, `error`: the server's message as `detail`
 * (an `error` also carries the refused `patch`); `frame`: a {@link Frame};
 * `connection`: whether connected, and if not why and for how long; `select`: the lane's name;
 * `saved`: the preset's name, its experiment being the baseline now; `moving`: whether a control
 * is on its way; by key `joint`: 1 to 6, toggled, and `cursor`: `A` or `B`, to be set.
 */

import {joined} from './merge_patch.js';
import {ApiError, request, requestLines} from './http.js';
import {Connection} from './connection.js';
import {decoded} from './telemetry_frame.js';

export {ApiError};

/** @typedef {import('./merge_patch.js').Document} Document */
/** @typedef {{name: string, color: string}} Lane */
/** @typedef {{name: string, group: string, joint: number|string, lane: string, unit: string}} Channel */
/**
 * @typedef {{name: string, title: string, summary: string, model_based: boolean,
 *   network: boolean}} Law
 */
/**
 * @typedef {{status: 'running'|'frozen', time: number|null, joint: number|null,
 *   cause: string|null, gamma: number}} LaneState
 */
/**
 * @typedef {{time: number, playing: boolean, speed: number, real_time_factor: number,
 *   capped: boolean, revision: number, epoch: number, horizon: number,
 *   lanes: {[name: string]: LaneState}}} State
 */
/** @typedef {import('./telemetry_frame.js').Frame} Frame */
/** @typedef {{name: string, title: string, description: string, shipped: boolean}} Preset */
/** @typedef {ReturnType<typeof setTimeout>} Timer */

const NOT_CONNECTED = 'not connected: the change was not made';
const SETTLE_MS = 3000;
/** An answer may be lost: the server drops what a page that lags too far has missed. */
const ANSWER_MS = 10_000;
/** With more on the way a slow server would fall behind the hand; two hide the way there and back. */
const MOST_ON_THE_WAY = 2;
/** For so long after a change here, what the server says of the view may be older. */
const VIEW_MS = 1000;

/** The live session, its experiment and its telemetry. */
export class Api extends EventTarget {
  /** @type {Document} */ experiment = {};
  /** @type {Document} the experiment as it was loaded */ baseline = {};
  /** Name of the loaded preset, or ''. */
  preset = '';
  /** @type {Lane[]} */ lanes = [];
  /** @type {Channel[]} */ channels = [];
  /** @type {Law[]} */ laws = [];
  /** @type {State|null} */ session = null;
  /** @type {Document|null} the last `metrics` message */ metrics = null;
  /** This page's id; patches that it sent come back with it as `author`. */
  client = '';
  /** Newest revision that the server told of. */
  revision = 0;
  version = '';
  connected = false;
  /** Whether a control is on its way: more values follow until `settled`. */
  moving = false;
  /** Name of the lane whose gains are on the screen. */
  selected = '';
  /** How the 3D scene is drawn. */
  drawn = {exaggeration: 1, ghosts: true};

  /** @type {Document|null} */ #pending = null;
  #id = 0;
  /** @type {Map<number, {done: (error?: ApiError) => void, timer: Timer}>} */
  #sent = new Map();
  /** @type {(() => void)[]} */ #settling = [];
  #viewed = 0;
  #connection = new Connection('/api/live', {
    message: (/** @type {Document} */ message) => this.#receive(message),
    bytes: (/** @type {ArrayBuffer} */ bytes) => this.#emit('frame', decoded(bytes)),
    change: (/** @type {Document} */ detail) => this.#connectionChanged(detail),
  });

  /** Open the live connection; it re-opens by itself when it is lost. */
  connect() { this.#connection.open(); }

  /** Try again now instead of at the end of the waiting time. */
  reconnect() { this.#connection.retry(); }

  // Editing

  /**
   * Change the live experiment. Several patches within one animation frame, or while the server
   * is busy with earlier ones, become one. A refusal arrives as `error` event.
   *
   * @param {Document} patch JSON merge patch
   */
  patch(patch) {
    const waiting = this.#pending !== null;
    this.#move(true);
    this.#pending = joined(this.#pending ?? {}, patch);
    if (waiting) return;
    // A hidden page gets no animation frames.
    const later = document.hidden ? setTimeout : requestAnimationFrame;
    later(() => this.#flushIfIdle());
  }

  /**
   * Change the live experiment at once.
   *
   * @param {Document} patch JSON merge patch
   * @returns {Promise<void>} kept when the server has accepted it, broken with an ApiError;
   *   no `error` event is raised.
   */
  change(patch) {
    this.#flush();
    return new Promise((resolve, reject) => {
      this.#submit({type: 'patch', patch}, (error) => (error ? reject(error) : resolve()));
    });
  }

  /**
   * Wait until the server has answered every patch, or long enough.
   *
   * @returns {Promise<void>}
   */
  async settled() {
    this.#flush();
    if (this.#sent.size) await Promise.race([
      new Promise((resolve) => { this.#settling.push(() => resolve(undefined)); }),
      new Promise((resolve) => { setTimeout(resolve, SETTLE_MS); }),
    ]);
    this.#move(false);
  }

  /** @param {boolean} moving */
  #move(moving) {
    if (moving === this.moving) return;
    this.moving = moving;
    this.#emit('moving', moving);
  }

  /**
   * Add a lane with the gains and the state of another.
   *
   * @param {string} origin name of the lane to copy
   * @param {string} name
   * @returns {Promise<void>}
   */
  duplicateLane(origin, name) {
    this.#flush();
    return new Promise((resolve, reject) => {
      const lane = {type: 'lane', origin, name};
      this.#submit(lane, (error) => (error ? reject(error) : resolve()));
    });
  }

  // The session

  play() { this.#send({type: 'play'}); }

  pause() { this.#send({type: 'pause'}); }

  /** @param {number} [count] control steps */
  step(count = 1) { this.#send({type: 'step', count}); }

  reset() { this.#send({type: 'reset'}); }

  /** Push the joints for a moment. */
  kick() { this.#send({type: 'kick'}); }

  /** @param {number} speed multiple of real time, 0.1 to 10 */
  speed(speed) { this.#send({type: 'speed', speed}); }

  /** @param {string} lane name of the lane to show and to draw solid */
  select(lane) {
    if (lane === this.selected) return;
    this.selected = lane;
    this.#send({type: 'select', lane});
    this.#emit('select', lane);
  }

  /** @param {{exaggeration?: number, ghosts?: boolean}} change of how the scene is drawn */
  view(change) {
    this.drawn = {...this.drawn, ...change};
    this.#viewed = performance.now();
    this.#send({type: 'view', ...this.drawn});
  }

  // Documents

  /** @returns {Promise<Document>} JSON Schema of an experiment */
  schema() { return request('GET', '/api/schema'); }

  /** @returns {Promise<Preset[]>} */
  async listPresets() { return (await request('GET', '/api/presets')).presets; }

  /** @param {string} name */
  loadPreset(name) { return request('POST', `${presetAddress(name)}/load`); }

  /**
   * Save the live experiment.
   *
   * @param {string} name
   * @param {{overwrite?: boolean}} [options]
   */
  async savePreset(name, {overwrite = false} = {}) {
    await this.settled();
    const saved = await request('PUT', `${presetAddress(name)}?overwrite=${overwrite}`);
    Object.assign(this, {preset: name, baseline: this.experiment});
    this.#emit('saved', name);
    return saved;
  }

  /** @param {string} name */
  deletePreset(name) { return request('DELETE', presetAddress(name)); }

  /** @returns {Promise<string>} the live experiment as YAML */
  async exportYaml() {
    await this.settled();
    return request('GET', '/api/experiment?format=yaml');
  }

  /** @param {string|Document} document YAML text or a whole experiment */
  replaceExperiment(document) { return request('PUT', '/api/experiment', document); }

  // Whole runs beside the live session

  /**
   * Run a lane over its horizon and look at it.
   *
   * @param {string} lane
   * @param {('sliding'|'network'|'chattering')[]} lenses
   * @param {{patch?: Document, signal?: AbortSignal}} [options] `patch`: another experiment than
   *   the live one
   * @returns {Promise<Document>} what each lens saw, under its name
   */
  lens(lane, lenses, {patch = {}, signal} = {}) {
    return request('POST', '/api/lens', {lane, lenses, patch}, signal);
  }

  /**
   * Many short runs, told as they end; see the kinds at the server's `/api/studies`.
   *
   * @param {'strip'|'sensitivity'|'switching'} kind
   * @param {Document} body
   * @param {(row: Document) => void} onRow
   * @param {AbortSignal} [signal]
   * @returns {Promise<void>} kept when all runs have ended
   */
  study(kind, body, onRow, signal) {
    return requestLines(`/api/studies/${kind}`, body, onRow, signal);
  }

  /**
   * Run every lane over its horizon. Of two at once the server gives up the older.
   *
   * @param {{experiment?: Document, quick?: boolean, show?: boolean}} body
   * @param {AbortSignal} [signal]
   * @returns {Promise<ArrayBuffer|null>} see preview_message.js; null when it was given up
   */
  preview(body, signal) {
    return request('POST', '/api/preview', {...body, client: `${this.client} preview`}, signal);
  }

  // What arrives

  /** @param {Document} detail */
  #connectionChanged(detail) {
    // Connected means resynchronised: only `hello` says so.
    if (detail.open) return;
    this.connected = false;
    const lost = new ApiError(0, 'lost', NOT_CONNECTED);
    for (const id of [...this.#sent.keys()]) this.#answered(id, lost);
    this.#emit('connection', {connected: false, ...detail});
  }

  /** @param {Document} message */
  #receive(message) {
    this.revision = message.revision ?? message.state?.revision ?? this.revision;
    switch (message.type) {
      case 'hello': this.#hello(message); break;
      case 'patch':
        this.experiment = message.experiment;
        this.#emit('patch', message);
        if (message.author === this.client && message.id !== null) this.#answered(message.id);
        return;
      case 'state':
        this.session = /** @type {State} */ (message);
        if (performance.now() - this.#viewed > VIEW_MS) this.drawn = {...this.drawn, ...message.view};
        break;
      case 'metrics': this.metrics = message; break;
      case 'error': this.#refused(message); return;
      default:
    }
    this.#emit(message.type, message);
  }

  /** @param {Document} message */
  #hello(message) {
    const {client, version, experiment, baseline, preset, channels, laws, state} = message;
    Object.assign(this, {client, version, experiment, baseline, preset, channels, laws});
    this.selected = successor(this.lanes, message.lanes, this.selected, message.selected);
    this.lanes = message.lanes;
    this.session = state;
    this.drawn = {...this.drawn, ...message.view};
    if (!(message.selected in experiment.lanes)) this.#send({type: 'select', lane: this.selected});
    if (this.connected) return;
    this.connected = true;
    this.#emit('connection', {connected: true});
  }

  /** @param {Document} message */
  #refused(message) {
    const {code, message: text, fields} = message.error;
    const error = new ApiError(422, code, text, fields);
    if (!this.#sent.has(message.id)) this.#emit('error', {id: message.id, error, patch: null});
    else this.#answered(message.id, error);
  }

  /**
   * The server takes patches in order, so that an answer covers all that were sent before it.
   *
   * @param {number} id
   * @param {ApiError} [error]
   */
  #answered(id, error) {
    for (const [older, {done, timer}] of [...this.#sent]) {
      if (older > id) continue;
      clearTimeout(timer);
      this.#sent.delete(older);
      done(older === id ? error : undefined);
    }
    this.#flushIfIdle();
    if (this.#sent.size) return;
    for (const resolve of this.#settling.splice(0)) resolve();
  }

  // What leaves

  #flushIfIdle() { if (this.#sent.size < MOST_ON_THE_WAY) this.#flush(); }

  #flush() {
    const patch = this.#pending;
    if (!patch) return;
    this.#pending = null;
    const id = this.#id + 1;
    this.#submit({type: 'patch', patch}, (error) => {
      if (error) this.#emit('error', {id, error, patch});
    });
  }

  /**
   * @param {Document} message
   * @param {(error?: ApiError) => void} done
   */
  #submit(message, done) {
    this.#id += 1;
    const id = this.#id;
    const give = (/** @type {string} */ text) => this.#answered(id, new ApiError(0, 'lost', text));
    const timer = setTimeout(() => give('the server has not answered'), ANSWER_MS);
    this.#sent.set(id, {done, timer});
    if (!this.#send({...message, id})) give(NOT_CONNECTED);
  }

  /** @param {Document} message */
  #send(message) { return this.#connection.send(message); }

  /**
   * @param {string} type
   * @param {any} detail
   */
  #emit(type, detail) { this.dispatchEvent(new CustomEvent(type, {detail})); }
}

/**
 * The lane to show after a change of lanes: the same, or the one in its place; when they are
 * other lanes altogether the one that the server names, or the first.
 *
 * @param {Lane[]} before
 * @param {Lane[]} now
 * @param {string} selected
 * @param {string} named
 * @returns {string}
 */
function successor(before, now, selected, named) {
  const names = now.map(({name}) => name);
  if (names.includes(selected)) return selected;
  const kin = before.some(({name}) => names.includes(name));
  const place = before.findIndex(({name}) => name === selected);
  if (kin) return names[Math.min(place, names.length - 1)];
  return names.includes(named) ? named : names[0];
}

/** @param {string} name */
function presetAddress(name) { return `/api/presets/${encodeURIComponent(name)}`; }
