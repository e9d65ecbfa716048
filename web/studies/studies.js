// @ts-check
/** Studies: begin one, watch it, open one that is kept. */

import {element} from '../dom/element.js';
import {recall, remember} from '../screen/remembered.js';
import {isUnderWay} from '../api/requests/studies.js';
import {takeBack} from '../study_search/comparison.js';
import {triedStill} from '../study_search/tried_gains.js';
import {NewStudy} from './new_study.js';
import {OpenStudy} from './open_study.js';
import {StudyList} from './study_list.js';

/** @typedef {import('../api/api.js').Api} Api */
/** @typedef {import('../api/requests/studies.js').Summary} Summary */
/** @typedef {import('../page/right_panel.js').Desk} Desk */
/** @typedef {import('../page/right_panel.js').Tab} Tab */

/**
 * @param {HTMLElement} root
 * @param {Api} api
 * @param {Desk & {tab: Tab}} desk
 */
export function mount(root, api, desk) { new Studies(root, api, desk); }

class Studies {
  #api;
  #desk;
  #visible = false;
  #form;
  #list;
  #overview;
  #place = element('div', {class: 'study-place', hidden: true});
  /** @type {OpenStudy|null} */ #open = null;
  #begun = false;

  /**
   * @param {HTMLElement} root
   * @param {Api} api
   * @param {Desk & {tab: Tab}} desk
   */
  constructor(root, api, desk) {
    this.#api = api;
    this.#desk = desk;
    this.#form = new NewStudy(api, (summary) => this.#show(summary, true));
    this.#list = new StudyList((summary) => this.#show(summary, true), () => this.#visible && !this.#open);
    this.#overview = element('div', {class: 'study-overview'},
      element('h3', {class: 'study-heading'}, 'New study'), this.#form.element, this.#list.element);
    root.classList.add('studies');
    root.append(element('div', {class: 'study-scroller', tabindex: -1}, this.#overview, this.#place));
    new ResizeObserver(([{contentRect}]) => {
      const before = this.#visible;
      this.#visible = contentRect.width > 0 && contentRect.height > 0;
      if (this.#visible && !before) this.#seen();
    }).observe(root);
    api.addEventListener('hello', () => {
      this.#tellTried();
      if (this.#visible) this.#seen();
    }, {once: true});
    api.addEventListener('connection', (event) => {
      if (!(/** @type {CustomEvent} */ (event).detail.connected) || !this.#begun) return;
      this.#open?.retry();
      if (this.#visible) this.#seen();
    });
  }

  /** Say that the live lane has gains which were tried before the page was loaded anew. */
  #tellTried() {
    const tried = triedStill(this.#api.experiment);
    if (!tried) return;
    const {tell, tab} = this.#desk;
    if (!this.#visible) tab.mark(true);
    const takeAway = tell(`${tried.lane} has the gains of trial ${tried.origin.trial} still, which were tried as B.`, {action: {
      label: 'Back to A',
      run: () => takeBack(this.#api).catch((error) => tell(error.message, {error: true})),
    }});
    const over = new AbortController();
    this.#api.addEventListener('patch', () => {
      if (triedStill(this.#api.experiment)) return;
      over.abort();
      takeAway();
    }, {signal: over.signal});
  }

  /** It can be seen: nothing is asked for before. */
  async #seen() {
    if (!this.#api.experiment.lanes) return; // the live experiment comes first
    this.#desk.tab.mark(false);
    this.#form.ask();
    const first = !this.#begun;
    this.#begun = true;
    if (this.#open) return;
    await this.#list.refresh();
    if (!first || this.#open) return;
    const studies = this.#list.studies ?? [];
    const last = studies.find(({id}) => String(id) === recall('studies.open'));
    const wanted = last ?? studies.find(isUnderWay);
    if (wanted) this.#show(wanted, false);
  }

  /**
   * @param {Summary} summary
   * @param {boolean} focus whether a hand has opened it
   */
  #show(summary, focus) {
    this.#open?.close();
    remember('studies.open', String(summary.id));
    this.#open = new OpenStudy(this.#api, this.#desk, summary, {
      leave: () => this.#back(),
      ended: () => { if (!this.#visible) this.#desk.tab.mark(true); },
    });
    this.#place.replaceChildren(this.#open.element);
    this.#place.hidden = false;
    this.#overview.hidden = true;
    if (focus) this.#open.focus();
  }

  async #back() {
    this.#open?.close();
    this.#open = null;
    remember('studies.open', null);
    this.#place.replaceChildren();
    this.#place.hidden = true;
    this.#overview.hidden = false;
    /** @type {HTMLElement|null} */ (this.#form.element.querySelector('input:checked'))?.focus();
    await this.#list.refresh();
  }
}
