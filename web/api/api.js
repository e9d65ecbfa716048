// @ts-check
/**
 * The server, its live session above all. Only this folder knows its addresses and messages.
 *
 * Views read the state fields and listen to the events:
 * `hello`, `patch`, `state`, `metrics`, `laws`, `notice`, `error`: the server's message as `detail`
 * (an `error` also carries the refused `patch`); `frame`: a {@link Frame};
 * `connection`: whether connected, and if not why and for how long; `select`: the lane's name;
 * `saved`: the preset's name, its experiment being the baseline now; `moving`: whether a control
 * is on its way; by key `joint`: from 1, toggled, and `cursor`: `A` or `B`, to be set; `learn`:
 * open the lessons; `edits`: open the list of edits; `home`: put the camera back; `show`: the `tab`
 * of the live plots to be seen, or another `view` of the right column; `group`: the key of a group of
 * the left column to be opened; `bound`: draw a goal in the plots of the response; `goal`: open the
 * form for one, with that `figure`, `joint` and `bound` in the unit on the screen; `look`: the past
 * `time` that
 * the 3D scene shows, null for the present; `silence`: the boundary layers from which on a lane does
 * not chatter, null where they are not known (any more).
 */

import {Connection} from './connection.js';
import {noteVersions} from '../fields/law_versions.js';
import {ApiError, request} from './http.js';
import {Outbox} from './outbox.js';
import {Runs} from './runs.js';
import {decoded} from './telemetry_frame.js';
import {isWatching, takeRole} from './watch_only.js';

export {ApiError};

/** @typedef {import('../fields/merge_patch.js').Document} Document */
/** @typedef {{name: string, color: string}} Lane */
/** @typedef {{name: string, group: string, joint: number|string, lane: string, unit: string}} Channel */
/**
 * @typedef {{name: string, title: string, summary: string, model_based: boolean,
 *   network: boolean, version: string}} Law
 * @typedef {{file: string, law: string, state: 'good'|'trying'|'refused', message: string,
 *   trace: string}} LawFile
 */
/**
 * @typedef {{status: 'running'|'frozen', time: number|null, joint: number|null,
 *   cause: string|null, gamma: number|null, radius: number|null, began: number,
 *   trace: string, remark: string|null}} LaneState `began`: when it was reset by itself [s], or 0
 */
/**
 * @typedef {{time: number, playing: boolean, speed: number, real_time_factor: number,
 *   capped: boolean, revision: number, epoch: number, waiting_steps: number, horizon: number,
 *   results: {response: number, lens: number}, lanes: {[name: string]: LaneState}}} State
 */
/** @typedef {import('./telemetry_frame.js').Frame} Frame */
/** @typedef {{name: string, title: string, description: string, shipped: boolean}} Preset */
/** @typedef {import('../lessons/lesson_document.js').Lesson} Lesson */
/** @typedef {import('../lessons/lesson_document.js').LessonSummary} LessonSummary */

/** For so long after a change here, what the server says of the view may be older. */
const VIEW_MS = 1000;

/** @returns {Promise<Document>} see schema_document.js, which has asked already */
export function askForSchema() { return request('GET', '/api/schema'); }

/** The live session, its experiment and its telemetry. */
export class Api extends EventTarget {
  /** @type {Document} */ experiment = {};
  /** @type {Document} the experiment as it was loaded */ baseline = {};
  /** Name of the loaded preset, or ''. */
  preset = '';
  /** @type {Lane[]} */ lanes = [];
  /** @type {Channel[]} */ channels = [];
  /** @type {Law[]} */ laws = [];
  /** @type {LawFile[]} */ lawFiles = [];
  /** @type {State|null} */ session = null;
  /** @type {Document|null} the last `metrics` message */ metrics = null;
  /** @type {import('../curves/ring.js').Ring|null} the last minute, which the plots keep */ kept = null;
  /** This page's id; patches that it sent come back with it as `author`. */
  client = '';
  /** Newest revision that the server told of. */
  revision = 0;
  /** @type {Set<number>} revisions that this page asked for without a patch */ made = new Set();
  version = '';
  connected = false;
  /** Whether a control is on its way: more values follow until `settled`. */
  moving = false;
  /** Name of the lane whose gains are on the screen. */
  selected = '';
  /** How the 3D scene is drawn. */
  drawn = {exaggeration: 1, ghosts: true};
  /** Whole runs beside the live session. */
  runs = new Runs(this);

