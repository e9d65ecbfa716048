// @ts-check
/** What searched numbers are called. */

import {element, symbol} from '../dom/element.js';

/** @typedef {import('../fields/field_names.js').FieldNames} FieldNames */

/**
 * @param {FieldNames} names
 * @param {string} lane
 * @param {string} name of a searched number, such as `k1[3]`
 */
function partsOf(names, lane, name) {
  const [, gain, joint] = /^(.*?)(?:\[(\d)\])?$/.exec(name) ?? ['', name, ''];
  const {symbol: sign, title, unit} = names.of(['lanes', lane, gain]);
  return {sign, title, unit, joint: joint ? ` J${joint}` : ''};
}

/**
 * @param {FieldNames} names
 * @param {string} lane
 * @param {string} name
 * @returns {string} such as `k₁ J3`
 */
export function gainText(names, lane, name) {
  const {sign, title, joint} = partsOf(names, lane, name);
  return `${sign.replace('_', '') || title}${joint}`;
}

/**
 * @param {FieldNames} names
 * @param {string} lane
 * @param {string} name
 * @param {{units?: boolean}} [options]
 * @returns {HTMLElement} the same with its indices below the line, and its meaning as title
 */
export function gainName(names, lane, name, {units = false} = {}) {
  const {sign, title, unit, joint} = partsOf(names, lane, name);
  const end = `${joint}${units && unit ? ` [${unit}]` : ''}`;
  return element('span', {title: `${title}${joint}`}, sign ? symbol(sign) : title, end);
}
