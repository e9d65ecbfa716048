// @ts-check
/** What the trials of a tornado chart come to, in numbers and in words. */

import {figureText} from '../figures/columns.js';

/** @typedef {import('./study_metric.js').StudyRow} StudyRow */
/** @typedef {import('./study_metric.js').Metric} Metric */
/** @typedef {{name: string, rows: StudyRow[], reach: number}} Knob */

/** Less than this share of the figure is no effect. */
export const LEAST = 5e-4;

/**
 * @param {StudyRow} row
 * @returns {string} a name for a trial
 */
export function keyOf(row) { return `${row.name} ${row.factor}`; }

/**
 * @param {StudyRow[]} rows
 * @param {Metric} metric
 * @param {number|null} now the present figure
 * @param {boolean} ranked whether the strongest comes first
 * @returns {Knob[]}
 */
export function knobsOf(rows, metric, now, ranked) {
  const knobs = Map.groupBy(rows.filter((row) => !row.present), ({name}) => name);
  const found = [...knobs].map(([name, own]) => ({
    name, rows: own, reach: Math.max(...own.map((row) => Math.abs(effectOf(row, metric, now)))),
  }));
  return ranked ? found.sort((a, b) => b.reach - a.reach) : found;
}

/**
 * @param {StudyRow} row
 * @param {Metric} metric
 * @param {number|null} now
 * @returns {number} change as a share of what is; infinite where the run comes to nothing
 */
export function effectOf(row, {name}, now) {
  const figure = row[name];
  if (figure === null) return Infinity;
  return now ? figure / now - 1 : -Infinity;
}

/**
 * @param {StudyRow} row
 * @param {number} effect
 * @returns {string} classes of a bar
 */
export function kindOf({state}, effect) {
  if (state === 'diverged' || state === 'refused') return 'is-broken';
  const chatters = state === 'chattering' ? ' is-chattering' : '';
  return `${effect < 0 ? 'is-better' : 'is-worse'}${chatters}`;
}

/**
 * @param {StudyRow} row
 * @param {Metric} metric
 * @param {StudyRow|undefined} present how it stands before any knob is turned
 * @returns {string} such as `MAE −4.1 %`; where it begins or ceases to chatter, that first
 */
export function wordsOf(row, metric, present) {
  if (row.state === 'diverged') return 'diverges';
  if (row.state === 'refused') return 'refused';
  const effect = effectOf(row, metric, present?.[metric.name] ?? null);
  const figure = row[metric.name];
  if (!Number.isFinite(effect)) return figure === null ? '' : figureText(metric, figure);
  const percent = Math.abs(100 * effect);
  const sign = effect < 0 ? '−' : '+';
  const size = percent < 0.05 ? '±0' : `${sign}${percent.toFixed(percent < 10 ? 1 : 0)}`;
  const news = row.state === present?.state ? metric.short : ceasing(row);
  return `${news} ${size} %`;
}

/** @param {StudyRow} row */
function ceasing({state}) { return state === 'chattering' ? 'chatters,' : 'calm,'; }

/**
 * @param {StudyRow|undefined} present
 * @param {Metric} metric
 * @param {string} lane
 * @returns {string} how it stands before any knob is turned
 */
export function wordsOfNow(present, metric, lane) {
  if (!present) return `Trying every gain of ${lane} at −10 % and +10 % …`;
  const figure = present[metric.name];
  if (figure === null) return `${lane} diverges. Effect of ±10 % of each gain:`;
  return `${lane} now: ${metric.title} ${figureText(metric, figure)}. `
    + 'Effect of ±10 % of each gain:';
}
