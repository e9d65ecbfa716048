// @ts-check
/** Modal dialogs: one question, a refusal in words inside it, Escape as the way out. */

import {element, freshId} from './element.js';
import {icon} from './icons.js';

/**
 * @typedef {{name: string, label: string, value?: string, hint?: string, long?: boolean,
 *   required?: boolean, length?: number, options?: {value: string, text: string}[],
 *   when?: {[name: string]: string}}} Question
 *   `options`: one of these, not any text; `when`: asked only while these have been answered
 */

/**
 * @param {string} title
 * @param {...import('./element.js').Child} content
 * @returns {HTMLDialogElement} shown, and gone when it is closed
 */
export function showDialog(title, ...content) {
  const id = freshId('dialog');
  const close = element('button', {
    class: 'button icon-only small', type: 'button', 'aria-label': 'Close',
    on: {click: () => dialog.close()},
  }, icon('close'));
  const head = element('header', {class: 'dialog-head'}, element('h2', {id}, title), close);
  const dialog = element('dialog', {class: 'dialog', 'aria-labelledby': id}, head, ...content);
  dialog.addEventListener('close', () => dialog.remove());
  dialog.addEventListener('pointerdown', (event) => {
    // Only the backdrop is the dialog itself; everything else lies inside its padding.
    if (event.target === dialog && outside(dialog, event)) dialog.close();
  });
  document.body.append(dialog);
  dialog.showModal();
  return dialog;
}

/**
 * @param {HTMLElement} box
 * @param {PointerEvent} event
 */
function outside(box, event) {
  const {left, right, top, bottom} = box.getBoundingClientRect();
  const {clientX: x, clientY: y} = event;
  return x < left || x > right || y < top || y > bottom;
}

/**
 * Ask for text and do something with it; what refuses it is shown and may be mended.
 *
 * @param {string} title
 * @param {Question[]} questions
 * @param {string} action what the button says
 * @param {(answers: {[name: string]: string},
 *   dialog: {relabel: (text: string) => void, signal: AbortSignal})
 *   => Promise<void>} run throws to refuse; the signal tells that the dialog was left meanwhile
 */
export function ask(title, questions, action, run) {
  const alert = element('p', {class: 'dialog-alert', role: 'alert'});
  const submit = element('button', {class: 'button primary', type: 'submit'}, action);
  const cancel = element('button', {
    class: 'button', type: 'button', on: {click: () => dialog.close()},
  }, 'Cancel');
  const buttons = element('div', {class: 'dialog-buttons'}, cancel, submit);
  const progress = element('div', {class: 'running-bar', 'aria-hidden': 'true', hidden: true});
  const boxes = questions.map(asked);
  const form = element('form', {class: 'dialog-form'}, ...boxes, alert, progress, buttons);
  const left = new AbortController();
  const showAsked = () => {
    questions.forEach(({name, when = {}}, index) => {
      const said = new FormData(form);
      const hidden = Object.entries(when).some(([other, value]) => said.get(other) !== value);
      boxes[index].hidden = hidden;
      // Nobody can answer what isn't shown, and what is disabled is neither required nor sent.
      /** @type {HTMLInputElement} */ (form.elements.namedItem(name)).disabled = hidden;
    });
  };
  const relabel = (/** @type {string} */ text) => { submit.textContent = text; };
  form.addEventListener('input', () => {
    alert.textContent = '';
    if (!submit.disabled) relabel(action);
    showAsked();
  });
  form.addEventListener('submit', async (event) => {
    event.preventDefault();
    submit.disabled = true;
    progress.hidden = false;
    try {
      const entries = [...new FormData(form)].map(([name, value]) => [name, String(value)]);
      await run(Object.fromEntries(entries), {relabel, signal: left.signal});
      dialog.close();
    } catch (error) {
      alert.textContent = /** @type {Error} */ (error).message;
    }
    submit.disabled = false;
    progress.hidden = true;
  });
  const dialog = showDialog(title, form);
  dialog.addEventListener('close', () => left.abort());
  showAsked();
  const first = /** @type {HTMLInputElement?} */ (form.querySelector('input, select, textarea'));
  first?.focus();
  first?.select?.();
}

/** @param {Question} question */
function asked({name, label, value = '', hint, long = false, required = false, length = 200, options}) {
  const id = freshId('answer');
  const note = hint && element('small', {class: 'dialog-hint'}, hint);
  if (options) {
    const choices = options.map((one) => element('option', {value: one.value}, one.text));
    const list = element('select', {id, name, class: 'select'}, ...choices);
    list.value = value || options[0].value;
    return element('div', {class: 'question'}, element('label', {for: id}, label), list, note);
  }
  const attributes = {
    id, name, required, maxlength: length, autocomplete: 'off', spellcheck: 'false', class: 'text-box',
  };
  const box = long ? element('textarea', {...attributes, rows: 4}) : element('input', attributes);
  box.value = value;
  return element('div', {class: 'question'}, element('label', {for: id}, label), box, note);
}
