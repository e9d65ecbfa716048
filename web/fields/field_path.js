// @ts-check
/** How the server writes a place in an experiment: lanes.NFTSM.nu, lanes."nu 0.5".nu. */

/**
 * @param {readonly string[]} parts keys from the top down
 * @returns {string} dotted; a key with a dot or a quote in it, or none at all, stands in quotes
 */
export function fieldPath(parts) {
  return parts.map((part) => (/[."]|^$/.test(part) ? JSON.stringify(part) : part)).join('.');
}
