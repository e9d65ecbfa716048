// @ts-check
/** Which slider shows what lies along its track, and the short runs that it takes. */

import {versionOf} from '../fields/law_versions.js';
import {COUNT, Strip} from './heat_strip_view.js';
import {greatest} from '../fields/shares.js';

/** @typedef {import('../fields/schema.js').Field} Field */
/** @typedef {import('./study_metric.js').StudyRow} StudyRow */
/** @typedef {import('./study_metric.js').StudyMetric} StudyMetric */

const REST_MS = 400;
/** A strip that is known already comes sooner, and one of a slider that the keyboard goes to. */
const SOON_MS = 120;
/**
 * While a hand moves its slider the cores are the response's: the strip's runs would take a third of
 * its redraws, measured with three lanes on two cores. They go on as soon as it rests for so long.
 */
const PAUSE_MS = 150;
const KEPT = 80;
/** A pointer that moves less than this rests. */
const STILL_PX = 4;

/**
 * @param {HTMLElement} place holds the controls of the selected lane
 * @param {import('../api/api.js').Api} api
 * @param {(path: string) => Field|undefined} fieldAt by its dotted path
 * @param {StudyMetric} metric
 */
export function mountHeatStrips(place, api, fieldAt, metric) {
  new HeatStrips(place, api, fieldAt, metric);
}

/** Shows the strip of the one slider that is pressed, rested on, or that has the focus. */
class HeatStrips {
  #api;
  #fieldAt;
  #metric;
  /** @type {Map<string, StudyRow[]>} complete strips by what they depend on */ #known = new Map();
  /** @type {HTMLInputElement|null} */ #hovered = null;
  /** @type {HTMLInputElement|null} */ #focused = null;
  /** @type {Strip|null} */ #strip = null;
  /** @type {ReturnType<typeof setTimeout>|undefined} */ #timer;
  #rest = {x: 0, y: 0};

