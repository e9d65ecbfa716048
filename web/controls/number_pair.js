// @ts-check
/** A slider and a number box that hold one value. */

import {element} from '../dom/element.js';
import {isTravel} from '../screen/keys.js';
import {POSITIONS, fitting, fraction, read, valueAlong, written} from '../fields/quantity.js';

/**
 * @typedef {object} PairOptions
 * @property {import('../fields/schema.js').Field} field
 * @property {string} name what the two are called
 * @property {string} [id] of the box, for a label
 * @property {string} [describedBy]
 * @property {(value: number) => void} move called for every value on the way
 * @property {() => Promise<void>} commit called at its end
 * @property {() => Promise<void>} cancel called where it is given up
 * @property {(interrupt: () => void) => () => void} watch for what else changes the value, until
 *   that which it returns is called
 * @property {() => void} settle called when the server has answered
 * @property {() => void} reset
 * @property {(text: string) => void} refuse
 */

/** A finger that moves less than this across, in pixels, may still be about to scroll. */
const SLOP = 4;
const ARROWS = new Map([['ArrowUp', 1], ['ArrowDown', -1], ['PageUp', 10], ['PageDown', -10]]);

/**
 * While a person holds it, the answers to its own values don't move it. Another's value does, and
 * ends the drag: what the hand does until it lets go is nothing.
 */
export class NumberPair {
  /** The value on the screen. */
  value = NaN;
  slider;
  box;
  #options;
  #baseline = NaN;
  #holds = 0;
  #keyed = false;
  #typed = false;
  /** Whether the pointer that is down moves nothing any more. */
  #isEnded = false;
  #unwatch = () => {};
  /** @type {{x: number, value: number}|null} where a finger came down; null once it drags */
  #finger = null;

  /** @param {PairOptions} options */
  constructor(options) {
    this.#options = options;
    const {field: {minimum, maximum, step, log}, name, id, describedBy} = options;
    const range = log ? {min: 0, max: POSITIONS, step: 1} : {min: minimum, max: maximum, step};
    this.slider = element('input', {
      ...range, type: 'range', class: 'slider', 'aria-label': `${name} slider`,
      'aria-describedby': describedBy, on: this.#sliderEvents(),
    });
    this.box = element('input', {
      type: 'text', inputmode: 'decimal', role: 'spinbutton', class: 'number-box', id,
      'aria-label': id ? null : name, 'aria-describedby': describedBy, 'aria-valuemin': minimum,
      'aria-valuemax': maximum, autocomplete: 'off', spellcheck: 'false', on: this.#boxEvents(),
    });
  }

