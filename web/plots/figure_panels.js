// @ts-check
/** Where the panels of a figure lie, and what their traces are called and coloured. */

/** @typedef {import('./figure.js').Drawing} Drawing */

export const MARGIN = {l: 78, r: 10, t: 8, b: 36};
/** Pixels between two panels. */
export const GAP = 12;

/**
 * @param {Pick<Drawing, 'panels'|'height'>} drawing
 * @returns {number} in pixels
 */
export function heightOfPanel({panels, height}) {
  return (height - MARGIN.t - MARGIN.b - GAP * (panels.length - 1)) / panels.length;
}

/**
 * A name for a trace that survives others' coming and going; the library makes selectors of it.
 *
 * @param {string} kind
 * @param {Drawing} drawing
 * @param {number} index of the panel
 * @param {string} [lane]
 */
export function traceId(kind, {colors}, index, lane = '') {
  return `${kind}-${index}-${[...colors.keys()].indexOf(lane)}`;
}

/** @param {number} index of the panel, from 0 */
export function axisNumber(index) { return index ? String(index + 1) : ''; }

/**
 * A lane that only a baseline still has is grey.
 *
 * @param {Drawing} drawing
 * @param {string} lane
 */
export function colorOf({colors, theme}, lane) { return colors.get(lane) ?? theme.muted; }
