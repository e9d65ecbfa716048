// @ts-check
/**
 * Over the plots of the response: where its goals are missed, grips to move them, and a sheet to
 * draw one on.
 *
 * The plotting library can draw and move shapes as well. Every move of one would be a layout of the
 * whole figure to it, where a pointer here costs two styles; and a shape knows of no band around
 * zero, no round values, no keys, and nothing that a finger could hit. So it draws the lines alone,
 * as curves, which its images have too.
 */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {GoalEdits} from '../goals/edits.js';
import {isWatching} from '../api/watch_only.js';
import {boundsOf} from './bounds.js';
import {BoundDrawing} from './drawing.js';
import {BoundGrips} from './grips.js';
import {BoundPreview} from './preview.js';
import {BoundShading} from './shading.js';

/** @typedef {import('../plots/canvas.js').TimeAxis} TimeAxis */
/** @typedef {import('../response/curves.js').ResponseSheet} ResponseSheet */

/** Bounds over one stage. */
export class BoundLayer {
  /** Of the toolbar. */
  button;
  #edits;
  #sheet;
  #shading = new BoundShading();
  #preview = new BoundPreview();
  #grips;
  #drawing;
  #overlay;
  /** @type {TimeAxis|null} */ #axis = null;
  #empty = true;

  /**
   * @param {HTMLElement} stage
   * @param {import('../api/api.js').Api} api its event `bound` asks for one to be drawn
   * @param {import('../api/undo.js').History} history
   * @param {{sheet: () => ResponseSheet, refused: (text: string) => void,
   *   added: (goal: import('../goals/words.js').Goal, horizon: number) => void}} source `sheet`:
   *   what the plots show; `refused`: why a bound was; `added`: it is a goal now
   */
  constructor(stage, api, history, {sheet, refused, added}) {
    this.#sheet = sheet;
    this.#edits = new GoalEdits(api, history);
    this.#grips = new BoundGrips(this.#edits, this.#preview, () => this.show());
    this.#drawing = new BoundDrawing(this.#preview, {
      drawn: async (goal) => {
        const {horizon = 0} = sheet().current ?? {};
        const refusal = await this.#edits.add(goal, 'draw a bound');
        if (refusal) refused(refusal);
        else added(goal, horizon);
      },
      armed: (armed) => this.#armed(armed),
    });
    this.button = element('button', {
      type: 'button', class: 'plots-button bound-draw', 'aria-pressed': 'false', hidden: isWatching(),
      title: 'Draw a bound: a goal for the response', 'aria-label': 'Draw a bound',
      on: {click: () => this.#drawing.arm(!this.#drawing.armed)},
    }, icon('bound'), element('span', {}, 'Draw a bound'));
    this.#overlay = element('div', {class: 'bounds'},
      this.#shading.element, this.#grips.element, this.#drawing.element, this.#preview.element);
    stage.before(element('div', {class: 'bound-notice'}, this.#drawing.hint));
    stage.append(this.#overlay);
    api.addEventListener('hello', () => { this.button.hidden = isWatching(); });
    api.addEventListener('bound', () => this.#drawing.arm(true));
  }

  /**
   * Follow a redraw of the plots.
   *
   * @param {TimeAxis|null} axis null where there are no plots
   */
  place(axis) {
    this.#axis = axis;
    this.show();
  }

  /** Bring shading and grips up to date; without goals there is nothing to do. */
  show() {
    const axis = this.#axis;
    const goals = this.#edits.all;
    const any = axis !== null && Object.values(goals).some(({kind}) => kind === 'response');
    if (!any && !this.#drawing.armed) { this.#clear(); return; }
    const sheet = this.#sheet();
    // Between a choice of other panels and their drawing the two don't belong together.
    const fits = axis?.panels.length === sheet.panels.length;
    if (!axis || !fits || !sheet.current) { this.#clear(); return; }
    this.#empty = false;
    const {current, shows} = sheet;
    this.#overlay.style.height = `${axis.height}px`;
    this.#drawing.place({axis, panels: sheet.panels, horizon: current.horizon});
    const panels = sheet.panels.map((panel) => (
      {panel, bounds: boundsOf(goals, panel, current, shows)}
    ));
    const lanes = [...current.lanes.values()].filter(({name}) => shows(name));
    this.#shading.show(axis, panels, lanes, this.#edits.held);
    if (!isWatching()) this.#grips.show(axis, panels, current.horizon);
  }

  #clear() {
    if (this.#empty) return;
    this.#empty = true;
    this.#shading.clear();
    this.#grips.clear();
    this.#drawing.place(null);
  }

  /** @param {boolean} armed */
  #armed(armed) {
    this.button.setAttribute('aria-pressed', String(armed));
    this.show();
  }
}
