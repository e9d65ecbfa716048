// @ts-check
/** What is to be said about a lane: why it stopped, and what is doubtful about its gains. */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';

/** @typedef {{level: 'info'|'warning', path: string, message: string}} Note */
/** @typedef {import('../api/api.js').LaneState} LaneState */
/** @typedef {{level: 'info'|'warning'|'frozen', text: string}} Line */

/** One lane's notes; the gravest stands in sight, the others open below it. */
export class MetricsNotes {
  element = element('div', {class: 'metrics-notes'});
  #shown = '';

  /**
   * @param {LaneState|null} frozen its state when it is frozen
   * @param {Note[]} notes
   */
  show(frozen, notes) {
    const lines = linesOf(frozen, notes);
    const shown = JSON.stringify(lines);
    if (shown === this.#shown) return;
    this.#shown = shown;
    const open = this.element.querySelector('details')?.open ?? false;
    const [first, ...others] = lines.map(drawn);
    if (!first) this.element.replaceChildren();
    else if (!others.length) this.element.replaceChildren(first);
    else {
      const count = element('span', {class: 'metrics-more'}, `+${others.length}`);
      count.title = `${others.length} more`;
      this.element.replaceChildren(element(
        'details', {open}, element('summary', {}, first, count), ...others,
      ));
    }
  }
}

/**
 * @param {LaneState|null} frozen
 * @param {Note[]} notes
 * @returns {Line[]} the gravest first
 */
function linesOf(frozen, notes) {
  /** @type {Line[]} */ const lines = [];
  if (frozen) lines.push({level: 'frozen', text: stopped(frozen)});
  for (const level of /** @type {const} */ (['warning', 'info'])) {
    for (const note of notes) {
      if (note.level === level) lines.push({level, text: note.message});
    }
  }
  return lines;
}

/** @param {LaneState} frozen */
function stopped({time, joint, cause}) {
  if (cause) return `Frozen. ${cause}`;
  const when = time === null ? '' : ` at ${time.toFixed(3)} s`;
  return `Frozen${when}${joint === null ? '' : `, joint ${joint}`}.`;
}

/** @param {Line} line */
function drawn({level, text}) {
  const grave = level !== 'info';
  return element(
    'span', {class: `metrics-note is-${level}`, title: text},
    grave && icon(level === 'frozen' ? 'close' : 'warning'),
    level === 'warning' && element('span', {class: 'visually-hidden'}, 'Warning: '),
    element('span', {class: 'metrics-note-text'}, text),
  );
}
