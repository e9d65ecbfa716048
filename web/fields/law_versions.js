// @ts-check
/** Versions of the laws that come from files of one's own: what was worked out depends on them. */

/** @type {Map<string, string>} by the law's name; those that ship have none */
const known = new Map();

/** @param {{name: string, version: string}[]} laws all that there are */
export function noteVersions(laws) {
  known.clear();
  for (const {name, version} of laws) if (version) known.set(name, version);
}

/**
 * @param {string|undefined} law its name
 * @returns {string} '' for a law that ships
 */
export function versionOf(law) { return known.get(law ?? '') ?? ''; }
