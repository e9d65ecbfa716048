// @ts-check
/** What a step of a lesson has changed, value by value. */

import {element, withIndices} from '../dom/element.js';

/**
 * @param {import('./lesson_document.js').LessonChange[]} list
 * @returns {HTMLElement|null} null where there is nothing to tell
 */
export function changes(list) {
  if (!list.length) return null;
  const rows = list.map(({label, was, now}) => (
    element('li', {}, element('b', {}, withIndices(label)), ` ${was} → ${now}`)
  ));
  return element('ul', {class: 'lesson-changes', 'aria-label': 'Changed'}, ...rows);
}