  /**
   * @param {HTMLElement} place
   * @param {import('../api/api.js').Api} api
   * @param {(path: string) => Field|undefined} fieldAt
   * @param {StudyMetric} metric
   */
  constructor(place, api, fieldAt, metric) {
    this.#api = api;
    this.#fieldAt = fieldAt;
    this.#metric = metric;
    place.addEventListener('pointerover', (event) => this.#over(event));
    place.addEventListener('pointermove', (event) => this.#moved(event));
    place.addEventListener('pointerleave', () => this.#hover(null));
    place.addEventListener('pointerdown', (event) => this.#press(event));
    // A finger that scrolls the page began on a slider by chance.
    place.addEventListener('pointercancel', () => this.#focus(null));
    place.addEventListener('focusin', ({target}) => {
      const slider = sliderOf(target);
      // One that is pressed gets the focus as well.
      if (slider && slider === this.#focused) return;
      this.#focus(slider?.matches(':focus-visible') ? slider : null);
    });
    place.addEventListener('focusout', () => this.#focus(null));
    place.addEventListener('input', () => this.#tuned());
    place.addEventListener('settled', () => this.#strip?.tell());
    for (const type of ['patch', 'hello', 'select']) {
      api.addEventListener(type, () => this.#check());
    }
    metric.addEventListener('change', () => this.#strip?.draw());
    new MutationObserver(() => this.#strip?.draw()).observe(
      document.documentElement, {attributes: true, attributeFilter: ['data-theme']},
    );
  }

  /** @param {PointerEvent} event */
  #over({target, pointerType, clientX: x, clientY: y}) {
    if (pointerType === 'touch') return;
    this.#rest = {x, y};
    this.#hover(sliderOf(target));
  }

  /** @param {PointerEvent} event */
  #moved({clientX: x, clientY: y, pointerType}) {
    this.#strip?.tell(x);
    if (pointerType === 'touch' || this.#strip) return;
    if (Math.hypot(x - this.#rest.x, y - this.#rest.y) < STILL_PX) return;
    this.#rest = {x, y};
    this.#await();
  }

  /**
   * Before the hand moves there is time for all positions.
   *
   * @param {PointerEvent} event
   */
  #press({target, pointerType}) {
    const slider = sliderOf(target);
    if (pointerType === 'mouse') this.#hover(slider);
    else this.#focus(slider);
    if (slider) this.#begin();
  }

  /** What the hand changes is no part of its own strip, but the runs have to wait. */
  #tuned() {
    const strip = this.#strip;
    if (!strip) return;
    if (strip.isComplete) { strip.tell(); return; }
    strip.pause();
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#run(strip), PAUSE_MS);
  }

  /** @param {HTMLInputElement|null} slider */
  #hover(slider) {
    if (slider === this.#hovered) return;
    this.#hovered = slider;
    this.#show();
  }

  /** @param {HTMLInputElement|null} slider */
  #focus(slider) {
    if (slider === this.#focused) return;
    this.#focused = slider;
    this.#show();
  }

  get #wanted() { return this.#hovered ?? this.#focused; }

  #show() {
    if (this.#strip?.slider === this.#wanted) return;
    this.#close();
    this.#await();
  }

  #close() {
    clearTimeout(this.#timer);
    this.#strip?.remove();
    this.#strip = null;
  }

  /** Begin when the pointer has come to rest. */
  #await() {
    clearTimeout(this.#timer);
    const slider = this.#wanted;
    const field = this.#field(slider);
    if (!slider || !field) return;
    const soon = slider !== this.#hovered || this.#known.has(this.#key(field, jointOf(slider)));
    this.#timer = setTimeout(() => this.#begin(), soon ? SOON_MS : REST_MS);
  }

  #begin() {
    clearTimeout(this.#timer);
    const slider = this.#wanted;
    const field = this.#field(slider);
    if (!slider?.isConnected || !field || this.#strip) return;
    const joint = jointOf(slider);
    const key = this.#key(field, joint);
    const known = this.#known.get(key);
    const strip = new Strip({slider, field, joint}, this.#metric, key, known);
    this.#strip = strip;
    if (!known) this.#run(strip);
  }

  /** @param {Strip} strip */
  async #run(strip) {
    const [, lane, name] = strip.field.path;
    const body = {lane, field: name, count: COUNT, joint: strip.joint};
    const signal = strip.go();
    try {
      await this.#api.runs.study('strip', body, (row) => {
        strip.add(/** @type {StudyRow} */ (row));
      }, signal);
    } catch (error) {
      if (!signal.aborted) strip.fail(/** @type {Error} */ (error).message);
      return;
    }
    if (signal.aborted || !strip.isComplete) return;
    this.#known.set(strip.key, strip.rows);
    for (const old of [...this.#known.keys()].slice(0, -KEPT)) this.#known.delete(old);
    strip.end();
  }

  /** What is shown may be of an experiment that is no more. */
  #check() {
    const strip = this.#strip;
    if (strip) {
      const field = this.#field(strip.slider);
      if (field && this.#key(field, strip.joint) === strip.key) { strip.tell(); return; }
      this.#close();
    }
    if (this.#wanted) this.#await();
  }

  /**
   * @param {HTMLInputElement|null} slider
   * @returns {Field|undefined} of a number that may be tuned
   */
  #field(slider) {
    const path = slider?.closest('.control')?.getAttribute('data-path');
    const field = path ? this.#fieldAt(path) : undefined;
    return field?.path[0] === 'lanes' && !field.odd ? field : undefined;
  }

  /**
   * Everything that a strip depends on: the lane but for the gain itself, and the world. Of one
   * joint's share also the other joints', of all joints' their proportions.
   *
   * @param {Field} field
   * @param {number|null} joint
   */
  #key({path: [, lane, name], length}, joint) {
    const {lanes, title, description, ...world} = this.#api.experiment;
    const gains = lanes[lane];
    const each = Array.from({length}, (_, index) => (
      joint === index + 1 ? 0 : gains[name][index] ?? gains[name]
    ));
    const rest = joint ? each : proportions(gains[name]);
    return JSON.stringify([lane, name, joint, {...gains, [name]: rest}, versionOf(gains.law), world]);
  }
}

/**
 * @param {EventTarget|null} target
 * @returns {HTMLInputElement|null} the slider, of all joints or of one, that it is
 */
function sliderOf(target) {
  const slider = target instanceof Element
    && target.matches('.control-input > .slider, .joint-row > .slider');
  return slider ? /** @type {HTMLInputElement} */ (target) : null;
}

/**
 * @param {HTMLInputElement} slider
 * @returns {number|null} the joint whose share it is, from 1; null: that of all joints
 */
function jointOf(slider) {
  return Number(slider.closest('.joint-row')?.getAttribute('data-joint')) || null;
}

/**
 * @param {number|number[]} value
 * @returns {number[]} shares of the greatest; none where there is one for all joints
 */
function proportions(value) {
  if (!Array.isArray(value)) return [];
  const most = greatest(value);
  return value.map((one) => Number((one / (most || 1)).toPrecision(4)));
}
