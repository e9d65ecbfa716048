// @ts-check
/** The lenses: the selected lane's whole response, looked at so that it explains itself. */

import {JOINTS} from '../api/arm.js';
import {element} from '../dom/element.js';
import {ChatteringLens} from './chattering.js';
import {keyOf} from '../fields/response_key.js';
import {NetworkLens} from './network.js';
import {PredictionLens} from './prediction.js';
import {SlidingLens} from './sliding.js';
import {LiveTrail} from '../live/trail.js';
import {holdOf} from '../curves/panel_curves.js';
import {PlotTabs} from '../dom/tab_row.js';
import {RedrawPace} from '../screen/redraw_pace.js';
import {recall, remember} from '../screen/remembered.js';
import {isWatching, ownersLast} from '../api/watch_only.js';

/** @typedef {import('../api/api.js').Api} Api */
/** @typedef {import('../page/right_panel.js').Desk} Desk */

/** Least time between two looks, and between two moves of the live point, in [ms]. */
const LEAST_MS = 500;

/**
 * @param {HTMLElement} root
 * @param {Api} api
 * @param {Desk} desk
 */
export function mount(root, api, desk) { new Lenses(root, api, desk); }

class Lenses {
  #api;
  #root;
  #lenses;
  #lens;
  #joint = JOINTS.find((joint) => String(joint) === recall('lens.joint')) ?? 1;
  #tabs;
  #bodies;
  #scroll = element('div', {class: 'lens-scroller', tabindex: -1});
  #name = element('span', {class: 'lens-lane'});
  #status = element('span', {class: 'lens-status'});
  #message = element('p', {class: 'lens-message', role: 'status'});
  /** @type {HTMLButtonElement[]} */ #joints;
  #seen = '';
  /** Of the experiment that the page shows. */ #revision;
  /** @type {any} */ #look = null;
  #busy = false;
  #since = -Infinity;
  #timer = 0;
  #visible = false;
  #pace = new RedrawPace(() => { if (this.#awake) this.#sliding.move(); });
  #sliding;

