// @ts-check
/** Builds DOM elements; data only ever becomes text or an attribute. */

/**
 * @typedef {string|Node|null|undefined|false} Child
 * @typedef {{[name: string]: any, on?: {[type: string]: (event: any) => void}}} Attributes
 */

/**
 * @template {keyof HTMLElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Attributes} [attributes] `on` holds listeners; true is an empty attribute; null and
 *   false are left out
 * @param {...Child} children
 * @returns {HTMLElementTagNameMap[Tag]}
 */
export function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  const {on = {}, ...rest} = attributes;
  for (const [name, value] of Object.entries(rest)) {
    if (value === null || value === undefined || value === false) continue;
    node.setAttribute(name, value === true ? '' : String(value));
  }
  for (const [type, listener] of Object.entries(on)) node.addEventListener(type, listener);
  for (const child of children) if (child) node.append(child);
  return node;
}

let count = 0;

/**
 * @param {string} stem
 * @returns {string} an id that no other element has
 */
export function freshId(stem) {
  count += 1;
  return `${stem}-${count}`;
}

/**
 * Text with its symbols' indices below the line, such as the p of `k_p`.
 *
 * @param {string} text
 * @returns {HTMLElement}
 */
export function withIndices(text) {
  const parts = text.split(/(?<=\p{L})_(\p{L}+)/u);
  return element('span', {}, ...parts.map((part, at) => (
    at % 2 ? element('sub', {}, part) : part
  )));
}

/**
 * A quantity's symbol: what follows an underscore goes below the line.
 *
 * @param {string} text such as `τ_max`
 * @returns {HTMLElement}
 */
export function symbol(text) {
  const [base, below] = text.split('_');
  return element('i', {class: 'symbol'}, base, below && element('sub', {}, below));
}
