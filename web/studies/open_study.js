// @ts-check
/** One study: how far it is, what can be done with it, and what it shows. */

import {ARM} from '../api/arm.js';
import {element, freshId} from '../dom/element.js';
import {ask} from '../dom/dialog.js';
import {icon} from '../dom/icons.js';
import {tellWithUndo} from '../dom/undo_notice.js';
import {deleteStudy, isUnderWay, resumeStudy, stopStudy, studyFile} from '../api/requests/studies.js';
import {isWatching} from '../api/watch_only.js';
import {SCHEMA} from '../api/schema_document.js';
import {FieldNames} from '../fields/field_names.js';
import {Schema} from '../fields/schema.js';
import {ratioText} from '../goals/words.js';
import {RobustnessResult} from '../study_results/robustness.js';
import {SweepResult} from '../study_results/sweep.js';
import {WorstResult} from '../study_results/worst.js';
import {SearchResult} from '../study_search/search_result.js';
import {differencesOf} from './other_experiment.js';
import {StudyFeed} from './feed.js';
import {nameOf, progressWords, stateWords, whenOf} from './words.js';

/** @typedef {import('../api/api.js').Api} Api */
/** @typedef {import('../api/requests/studies.js').Summary} Summary */
/** @typedef {import('../api/requests/studies.js').Study} Study */
/** @typedef {import('../api/requests/studies.js').Entry} Entry */
/** @typedef {import('../page/right_panel.js').Desk} Desk */
/** @typedef {{element: HTMLElement, update: (study: Study, entries: Entry[]) => void,
 *   close?: () => void}} Result */

/** @type {{[kind: string]: new (api: Api, desk: Desk) => Result}} What shows a study of a kind. */
const RESULTS = {
  tune: SearchResult,
  robustness: RobustnessResult,
  worst: WorstResult,
  sweep: SweepResult,
};
const FILES = /** @type {const} */ ([['yaml', 'YAML'], ['csv', 'CSV'], ['parquet', 'Parquet']]);

/** A study, followed as long as it is open. */
export class OpenStudy {
  element;
  #api;
  #desk;
  #summary;
  #leave;
  #ended;
  #feed;
  #names;
  /** @type {Result|null} */ #result;
  #title;
  #state = element('span', {class: 'study-state'});
  #bar = element('progress', {class: 'study-progress', 'aria-label': 'Entries made'});
  #words = element('p', {class: 'study-words'});
  #aloud = element('p', {class: 'visually-hidden', role: 'status'});
  #alert = element('p', {class: 'control-alert', role: 'alert'});
  #lost = element('p', {class: 'study-lost', role: 'alert', hidden: true});
  #other = element('div', {class: 'study-other', hidden: true});
  #files = element('div', {class: 'study-row study-files', role: 'group', 'aria-label': 'Download'});
  #stop;
  #resume;
  #listening = new AbortController();

