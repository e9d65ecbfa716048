// @ts-check
/** Which curve lies on top: a restless one is a block that would hide a calm one behind it. */

/** @typedef {import('./panel_curves.js').Curve} Curve */

/** So many times as restless as the calmest one a curve goes behind the others (*ours*). */
const RESTLESS = 5;

/**
 * @param {Curve[]} curves of one panel, in the order in which they are drawn
 * @returns {Curve[]} the restless ones first; what is desired stays where it is
 */
export function calmOnTop(curves) {
  const actual = curves.filter(({trace}) => trace.role !== 'desired');
  if (actual.length < 2) return curves;
  const variations = new Map(actual.map((curve) => [curve, variation(curve.y)]));
  const calmest = Math.min(...[...variations.values()].filter((value) => value > 0));
  const restless = (/** @type {Curve} */ curve) => Number(variations.get(curve)) > RESTLESS * calmest;
  const behind = actual.filter(restless).sort((one, other) => (
    // Alike ones keep their order, so that it doesn't change from one redraw to the next.
    Math.round(Math.log10(Number(variations.get(other)) / Number(variations.get(one))))
  ));
  return [...behind, ...curves.filter((curve) => !behind.includes(curve))];
}

/**
 * @param {ArrayLike<number>} values
 * @returns {number} how far they travel; where there are none, nothing
 */
function variation(values) {
  let sum = 0;
  for (let index = 1; index < values.length; index += 1) {
    const way = Math.abs(values[index] - values[index - 1]);
    if (way > 0) sum += way;
  }
  return sum;
}
