// @ts-check
/** What changed at which moment: the thin vertical lines in the plots. */

import {written} from '../fields/quantity.js';

/** @typedef {import('../curves/ring.js').Ring} Ring */
/** @typedef {{path: string, from: any, to: any}} Change */
/** @typedef {{time: number, lasted: number, changes: Change[]}} RevisionMark */

const MOST_MARKS = 20;
/** Changes of one control that follow each other this closely are one drag. */
const DRAG_SECONDS = 0.6;
const MOST_LINES = 4;
/** What no curve of a live lane depends on. */
const UNSEEN = new Set(['title', 'description', 'slidetune', 'goals', 'uncertainty']);

/**
 * Every value that differs between two documents.
 *
 * @param {any} from
 * @param {any} to
 * @param {string} [path]
 * @returns {Change[]}
 */
export function changesBetween(from, to, path = '') {
  if (isBranch(from) && isBranch(to)) {
    const names = new Set([...Object.keys(from), ...Object.keys(to)]);
    return [...names].flatMap((name) => (
      UNSEEN.has(name) && !path ? []
        : changesBetween(from[name], to[name], path ? `${path}.${name}` : name)
    ));
  }
  return JSON.stringify(from) === JSON.stringify(to) ? [] : [{path, from, to}];
}

/** @param {any} value */
function isBranch(value) {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

/**
 * @param {any} value
 * @returns {string}
 */
function inWords(value) {
  if (typeof value === 'number') return written(value);
  if (Array.isArray(value)) return `[${value.map(inWords).join(', ')}]`;
  return value === null ? 'off' : String(value);
}

/**
 * One change in words, such as `NFTSM.nu 0.3 → 30`.
 *
 * @param {Change} change
 */
function inLine({path, from, to}) {
  const name = path.replace(/^lanes\./, '');
  if (from === undefined) return isBranch(to) ? `${name} added` : `${name} ${inWords(to)}`;
  if (to === undefined) return `${name} removed`;
  if (isBranch(from) || isBranch(to)) return `${name} changed`;
  return `${name} ${inWords(from)} → ${inWords(to)}`;
}

/**
 * @param {RevisionMark} mark
 * @returns {string[]} lines of text
 */
export function linesOf({changes, lasted}) {
  const lines = changes.slice(0, MOST_LINES).map(inLine);
  const more = changes.length - MOST_LINES;
  if (more > 0) lines.push(`and ${more} more`);
  if (lasted > 0.05) lines.push(`over ${lasted.toFixed(1)} s`);
  return lines;
}

/**
 * @param {RevisionMark} older
 * @param {RevisionMark} newer
 * @returns {boolean} whether both belong to one drag
 */
function sameDrag(older, newer) {
  const paths = new Set(older.changes.map((change) => change.path));
  return newer.time - older.time - older.lasted < DRAG_SECONDS
    && newer.changes.every((change) => paths.has(change.path));
}

/**
 * @param {RevisionMark} older
 * @param {RevisionMark} newer
 * @returns {RevisionMark}
 */
function merged(older, newer) {
  const last = new Map(newer.changes.map((change) => [change.path, change.to]));
  const changes = older.changes.map((change) => (
    last.has(change.path) ? {...change, to: last.get(change.path)} : change
  ));
  return {time: older.time, lasted: newer.time - older.time, changes};
}

/** The experiment's revisions, joined with the rows where they took effect. */
export class RevisionMarks {
  /** @type {any} */ #experiment = null;
  /** @type {Map<number, Change[]>} */ #changes = new Map();

  /**
   * Take note of a revision: what differs from the one before.
   *
   * @param {number} revision
   * @param {any} experiment
   */
  note(revision, experiment) {
    if (this.#experiment) {
      const changes = changesBetween(this.#experiment, experiment);
      if (changes.length) this.#changes.set(revision, changes);
    }
    this.#experiment = experiment;
  }

  /** Forget what no row tells of any more. */
  clear() { this.#changes.clear(); }

  /**
   * @param {Ring} ring
   * @returns {RevisionMark[]} the newest, in order of time
   */
  of(ring) {
    const oldest = ring.marks[0]?.after ?? -1;
    const known = [...this.#changes].filter(([revision]) => revision > oldest);
    if (ring.marks.length) this.#changes = new Map(known);
    /** @type {RevisionMark[]} */ const marks = [];
    let next = 0;
    for (const {row, revision} of ring.marks) {
      const first = next;
      while (next < known.length && known[next][0] <= revision) next += 1;
      if (next === first) continue;
      const changes = joined(known.slice(first, next).flatMap(([, list]) => list));
      const mark = {time: ring.timeOf(row), lasted: 0, changes};
      const older = marks[marks.length - 1];
      if (older && sameDrag(older, mark)) marks[marks.length - 1] = merged(older, mark);
      else marks.push(mark);
    }
    return marks.slice(-MOST_MARKS);
  }
}

/**
 * One entry for each path, from its first value to its last.
 *
 * @param {Change[]} changes
 * @returns {Change[]}
 */
function joined(changes) {
  /** @type {Map<string, Change>} */ const byPath = new Map();
  for (const change of changes) {
    const first = byPath.get(change.path);
    byPath.set(change.path, first ? {...first, to: change.to} : change);
  }
  return [...byPath.values()];
}
