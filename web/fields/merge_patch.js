// @ts-check
/**
 * JSON Merge Patch (RFC 7396) as values: joining, applying, and turning one round for undo.
 *
 * @typedef {{[key: string]: any}} Document
 */

/**
 * @param {any} value
 * @returns {value is Document}
 */
export function isObject(value) {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

/**
 * Whether two JSON values say the same, whatever the order of their keys.
 *
 * @param {any} a
 * @param {any} b
 * @returns {boolean}
 */
export function same(a, b) {
  if (Object.is(a, b)) return true;
  if (Array.isArray(a) || Array.isArray(b)) {
    return Array.isArray(a) && Array.isArray(b) && a.length === b.length
      && a.every((item, index) => same(item, b[index]));
  }
  if (!isObject(a) || !isObject(b)) return false;
  const keys = Object.keys(a);
  return keys.length === Object.keys(b).length
    && keys.every((key) => Object.hasOwn(b, key) && same(a[key], b[key]));
}

/**
 * One patch that does what `first` and then `second` do; the last value wins.
 *
 * @param {Document} first
 * @param {Document} second
 * @returns {Document}
 */
export function joined(first, second) {
  const result = {...first};
  for (const [key, value] of Object.entries(second)) {
    result[key] = isObject(value) && isObject(result[key]) ? joined(result[key], value) : value;
  }
  return result;
}

/**
 * The patch that sets one value.
 *
 * @param {readonly (string|number)[]} path
 * @param {any} value
 * @returns {Document}
 */
export function patchAt(path, value) {
  return path.reduceRight((inner, key) => ({[key]: inner}), value);
}

/**
 * The value at a path, or undefined.
 *
 * @param {any} document
 * @param {readonly (string|number)[]} path
 * @returns {any}
 */
export function valueAt(document, path) {
  return path.reduce((inner, key) => inner?.[key], document);
}

/**
 * The patch that leads from one document to another.
 *
 * @param {Document} from
 * @param {Document} to
 * @returns {Document}
 */
export function difference(from, to) {
  /** @type {Document} */
  const patch = {};
  for (const key of Object.keys(from)) if (!Object.hasOwn(to, key)) patch[key] = null;
  for (const [key, value] of Object.entries(to)) {
    if (same(from[key], value)) continue;
    const nested = isObject(value) && isObject(from[key]);
    patch[key] = nested ? difference(from[key], value) : value;
  }
  return patch;
}

/**
 * The patch that takes `patch` back: from the document `after` it to the one `before` it.
 *
 * Only what the patch touched is touched, so that edits of other people stay. A change of
 * variant (a lane's law, a trajectory's kind) drops fields that the patch doesn't name; there
 * the whole variant is compared.
 *
 * @param {Document} before
 * @param {Document} after
 * @param {Document} patch
 * @returns {Document}
 */
export function inverse(before, after, patch) {
  /** @type {Document} */
  const back = {};
  for (const [key, value] of Object.entries(patch)) {
    if (same(before[key], after[key])) continue;
    if (!isObject(value) || !isObject(before[key]) || !isObject(after[key])) {
      back[key] = Object.hasOwn(before, key) ? before[key] : null;
    } else if ('law' in value || 'kind' in value) {
      back[key] = difference(after[key], before[key]);
    } else {
      back[key] = inverse(before[key], after[key], value);
    }
  }
  return back;
}

/**
 * Paths of the values that a patch sets.
 *
 * @param {Document} patch
 * @param {string[]} [above]
 * @returns {string[][]}
 */
export function leaves(patch, above = []) {
  return Object.entries(patch).flatMap(([key, value]) => (
    isObject(value) ? leaves(value, [...above, key]) : [[...above, key]]
  ));
}