  /**
   * @param {HTMLElement} root
   * @param {Api} api
   * @param {Desk} desk
   */
  constructor(root, api, desk) {
    this.#api = api;
    this.#revision = api.revision;
    this.#root = root;
    const trail = new LiveTrail(api);
    this.#sliding = new SlidingLens({trail: (joint) => trail.of(joint)});
    this.#lenses = [this.#sliding, new NetworkLens(), new ChatteringLens(api, desk),
      new PredictionLens(api, desk)];
    this.#lens = this.#lenses.find(({id}) => id === recall('lens')) ?? this.#lenses[0];
    this.#bodies = this.#lenses.map(({element: cards}) => element('div', {class: 'lens-body'}, ...cards));
    this.#tabs = new PlotTabs(this.#lenses, this.#scroll, (id) => this.#choose(id));
    this.#tabs.element.setAttribute('aria-label', 'Lenses');
    this.#tabs.element.className = 'lens-tabs';
    for (const tab of this.#tabs.element.children) tab.className = 'lens-tab';
    this.#joints = JOINTS.map((joint) => element('button', {
      type: 'button', class: 'lens-choice', 'aria-label': `Joint ${joint}`,
      title: `Joint ${joint} (key ${joint})`, on: {click: () => this.#chooseJoint(joint)},
    }, String(joint)));
    root.classList.add('lenses');
    this.#scroll.append(this.#message, ...this.#bodies);
    root.append(this.#tabs.element, this.#head(), this.#scroll);
    this.#listen();
    this.#choose(this.#lens.id);
    this.#chooseJoint(this.#joint);
  }

  #head() {
    return element(
      'div', {class: 'lens-head'}, this.#name,
      element('div', {class: 'lens-choices', role: 'group', 'aria-label': 'Joint'},
        element('span', {class: 'lens-label', 'aria-hidden': 'true'}, 'joint'), ...this.#joints),
      this.#status,
    );
  }

  #listen() {
    for (const type of ['hello', 'patch', 'select']) {
      this.#api.addEventListener(type, (event) => {
        // Other messages tell of the session, which may lag behind the experiment.
        this.#revision = /** @type {CustomEvent} */ (event).detail.revision ?? this.#revision;
        this.#nameLane();
        this.#tell();
        this.#refresh();
      });
    }
    this.#api.addEventListener('state', () => { if (isWatching()) this.#refresh(); });
    this.#api.addEventListener('frame', () => {
      if (this.#lens === this.#sliding && this.#awake) this.#pace.request({least: LEAST_MS});
    });
    this.#api.addEventListener('joint', (event) => {
      if (this.#awake) this.#chooseJoint(/** @type {CustomEvent} */ (event).detail);
    });
    this.#api.addEventListener('show', (event) => {
      const {lens} = /** @type {CustomEvent} */ (event).detail;
      if (lens) this.#choose(lens);
    });
    document.addEventListener('visibilitychange', () => this.#refresh());
    new ResizeObserver(([{contentRect}]) => {
      this.#visible = contentRect.width > 0 && contentRect.height > 0;
      this.#refresh();
    }).observe(this.#root);
  }

  /** Whether anybody can see it. */
  get #awake() { return this.#visible && !document.hidden; }

  /** @param {string} id */
  #choose(id) {
    this.#lens = this.#lenses.find((lens) => lens.id === id) ?? this.#lenses[0];
    remember('lens', this.#lens.id);
    this.#tabs.select(this.#lens.id);
    this.#scroll.scrollTop = 0;
    this.#nameLane();
    this.#show();
    this.#refresh();
  }

  /** @param {number} joint */
  #chooseJoint(joint) {
    this.#joint = joint;
    remember('lens.joint', String(joint));
    this.#joints.forEach((button, index) => {
      button.setAttribute('aria-pressed', String(JOINTS[index] === joint));
    });
    this.#show();
  }

  #nameLane() {
    const lane = this.#api.lanes.find(({name}) => name === this.#api.selected);
    const dot = element('span', {class: 'plots-dot', 'aria-hidden': 'true'});
    dot.style.setProperty('--lane', lane?.color ?? 'transparent');
    this.#name.replaceChildren(dot, element('b', {}, lane?.name ?? ''));
  }

  // What is computed

  /** Look anew if anything has changed that the response depends on, though not too often. */
  #refresh() {
    const {selected, connected} = this.#api;
    if (!this.#awake || !connected || !selected || this.#busy || this.#timer) return;
    const key = this.#key();
    if (key === this.#seen || !this.#fits) return;
    const wait = this.#since + LEAST_MS - performance.now();
    this.#timer = setTimeout(() => {
      this.#timer = 0;
      // They may have been hidden meanwhile, and a lane may have gone.
      if (this.#root.checkVisibility() && this.#fits) this.#fetch();
    }, Math.max(wait, 0));
  }

  /** Whether there is such a lane: of other lanes the server may have told already. */
  get #fits() { return this.#api.selected in (this.#api.experiment.lanes ?? {}); }

  #key() {
    const {experiment, selected, session} = this.#api;
    // Nothing is computed for a page that watches: there is news when the owner has some.
    const depends = isWatching() ? `${selected} ${session?.results.lens}` : keyOf(experiment, selected);
    return `${this.#lens.id} ${depends}`;
  }

  async #fetch() {
    const {selected: lane} = this.#api;
    const [key, {id}, revision, present] = [
      this.#key(), this.#lens, this.#revision, this.#api.experiment,
    ];
    this.#busy = true;
    this.#since = performance.now();
    this.#root.classList.add('is-busy');
    if (!isWatching()) this.#status.textContent = 'computing …';
    let failure = '';
    try {
      const seen = await this.#api.runs.lens(lane, [/** @type {any} */ (id)]);
      // The owner's look may be at an older experiment, which comes with it.
      const {experiment} = {experiment: present, ...seen};
      const gains = experiment.lanes?.[lane] ?? {};
      if (seen) this.#look = {id, lane, seen, gains, experiment, hold: holdOf(experiment), revision};
      else if (isWatching()) this.#look = null;
    } catch (error) {
      this.#look = null;
      failure = /** @type {Error} */ (error).message;
    }
    // A refusal isn't asked for again until something changes.
    this.#seen = key;
    this.#busy = false;
    this.#root.classList.remove('is-busy');
    this.#show();
    if (failure) this.#say(failure);
    this.#refresh();
  }

  // What is shown

  /** Whether what was looked at last is what is chosen now. */
  get #shown() { return this.#look?.id === this.#lens.id && this.#look.lane === this.#api.selected; }

  /** Say which revision it is; while one is computed, that is said. */
  #tell() {
    const look = this.#look;
    if (this.#busy && !isWatching()) return;
    this.#status.textContent = !look || !this.#shown ? ''
      : isWatching() ? ownersLast('look', look.seen.revision, this.#api.revision)
        : `whole response, rev ${look.revision}`;
  }

  #show() {
    const look = this.#look;
    this.#tell();
    if (!this.#shown) {
      this.#say(this.#api.connected ? this.#waiting() : 'Not connected.');
      return;
    }
    const {lane, seen, gains, hold, experiment} = look;
    const color = this.#api.lanes.find(({name}) => name === lane)?.color ?? '#808080';
    const nothing = this.#lens.show({
      seen, lane, color, gains, hold, experiment, joint: this.#joint, horizon: seen.horizon,
    });
    this.#say(nothing ?? '', seen.frozen && `The response ends early. ${seen.frozen.cause}`);
  }

  #waiting() {
    if (!isWatching()) return 'Computing the whole response …';
    return `The owner has not opened this lens for ${this.#api.selected} yet. `
      + 'It appears here as soon as they do.';
  }

  /**
   * Show the pictures, or say why there are none.
   *
   * @param {string} nothing why there is nothing to see
   * @param {string|null} [warning] above the pictures
   */
  #say(nothing, warning = null) {
    const text = nothing || warning || '';
    this.#message.hidden = !text;
    this.#message.classList.toggle('is-warning', Boolean(warning));
    if (this.#message.textContent !== text) this.#message.textContent = text;
    this.#bodies.forEach((body, index) => {
      body.hidden = Boolean(nothing) || this.#lenses[index] !== this.#lens;
    });
  }
}
