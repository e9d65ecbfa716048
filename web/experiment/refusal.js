// @ts-check
/** A document that was refused: every field with its line, and that nothing has changed. */

import {showDialog} from '../dom/dialog.js';
import {element} from '../dom/element.js';

/**
 * @param {string} title
 * @param {string} name of the document
 * @param {import('../api/api.js').ApiError} error
 */
export function showRefusal(title, name, {message, fields}) {
  const list = element('ul', {class: 'refusals'});
  for (const {path, message: text, line, allowed} of fields ?? []) {
    const where = [line ? `line ${line}` : '', path].filter(Boolean).join(', ');
    const hint = allowed && !text.includes(allowed) ? ` (allowed: ${allowed})` : '';
    list.append(element('li', {}, element('code', {}, where), ` ${text}${hint}`));
  }
  showDialog(title, element('div', {class: 'dialog-text'},
    element('p', {}, `${name} was refused; the live experiment is as it was.`),
    list.children.length ? list : element('p', {class: 'dialog-alert', role: 'alert'}, message)));
}
