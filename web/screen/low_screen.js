// @ts-check
/** Screens so low that plots under each other would not be seen together. */

/** Pixels of height; ours. */
const LOW = '(height < 1000px)';

/**
 * @param {number} height of a plot in pixels
 * @param {number} low on a low screen
 */
export function heightHere(height, low) { return matchMedia(LOW).matches ? low : height; }
