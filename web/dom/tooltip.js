// @ts-check
/** What a control means: shown on hover and on focus, beside the thing and not over it. */

import {element, symbol, withIndices} from './element.js';
import {withUnit, written} from '../fields/quantity.js';

/** @typedef {import('../fields/schema.js').Field} Field */

const HOVER_MS = 350;
const FOCUS_MS = 600;
const LEAVE_MS = 150;
const GAP = 10;
/** @type {{[source: string]: string}} */
const SOURCES = {
  published: 'as published',
  corrected: 'published, corrected here',
  vendor: 'from the manufacturer',
  inferred: 'inferred: the paper doesn’t say',
  ours: 'ours',
};

/** @type {HTMLElement|null} */
let shown = null;
/** @type {ReturnType<typeof setTimeout>|undefined} */
let timer;

/**
 * @param {Field} field
 * @returns {[string, string][]} name and text of each fact
 */
export function facts({minimum, maximum, unit, log, odd, equation, source, applies}) {
  /** @type {[string, string][]} */
  const all = [];
  if (Number.isFinite(minimum) && Number.isFinite(maximum)) {
    const kind = `${log ? ', logarithmic' : ''}${odd ? ', odd' : ''}`;
    all.push(['Range', `${written(minimum)} to ${withUnit(maximum, unit)}${kind}`]);
  }
  if (equation) all.push(['Equation', equation.replace(/^Eq\. /, '')]);
  if (source) all.push(['Default', SOURCES[source] ?? source]);
  if (applies) all.push(['Acts in', `${applies} mode`]);
  return all;
}

/** @param {Field} field */
function content(field) {
  const list = element('dl', {});
  for (const [name, text] of facts(field)) {
    list.append(element('dt', {}, name), element('dd', {}, text));
  }
  const title = element('strong', {}, field.symbol && symbol(field.symbol), ` ${field.title}`);
  return [title, field.description && element('p', {}, withIndices(field.description)), list];
}

function hide() {
  clearTimeout(timer);
  shown?.remove();
  shown = null;
}

/**
 * @param {HTMLElement} row
 * @param {Field} field
 */
function show(row, field) {
  hide();
  if (!row.isConnected) return;
  const box = element('div', {class: 'tooltip', popover: 'manual', 'aria-hidden': 'true'});
  for (const part of content(field)) if (part) box.append(part);
  box.addEventListener('pointerenter', () => clearTimeout(timer));
  box.addEventListener('pointerleave', leave);
  document.body.append(box);
  box.showPopover();
  shown = box;
  place(box, row.getBoundingClientRect());
}

/**
 * @param {HTMLElement} box
 * @param {DOMRect} at
 */
function place(box, at) {
  const {width, height} = box.getBoundingClientRect();
  const beside = at.right + GAP + width < innerWidth;
  const above = at.top - height - GAP;
  const stacked = above > 0 ? above : at.bottom + GAP;
  const top = beside ? Math.min(at.top - 6, innerHeight - height - GAP) : stacked;
  box.style.left = `${beside ? at.right + GAP : Math.max(GAP, at.left)}px`;
  box.style.top = `${Math.max(GAP, top)}px`;
}

function leave() {
  clearTimeout(timer);
  timer = setTimeout(hide, LEAVE_MS);
}

/**
 * @param {HTMLElement} row
 * @param {HTMLElement} label what the pointer rests on
 * @param {Field} field
 */
export function attachTooltip(row, label, field) {
  const later = (/** @type {number} */ wait) => {
    clearTimeout(timer);
    // Once one is open its neighbours open at once.
    timer = setTimeout(() => show(row, field), shown ? LEAVE_MS : wait);
  };
  label.addEventListener('pointerenter', ({pointerType}) => {
    if (pointerType === 'mouse') later(HOVER_MS);
  });
  label.addEventListener('pointerleave', leave);
  label.addEventListener('pointerup', ({pointerType}) => {
    if (pointerType !== 'mouse') show(row, field);
  });
  label.addEventListener('click', (event) => {
    // It would open the keyboard of a telephone over what it explains.
    if (/** @type {PointerEvent} */ (event).pointerType === 'touch') event.preventDefault();
  });
  row.addEventListener('focusin', ({target}) => {
    if (/** @type {Element} */ (target).matches(':focus-visible')) later(FOCUS_MS);
  });
  row.addEventListener('focusout', leave);
  row.addEventListener('pointerdown', hide);
}

addEventListener('keydown', ({key}) => { if (key === 'Escape') hide(); });
addEventListener('scroll', hide, true);