  /**
   * @param {Api} api
   * @param {Desk} desk
   * @param {Summary} summary
   * @param {{leave: () => void, ended: () => void}} told
   */
  constructor(api, desk, summary, {leave, ended}) {
    this.#api = api;
    this.#desk = desk;
    this.#summary = summary;
    this.#leave = leave;
    this.#ended = ended;
    this.#names = new FieldNames(new Schema(SCHEMA), api);
    this.#result = new RESULTS[summary.kind](api, desk);
    const id = freshId('study');
    this.#title = element('h3', {id, tabindex: -1}, nameOf(summary));
    const act = (/** @type {string} */ text, /** @type {() => void} */ run) => element('button', {
      class: 'button small', type: 'button', hidden: true, on: {click: run},
    }, text);
    this.#stop = act('Stop', () => this.#act(stopStudy));
    this.#resume = act('Resume', () => this.#act(resumeStudy));
    const remove = act('Delete…', () => this.#remove());
    remove.hidden = isWatching();
    this.element = element('section', {class: 'study-open', 'aria-labelledby': id},
      element('header', {class: 'study-head'}, element('button', {
        class: 'button small study-back', type: 'button', on: {click: leave},
      }, icon('chevron'), 'All studies'), this.#title, this.#state,
      element('span', {class: 'study-about'}, whenOf(summary))),
      this.#bar, this.#words, this.#aloud, this.#lost, this.#alert,
      element('div', {class: 'study-row'}, this.#stop, this.#resume, remove, this.#files),
      this.#other, this.#result?.element);
    this.#feed = new StudyFeed(summary.id);
    this.#feed.addEventListener('change', () => this.#show());
    this.#feed.addEventListener('lost', () => this.#tellLost());
    const {signal} = this.#listening;
    for (const type of ['hello', 'patch']) api.addEventListener(type, () => this.#compare(), {signal});
    this.#tell(summary);
    this.#feed.follow();
  }

  focus() { this.#title.focus(); }

  close() {
    this.#listening.abort();
    this.#feed.close();
    this.#result?.close?.();
  }

  /** The server is there again. */
  retry() { if (this.#feed.lost) this.#feed.follow(); }

  #show() {
    const {study, entries} = this.#feed;
    if (!study) return;
    const before = this.#summary;
    this.#summary = study;
    this.#tell(study);
    this.#compare();
    if (!isOfAnotherArm(study)) this.#result?.update(study, entries);
    if (isUnderWay(before) && !isUnderWay(study)) this.#ended();
  }

  /** @param {Summary & Partial<Study>} summary */
  #tell(summary) {
    const {state, made, total, result} = summary;
    const best = result?.best?.outcome.score;
    const words = [progressWords(summary),
      typeof best === 'number' && `best score ${ratioText(best)}`];
    this.#state.textContent = state;
    this.#state.dataset.state = state;
    this.#bar.max = total;
    this.#bar.value = made;
    this.#words.textContent = words.filter(Boolean).join(', ');
    const text = state === 'failed' || state === 'waiting' ? stateWords(summary) : state;
    // Every step read out would be too much.
    if (this.#aloud.textContent !== text) this.#aloud.textContent = text;
    if (state === 'failed' || state === 'waiting') this.#words.append(` · ${stateWords(summary)}`);
    this.#stop.hidden = isWatching() || !isUnderWay(summary);
    this.#resume.hidden = isWatching() || !(state === 'stopped' || state === 'failed');
    this.#offer(summary);
  }

  /** @param {Summary & Partial<Study>} summary */
  #offer({id, made, result}) {
    const formats = made ? [...FILES, ...(result?.best ? [/** @type {const} */ (['preset', 'Preset'])] : [])] : [];
    const offered = formats.map(([format]) => format).join();
    if (this.#files.dataset.offered === offered) return;
    this.#files.dataset.offered = offered;
    this.#files.replaceChildren(...formats.map(([format, name]) => element('a', {
      class: 'button small', href: studyFile(id, format), download: '',
    }, icon('download'), name)));
  }

  /** Say where the live experiment is another one. */
  #compare() {
    const {study} = this.#feed;
    if (!study) return;
    const foreign = isOfAnotherArm(study);
    if (this.#result) this.#result.element.hidden = foreign;
    const names = foreign ? [study.experiment.robot.model]
      : differencesOf(study, this.#api.experiment, this.#names);
    const text = names.join(', ');
    if (this.#other.dataset.text === text) return;
    this.#other.dataset.text = text;
    this.#other.hidden = !text;
    this.#other.replaceChildren(
      element('span', {}, foreign
        ? `It is of another arm, ${text}: what it found is shown with its experiment.`
        : `It is of another experiment than the live one, which differs in ${text}.`),
      isWatching() ? '' : element('button', {
        class: 'button small', type: 'button', on: {click: () => this.#load(study)},
      }, 'Load its experiment'),
    );
  }

  /** @param {Study} study */
  async #load(study) {
    const {history, tell} = this.#desk;
    try {
      await history.replace('loading of a study', () => this.#api.replaceExperiment(study.experiment));
      tellWithUndo(tell, history, `Loaded the experiment of ${nameOf(study)}.`);
    } catch (error) {
      this.#alert.textContent = /** @type {Error} */ (error).message;
    }
  }

  #tellLost() {
    const {lost} = this.#feed;
    this.#lost.hidden = !lost;
    if (!lost) { this.#lost.replaceChildren(); return; }
    this.#lost.replaceChildren(element('span', {}, lost), element('button', {
      class: 'button small', type: 'button', on: {click: () => this.#feed.follow()},
    }, 'Try again'));
  }

  /** @param {(id: number) => Promise<Summary>} change */
  async #act(change) {
    this.#alert.textContent = '';
    try {
      const summary = await change(this.#summary.id);
      this.#tell({...this.#feed.study, ...summary});
      this.#feed.follow();
      const next = this.#stop.hidden ? this.#resume : this.#stop;
      if (!next.hidden) next.focus();
    } catch (error) {
      this.#alert.textContent = /** @type {Error} */ (error).message;
    }
  }

  #remove() {
    ask(`Delete the study ${nameOf(this.#summary)}?`, [], 'Delete', async () => {
      await deleteStudy(this.#summary.id);
      this.#desk.tell(`Deleted ${nameOf(this.#summary)}.`);
      this.#leave();
    });
  }
}

/**
 * Its gains and columns are of other joints than this page has.
 *
 * @param {Study} study
 */
function isOfAnotherArm({experiment}) { return experiment.robot.model !== ARM.name; }
