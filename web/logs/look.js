// @ts-check
/** How the curves of a log are told from those of lanes: grey, and each with dashes of its own. */

const DASHES = [{name: 'dash-dot', dash: '9px,3px,2px,3px'}, {name: 'dot', dash: '2px,3px'}];

/**
 * @param {number} place among the logs that are shown
 * @returns {{name: string, dash: string}}
 */
export function dashOf(place) { return DASHES[place % DASHES.length]; }