  /** Whether a person is changing it, or its last change is not answered yet. */
  get held() { return this.#holds > 0 || this.#typed; }

  /**
   * Show the server's value, unless a person holds it.
   *
   * @param {number} value
   * @param {number} baseline
   */
  set(value, baseline) {
    this.#baseline = baseline;
    if (!this.held) this.#show(value);
  }

  /** @param {boolean} disabled */
  disable(disabled) {
    this.slider.disabled = disabled;
    this.box.disabled = disabled;
  }

  /** @param {number} value */
  #show(value) {
    this.value = value;
    const {field} = this.#options;
    const at = fraction(value, field);
    this.slider.value = String(field.log ? Math.round(at * POSITIONS) : value);
    this.slider.setAttribute('aria-valuetext', `${written(value)} ${field.unit}`.trim());
    this.box.setAttribute('aria-valuenow', String(value));
    this.box.value = written(value);
    // The bar grows from zero where zero lies within the range.
    const zero = !field.log && field.minimum < 0 ? fraction(0, field) : 0;
    const {style} = this.slider;
    style.setProperty('--from', String(Math.min(at, zero)));
    style.setProperty('--to', String(Math.max(at, zero)));
    style.setProperty('--mark', String(fraction(this.#baseline, field)));
  }

  #sliderEvents() {
    return {
      pointerdown: (/** @type {PointerEvent} */ {pointerType, clientX: x}) => {
        this.#press();
        this.#finger = pointerType === 'touch' ? {x, value: this.value} : null;
      },
      pointermove: (/** @type {PointerEvent} */ {clientX}) => {
        if (this.#finger && Math.abs(clientX - this.#finger.x) > SLOP) this.#drag();
      },
      pointerup: () => { this.#drag(); this.#lift(); },
      pointercancel: () => { this.#scrolled(); this.#lift(); },
      // The finger that lands beside the thumb to scroll must not set a gain.
      input: () => {
        if (this.#isEnded) this.#show(this.value);
        else if (!this.#finger) this.#move(this.#sliderValue());
      },
      // A held key would otherwise make one entry of the history per step.
      change: () => { if (!this.#keyed) this.#end(); },
      keydown: (/** @type {KeyboardEvent} */ {key}) => {
        if (key.startsWith('Arrow') || /^(Page|Home|End)/.test(key)) this.#keyed = true;
      },
      keyup: () => this.#endKeyed(),
      blur: () => { this.#isEnded = false; this.#endKeyed(); },
      dblclick: () => this.#options.reset(),
    };
  }

  #boxEvents() {
    return {
      focus: () => this.box.select(),
      input: (/** @type {InputEvent} */ {inputType}) => {
        // The browser's own memory of the box knows nothing of what was taken meanwhile.
        if (inputType.startsWith('history')) this.#forget();
        else this.#typed = true;
      },
      keydown: (/** @type {KeyboardEvent} */ event) => this.#boxKey(event),
      keyup: () => this.#endKeyed(),
      blur: () => { this.#endKeyed(); this.#accept(); },
    };
  }

  /** What a finger does is a drag, or a tap: take the value that it has reached. */
  #drag() {
    if (!this.#finger) return;
    this.#finger = null;
    this.#move(this.#sliderValue());
  }

  /** What a finger did was to scroll. */
  #scrolled() {
    if (!this.#finger) return;
    this.#show(this.#finger.value);
    this.#finger = null;
  }

  #sliderValue() {
    const {field} = this.#options;
    const position = this.slider.valueAsNumber;
    if (field.log) return valueAlong(position / POSITIONS, field);
    return fitting(position, field);
  }

  /** @param {KeyboardEvent} event */
  #boxKey(event) {
    const steps = ARROWS.get(event.key);
    // With nothing typed the key is the page's undo.
    if (isTravel(event) && this.#typed) {
      event.preventDefault();
      this.#forget();
    }
    if (event.key === 'Enter') this.#accept();
    if (event.key === 'Escape') this.#forget();
    if (steps === undefined) return;
    event.preventDefault();
    this.#accept();
    const {field} = this.#options;
    const size = field.step * steps * (event.shiftKey ? 10 : 1);
    this.#keyed = true;
    this.#move(fitting(this.value + size, field));
  }

  /** Take what was typed. */
  #accept() {
    if (!this.#typed) return;
    this.#typed = false;
    const value = read(this.box.value, this.#options.field.unit);
    if (!Number.isFinite(value)) {
      this.#options.refuse(`“${this.box.value}” is not a number`);
      this.#show(this.value);
      return;
    }
    if (written(value) === written(this.value)) this.#show(this.value);
    else { this.#move(value); this.#end(); }
  }

  #forget() {
    this.#typed = false;
    this.#show(this.value);
    this.box.select();
  }

  /** @param {number} value */
  #move(value) {
    if (this.#holds === 0) this.#hold();
    this.#show(value);
    this.#options.move(value);
  }

  #endKeyed() {
    if (!this.#keyed) return;
    this.#keyed = false;
    this.#end();
  }

  #hold() { this.#holds += 1; }

  #press() {
    this.#isEnded = false;
    this.#hold();
    this.#unwatch();
    const unwatch = this.#options.watch(() => this.#interrupt(this.#options.commit));
    const cancel = (/** @type {KeyboardEvent} */ event) => {
      if (event.key !== 'Escape' || !this.slider.isConnected) return;
      event.preventDefault();
      event.stopPropagation();
      this.#interrupt(this.#options.cancel);
    };
    // Wherever the focus is: a finger gives it to no slider.
    document.addEventListener('keydown', cancel, true);
    this.#unwatch = () => {
      unwatch();
      document.removeEventListener('keydown', cancel, true);
    };
  }

  #lift() {
    this.#unwatch();
    this.#isEnded = false;
    if (this.#holds > 0) this.#end();
  }

  /** @param {() => Promise<void>} how it ends */
  #interrupt(how) {
    this.#unwatch();
    this.#isEnded = true;
    this.#finger = null;
    this.#end(how);
  }

  /** @param {() => Promise<void>} [how] */
  async #end(how = this.#options.commit) {
    const holds = this.#holds;
    if (!holds) return;
    await how();
    // Someone may have taken hold again while the server was answering.
    if (this.#holds !== holds) return;
    this.#holds = 0;
    this.#options.settle();
    // What lies along its track is told, too.
    this.slider.dispatchEvent(new Event('settled', {bubbles: true}));
  }
}
