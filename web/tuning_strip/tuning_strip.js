// @ts-check
/** On a narrow screen above the controls: what a move does, while the plots are out of sight. */

import {element} from '../dom/element.js';
import {COLUMNS, inDigits} from '../figures/columns.js';
import {RedrawPace} from '../screen/redraw_pace.js';
import {changeOf} from '../figures/change.js';
import {responsePanels} from '../response/curves.js';
import {markLag} from '../response/lag.js';
import {RESPONSE_VIEWS} from '../response/views.js';
import {StripPlot} from './strip_plot.js';
import {isWatching} from '../api/watch_only.js';
import {YRanges} from '../curves/y_range.js';

/** @typedef {import('../api/preview_message.js').LaneResponse} LaneResponse */
/** @typedef {import('../api/preview_message.js').Response} Response */

/**
 * @param {HTMLElement} workspace
 * @param {import('../api/api.js').Api} api
 * @param {import('../api/preview.js').Preview} preview the response that the plots show as well
 * @param {import('../response/before.js').ResponseBefore} before
 */
export function mountTuningStrip(workspace, api, preview, before) {
  workspace.prepend(new TuningStrip(api, preview, before).element);
}

/** The error of one joint in every lane, and figures of the lane that is tuned. */
class TuningStrip {
  element;
  #api;
  #preview;
  #before;
  #plot = new StripPlot(() => this.#pace.request());
  #title = element('p', {class: 'strip-title'});
  // As high before the first figures as with them: the controls below stay where they are.
  #figures = element('dl', {class: 'strip-figures'}, ...[1, 2, 3].map(placeholder));
  #message = element('p', {class: 'strip-message'});
  #ranges = new YRanges();
  #pace = new RedrawPace(() => this.#draw());
  #lane = '';
  #joint = 1;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../api/preview.js').Preview} preview
   * @param {import('../response/before.js').ResponseBefore} before
   */
  constructor(api, preview, before) {
    this.#api = api;
    this.#preview = preview;
    this.#before = before;
    const open = element('button', {
      type: 'button', class: 'strip-open', 'aria-label': 'Open the plots of the response',
      title: 'Open the plots of the response', on: {click: () => this.#open()},
    });
    this.element = element(
      'section', {class: 'strip', 'aria-label': 'What the last change did'},
      this.#title, this.#plot.element, this.#figures, this.#message, open,
    );
    for (const type of ['response', 'failed']) {
      preview.addEventListener(type, () => this.#pace.request());
    }
    before.addEventListener('change', () => this.#pace.request());
    api.addEventListener('select', () => this.#pace.request());
    markLag(this.element, preview, api);
    api.addEventListener('hello', () => this.#looked());
    new ResizeObserver(() => this.#looked()).observe(this.element);
    document.addEventListener('visibilitychange', () => this.#looked());
  }

  /** Whether anybody can see it. A page that watches has the plots. */
  get #seen() {
    return this.#api.connected && !isWatching() && !document.hidden
      && this.element.checkVisibility();
  }

  #looked() {
    this.#preview.needed('strip', this.#seen);
    if (!this.#seen) return;
    this.#before.complete();
    this.#pace.request();
  }

  #open() {
    this.#api.dispatchEvent(new CustomEvent('show', {detail: {view: 'response'}}));
    // What had the focus is out of sight now.
    /** @type {HTMLElement|null} */ (
      document.querySelector('#plots [role="tab"][aria-selected="true"]')
    )?.focus();
  }

  #draw() {
    if (!this.#seen) return;
    const {latest, failure} = this.#preview;
    const {selected} = this.#api;
    const now = latest?.lanes.get(selected);
    const said = failure && `The response could not be computed: ${failure}`;
    this.#say(said || (now ? now.frozen?.cause ?? '' : 'Computing the response …'), Boolean(now));
    if (!latest || !now) return;
    this.#choose(selected, now);
    this.#plot.draw(this.#curves(latest), this.#api);
    const dot = element('span', {class: 'plots-dot', 'aria-hidden': 'true'});
    dot.style.setProperty('--lane', this.#colorOf(selected));
    this.#title.replaceChildren(
      dot, element('b', {}, selected),
      element('span', {}, `error of joint ${this.#joint} over ${latest.horizon} s`),
    );
    const then = this.#before.response?.lanes.get(selected) ?? null;
    this.#figures.replaceChildren(...this.#columns().map((column) => figure(column, now, then)));
  }

  /**
   * The joint that follows worst, but during a drag the same one.
   *
   * @param {string} lane
   * @param {LaneResponse} now
   */
  #choose(lane, now) {
    if (lane === this.#lane && this.#api.moving) return;
    const {mae} = now.metrics;
    const joint = mae.indexOf(Math.max(...mae)) + 1 || 1;
    if (joint !== this.#joint) this.#ranges.clear();
    this.#lane = lane;
    this.#joint = joint;
  }

  /** @param {Response} current */
  #curves(current) {
    const before = this.#before.isShown ? this.#before.response : null;
    const window = /** @type {import('../curves/y_range.js').Range} */ ([0, current.horizon]);
    const panels = RESPONSE_VIEWS[0].panels([this.#joint]);
    const shows = () => true;
    const goals = this.#api.experiment.goals ?? {};
    return {
      ...responsePanels({panels, current, before, goals, pinned: [], logs: [], shows, window}, this.#ranges)[0],
      window,
    };
  }

  #columns() {
    const ids = [`mae${this.#joint}`, 'max_error', 'chattering'];
    return COLUMNS.filter(({id}) => ids.includes(id));
  }

  /** @param {string} lane */
  #colorOf(lane) { return this.#api.lanes.find(({name}) => name === lane)?.color ?? ''; }

  /**
   * @param {string} text
   * @param {boolean} drawn whether there is a response to see
   */
  #say(text, drawn) {
    this.#message.textContent = text;
    this.#message.hidden = !text;
    this.#figures.style.visibility = text ? 'hidden' : '';
    this.element.classList.toggle('is-empty', !drawn);
  }
}

function placeholder() {
  return element(
    'div', {}, element('dt', {}, '\u00a0'), element('dd', {}, '\u00a0'),
    element('dd', {class: 'response-change'}),
  );
}

/**
 * @param {import('../figures/columns.js').Column} column
 * @param {LaneResponse} now
 * @param {LaneResponse|null} then
 */
function figure({title, unit, value, figure: {better, digits}}, now, then) {
  const is = value(now.metrics, null);
  const was = then && !then.frozen ? value(then.metrics, null) : null;
  const change = then?.frozen ? {kind: 'better', text: 'diverged before'} : changeOf(was, is, better);
  return element(
    'div', {}, element('dt', {}, title),
    element('dd', {}, `${inDigits(is, digits)} `, element('small', {}, unit)),
    element('dd', {class: `response-change is-${change.kind}`}, change.text),
  );
}
