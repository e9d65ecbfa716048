// @ts-check
/** The figures of a lane as the server's schema describes them: the one table of the page. */

import {SCHEMA} from '../api/schema_document.js';

/**
 * `unit` is that of the number as it comes, `shown_unit` that on the screen, `factor` between them.
 * What there is `per_joint` is `reduced` to one number, or has six columns; see columns.js.
 * @typedef {{name: string, title: string, short: string, symbol: string, unit: string,
 *   shown_unit: string, factor: number, digits: number, per_joint: boolean,
 *   reduced: 'mean'|'greatest'|'none', better: 'less'|'more'|'none', meaning: string,
 *   source: 'run'|'accuracy'|'margin', column: boolean, extra: boolean,
 *   live: boolean, not_live: string, unknown: string, studied: boolean}} Figure
 */

/** @type {Figure[]} in the order of the tables */
export const FIGURES = SCHEMA['x-figures'];

/**
 * @param {string} name
 * @returns {Figure}
 */
export function figureOf(name) {
  const found = FIGURES.find((figure) => figure.name === name);
  if (!found) throw new Error(`the schema has no figure ${name}`);
  return found;
}