  #viewed = 0;
  #connection = new Connection('/api/live', {
    message: (/** @type {Document} */ message) => this.#receive(message),
    bytes: (/** @type {ArrayBuffer} */ bytes) => this.#emit('frame', decoded(bytes)),
    change: (/** @type {Document} */ detail) => this.#connectionChanged(detail),
  });
  #outbox = new Outbox({
    send: (message) => this.#send(message),
    refused: (refusal) => this.#emit('error', refusal),
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
    this.#move(true);
    this.#outbox.add(patch);
  }

  /**
   * Change the live experiment at once.
   *
   * @param {Document} patch JSON merge patch
   * @returns {Promise<void>} kept when the server has accepted it, broken with an ApiError;
   *   no `error` event is raised.
   */
  change(patch) { return this.#outbox.deliver({type: 'patch', patch}); }

  /**
   * Wait until the server has answered every patch, or long enough.
   *
   * @returns {Promise<void>}
   */
  async settled() {
    await this.#outbox.settled();
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
  duplicateLane(origin, name) { return this.#outbox.deliver({type: 'lane', origin, name}); }

  // The session

  play() { this.#send({type: 'play'}); }

  pause() { this.#send({type: 'pause'}); }

  /** @param {number} [count] control steps */
  step(count = 1) { this.#send({type: 'step', count}); }

  /** @param {string} [lane] this one alone, while time goes on; else everything, to t = 0 */
  reset(lane) { this.#send({type: 'reset', ...(lane && {lane})}); }

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

  /** @returns {Promise<{[name: string]: number}>} what a client may do at most */
  async limits() { return (await request('GET', '/api/health')).limits; }

  /** @returns {Promise<Preset[]>} */
  async listPresets() { return (await request('GET', '/api/presets')).presets; }

  /** @param {string} name */
  loadPreset(name) { return this.#make(request('POST', `${presetAddress(name)}/load`)); }

  /** @param {string} name */
  deletePreset(name) { return request('DELETE', presetAddress(name)); }

  /**
   * @param {string} name to save the live experiment under
   * @param {{overwrite?: boolean}} [options]
   */
  async savePreset(name, {overwrite = false} = {}) {
    await this.settled();
    const saved = await request('PUT', `${presetAddress(name)}?overwrite=${overwrite}`);
    Object.assign(this, {preset: name, baseline: saved.experiment});
    this.#emit('saved', name);
    return saved;
  }

  /** @returns {Promise<string>} the live experiment as YAML */
  async exportYaml() {
    await this.settled();
    return request('GET', '/api/experiment?format=yaml');
  }

  /** @param {string|Document} document YAML text or a whole experiment */
  replaceExperiment(document) { return this.#make(request('PUT', '/api/experiment', document)); }

  /** @returns {Promise<string>} what stands for the live experiment in an address */
  async link() { return (await request('GET', '/api/link')).link; }

  /**
   * @param {string} link or an address with one
   * @param {boolean} despite whether what another version makes of it will do
   */
  openLink(link, despite) { return this.#make(request('POST', '/api/link', {link, despite})); }

  /** @param {string} name of the arm whose first experiment is begun */
  beginArm(name) { return this.#make(request('POST', `/api/arms/${encodeURIComponent(name)}/begin`)); }

  /** @returns {Promise<LessonSummary[]>} */
  async lessons() { return (await request('GET', '/api/lessons')).lessons; }

  /**
   * @param {string} name
   * @returns {Promise<Lesson>} with every step's experiment
   */
  lesson(name) { return request('GET', `/api/lessons/${encodeURIComponent(name)}`); }

  // The past

  /** @returns {Promise<import('../page/edit_history.js').Edit[]>} of this session, oldest first */
  async edits() { return (await request('GET', '/api/history')).edits; }

  /**
   * Go back to the experiment as it was after an edit; time and states go on.
   *
   * @param {number} number of the edit
   * @returns {Promise<{experiment: Document}>}
   */
  restoreEdit(number) { return this.#make(request('POST', `/api/history/${number}/restore`)); }

  /** @returns {Promise<{from: number|null, to: number|null}>} recorded moments in [s] */
  past() { return request('GET', '/api/session/past'); }

  /**
   * Show a past moment in the 3D scene; the session pauses.
   *
   * @param {number|null} time in [s]; null: the present
   */
  look(time) {
    this.dispatchEvent(new CustomEvent('look', {detail: {time}}));
    return request('POST', '/api/session/look', {time});
  }

  /**
   * Let all lanes go back to a recorded moment and go on from there, a variant of one beside them.
   *
   * @param {{time: number, origin: string, name: string, gains?: Document}} branch
   */
  fork(branch) { return this.#make(request('POST', '/api/session/fork', branch)); }

  /**
   * @param {Promise<any>} answer
   * @returns {Promise<any>}
   */
  async #make(answer) {
    const change = await answer;
    this.made.add(change.revision);
    return change;
  }

  // What arrives

  /** @param {Document} detail */
  #connectionChanged(detail) {
    // Connected means resynchronised: only `hello` says so.
    if (detail.open) return;
    this.connected = false;
    this.#outbox.lost();
    this.#emit('connection', {connected: false, ...detail});
  }

  /** @param {Document} message */
  #receive(message) {
    const before = this.revision;
    const told = message.revision ?? message.state?.revision ?? before;
    // Only a fresh start may go back: it may be another server's. Else news may be older than it.
    this.revision = message.type === 'hello' ? told : Math.max(before, told);
    switch (message.type) {
      case 'hello': this.#hello(message); break;
      case 'patch':
        if (told >= before) {
          this.experiment = message.experiment;
          this.#emit('patch', message);
        }
        if (message.author === this.client && message.id !== null) {
          this.#outbox.answered(message.id);
        }
        return;
      case 'state':
        this.session = /** @type {State} */ (message);
        if (performance.now() - this.#viewed > VIEW_MS) this.drawn = {...this.drawn, ...message.view};
        break;
      case 'metrics': this.metrics = message; break;
      case 'laws':
        this.#takeLaws(message);
        this.baseline = message.baseline ?? this.baseline;
        break;
      case 'error': this.#refused(message); return;
      default:
    }
    this.#emit(message.type, message);
  }

  /** @param {Document} message */
  #hello(message) {
    const {client, version, experiment, baseline, preset, channels, state} = message;
    takeRole(message.role, this.version !== '');
    if (!sameLaws(this.laws, message.laws)) location.reload();  // its schema is another one
    Object.assign(this, {client, version, experiment, baseline, preset, channels});
    this.#takeLaws(message);
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
  #takeLaws({laws, law_files: lawFiles}) {
    Object.assign(this, {laws, lawFiles});
    noteVersions(laws);
  }

  /** @param {Document} message */
  #refused(message) {
    const {code, message: text, fields} = message.error;
    const error = new ApiError(422, code, text, fields);
    if (this.#outbox.answered(message.id, error)) return;
    this.#emit('error', {id: message.id, error, patch: null});
  }

  /** @param {Document} message */
  #send(message) { return !isWatching() && this.#connection.send(message); }

  /**
   * @param {string} type
   * @param {any} detail
   */
  #emit(type, detail) { this.dispatchEvent(new CustomEvent(type, {detail})); }
}

/**
 * @param {Law[]} before none at the beginning
 * @param {Law[]} now
 */
function sameLaws(before, now) {
  const names = (/** @type {Law[]} */ laws) => laws.map(({name, version}) => `${name} ${version}`).join();
  return !before.length || names(before) === names(now);
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

/** @param {string} name of a preset */
export function presetAddress(name) { return `/api/presets/${encodeURIComponent(name)}`; }
