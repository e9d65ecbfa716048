// @ts-check
/** What many draws come to: how many held, within what their responses lie, quantiles. */

import {element} from '../dom/element.js';
import {isUnderWay, studyBands} from '../api/requests/studies.js';
import {figureHeading, figureNumber} from '../figures/columns.js';
import {goalWords, ratioText} from '../goals/words.js';
import {LensCard, choice, percent} from '../lenses/card.js';
import {LensFigure} from '../lenses/figure.js';
import {RESPONSE_VIEWS} from '../response/views.js';
import {bandFigure, boundsIn} from './band_figure.js';
import {STUDIED, classOf, colorOf} from './outcome_words.js';

/** @typedef {import('../api/requests/studies.js').Study} Study */
/** @typedef {import('../api/requests/studies.js').Draw} Draw */
/** @typedef {import('../api/requests/studies.js').Bands} Bands */

const HEIGHT = 150;
/** Least time between two looks at the bands of a running study in [ms]; ours. */
const BANDS_MS = 1500;
const JOINTS = [1, 2, 3, 4, 5, 6];
/** Those of which bands are kept. */
const VIEWS = RESPONSE_VIEWS.filter(({id}) => ['error', 'torque', 'flange-error'].includes(id));
const QUANTILES = /** @type {const} */ ([
  ['p5', '5 %', 'Five of a hundred draws do not exceed it'],
  ['median', 'median', 'Half of the draws do not exceed it'],
  ['p95', '95 %', 'Ninety-five of a hundred draws do not exceed it'],
  ['worst', 'worst', 'No draw exceeds it'],
]);

/** Shows draws. */
export class RobustnessResult {
  element;
  #api;
  #held = new LensCard({title: 'How many held', equation: '', words: ''});
  #bands;
  #table;
  #body = element('tbody');
  #places = element('div', {class: 'study-bands'});
  #view = VIEWS[0];
  /** @type {Map<string, LensFigure>} */ #figures = new Map();
  /** @type {Study|null} */ #study = null;
  /** @type {Bands|null} */ #known = null;
  #gone = 0;
  #asked = -Infinity;
  #made = -1;
  #asking = false;

  /** @param {import('../api/api.js').Api} api */
  constructor(api) {
    this.#api = api;
    const views = choice('Quantity', VIEWS, (id) => {
      this.#view = VIEWS.find((view) => view.id === id) ?? VIEWS[0];
      this.#draw();
    });
    this.#bands = new LensCard({
      title: 'Within what the responses lie', equation: '',
      words: 'Filled: nine tenths of the draws. The thick line is their median, the thin ones their extremes.',
    }, views, this.#places);
    const table = element('table', {class: 'lens-table study-quantiles'}, element('thead', {}, element('tr', {},
      element('th', {scope: 'col'}, 'Over the draws'),
      ...QUANTILES.map(([, text, title]) => element('th', {scope: 'col', title}, text)))), this.#body);
    this.#table = new LensCard({
      title: 'Figures and goals', equation: '',
      words: 'Goals as ratios to their bounds: 1 is just met. – where a draw that came to no end would count.',
    }, element('div', {class: 'lens-scroll', tabindex: 0, role: 'region', 'aria-label': 'Quantiles'}, table));
    this.element = element('div', {class: 'study-result'},
      this.#held.element, this.#bands.element, this.#table.element);
  }

  /**
   * @param {Study} study
   * @param {import('../api/requests/studies.js').Entry[]} entries
   */
  update(study, entries) {
    this.#study = study;
    this.#gone = entries.filter(({outcome}) => outcome.diverged_at !== null).length;
    this.#tell(study, entries.length);
    this.#tabulate(study);
    this.#ask();
  }

  /**
   * @param {Study} study
   * @param {number} count
   */
  #tell({result, experiment}, count) {
    const {diverged = 0, kept = 0} = result;
    const hard = Object.values(experiment.goals ?? {}).some(({priority}) => priority === 'hard');
    this.#held.facts = [
      {name: 'draws', value: String(count)},
      {name: 'left their bounds', value: count ? percent(diverged) : '–'},
      ...(hard ? [{name: 'kept the hard goals', value: count ? percent(kept) : '–'}] : []),
    ];
    this.#bands.finding = this.#gone
      ? `${this.#gone} of ${count} draws left their bounds: a band ends where such a draw would count.` : '';
  }

  /** @param {Study} study */
  #tabulate({result, experiment}) {
    const {figures = {}, ratios = {}} = result.quantiles ?? {};
    const goals = experiment.goals ?? {};
    const rows = [
      ...STUDIED.filter(({name}) => figures[name]).map((figure) => row(figureHeading(figure), figure.meaning,
        QUANTILES.map(([key]) => ({text: figureNumber(figure, figures[figure.name][key]), tone: ''})))),
      ...Object.keys(goals).filter((name) => ratios[name]).map((name) => row(
        goalWords(goals[name], experiment.simulation.horizon), name, QUANTILES.map(([key]) => ({
          text: ratioText(ratios[name][key]), tone: classOf(goals[name], ratios[name][key]),
        })), goals[name].priority,
      )),
    ];
    this.#body.replaceChildren(...rows);
    this.#table.element.hidden = !rows.length;
  }

  /** Ask for the bands when there are more draws, though not too often. */
  async #ask() {
    const study = this.#study;
    if (!study || this.#asking || study.made === this.#made || !study.made) return;
    if (isUnderWay(study) && performance.now() < this.#asked + BANDS_MS) return;
    this.#asking = true;
    this.#asked = performance.now();
    const {made} = study;
    try {
      this.#known = await studyBands(study.id);
      this.#made = made;
      this.#bands.words = 'Filled: nine tenths of the draws. The thick line is their median, the thin '
        + 'ones their extremes.';
    } catch (error) {
      this.#bands.words = `The bands could not be fetched: ${/** @type {Error} */ (error).message}`;
      this.#asking = false;
      return;
    }
    this.#asking = false;
    this.#draw();
    // Draws may have come meanwhile, the last ones even.
    this.#ask();
  }

  #draw() {
    const [study, known] = [this.#study, this.#known];
    if (!study || !known) return;
    const panels = this.#view.panels(JOINTS).filter(({channel}) => known.curves[channel]);
    const figures = panels.map((panel) => {
      let figure = this.#figures.get(panel.id);
      if (!figure) this.#figures.set(panel.id, figure = new LensFigure({height: HEIGHT}));
      figure.element.dataset.panel = panel.id;
      figure.draw(`${panel.quantity} of ${panel.title}: band over ${known.draws} draws`, (colors) => bandFigure(colors, {
        time: known.time, band: known.curves[panel.channel], panel,
        color: colorOf(this.#api, study, colors), bounds: boundsIn(study, panel),
      }));
      return figure.element;
    });
    const there = [...this.#places.children];
    if (there.length !== figures.length || there.some((one, index) => one !== figures[index])) {
      this.#places.replaceChildren(...figures);
    }
  }
}

/**
 * @param {string} heading
 * @param {string} title
 * @param {{text: string, tone: string}[]} cells
 * @param {string} [priority] of a goal
 */
function row(heading, title, cells, priority = '') {
  return element('tr', {}, element('th', {scope: 'row', title}, heading,
    priority && element('span', {class: 'study-priority'}, ` ${priority}`)),
  ...cells.map(({text, tone}) => element('td', {class: tone || null}, text)));
}
