// @ts-check
/** The arm that the page is for: a page whose experiment is about another one begins anew. */

import {SCHEMA} from './schema_document.js';

/**
 * `slides`: it slides along its axis, so that m and N stand for rad and N·m.
 * @typedef {{name: string, title: string, meaning: string,
 *   joints: {name: string, slides: boolean}[]}} Arm
 */

/** @typedef {{preset: string, experiment: {[section: string]: any}, title: string}} Former */

/** @type {Arm} */
export const ARM = SCHEMA['x-arm'];
/** Its joints by number, from 1. */
export const JOINTS = ARM.joints.map((_, index) => index + 1);
/** What its description calls them. */
export const JOINT_NAMES = ARM.joints.map(({name}) => name);
/** What stands for the unit of a joint that turns where it slides; the longer ones first. */
const SLIDING = [['N·m', 'N'], ['kg·m²', 'kg'], ['rad', 'm']];

/**
 * @param {string} unit of joints that turn, or as the schema writes that of both kinds: `rad | m`
 * @param {number} joint from 1
 * @returns {string} the unit at that joint
 */
export function unitAt(unit, joint) {
  const [turning, sliding] = unit.split(' | ');
  if (!ARM.joints[joint - 1]?.slides) return turning;
  return sliding ?? SLIDING.reduce((text, [turns, slides]) => text.replaceAll(turns, slides), turning);
}

/**
 * @param {string} unit of joints that turn
 * @returns {string} of all joints: both where only some slide
 */
export function unitOfAll(unit) {
  return [...new Set(JOINTS.map((joint) => unitAt(unit, joint)))].join(' | ');
}

const BEFORE = 'slidetune.before-arm';
let beginningAnew = false;

/** @returns {boolean} whether this page is about to be gone: its requests under way get no answer */
export function isBeginningAnew() { return beginningAnew; }

/**
 * Whoever changes the arm, every page begins anew: before anybody else hears of the other one. The page
 * that comes next knows what was there; see `formerExperiment`.
 *
 * @param {import('./api.js').Api} api nobody listens to yet
 */
export function beginAnewForAnother(api) {
  /** @type {Former|null} */ let former = null;
  const look = (/** @type {Event} */ event) => {
    const {experiment} = /** @type {CustomEvent} */ (event).detail;
    if (experiment.robot.model === ARM.name) {
      former = {preset: api.preset, experiment, title: ARM.title};
      return;
    }
    event.stopImmediatePropagation();
    if (former) keepFormer(former);
    beginningAnew = true;
    location.reload();
  };
  api.addEventListener('hello', look);
  api.addEventListener('patch', look);
}

/** @param {Former} former */
function keepFormer(former) {
  try {
    sessionStorage.setItem(BEFORE, JSON.stringify(former));
  } catch {
    // Storage may be full or switched off; the list of edits leads back as well.
  }
}

/** @returns {Former|null} what this page showed before its arm became another one, once */
export function formerExperiment() {
  try {
    const kept = sessionStorage.getItem(BEFORE);
    sessionStorage.removeItem(BEFORE);
    return kept ? JSON.parse(kept) : null;
  } catch {
    return null;
  }
}

/** @returns {string} such as `six joints`, `one joint` */
export function jointCount() {
  const names = ['no', 'one', 'two', 'three', 'four', 'five', 'six', 'seven', 'eight', 'nine', 'ten',
    'eleven', 'twelve'];
  const count = JOINTS.length;
  return `${names[count] ?? count} joint${count === 1 ? '' : 's'}`;
}
