// @ts-check
/** What this browser remembers of the screen: open sections, column widths, the theme. */

const PREFIX = 'slidetune.';

/**
 * @param {string} key
 * @returns {string|null}
 */
export function recall(key) {
  try {
    return localStorage.getItem(PREFIX + key);
  } catch {
    // Storage may be switched off; the screen works without.
    return null;
  }
}

/**
 * @param {string} key
 * @param {string|null} value null forgets
 */
export function remember(key, value) {
  try {
    if (value === null) localStorage.removeItem(PREFIX + key);
    else localStorage.setItem(PREFIX + key, value);
  } catch {
    // See above.
  }
}

/**
 * Learn of what another page of this browser remembers or forgets.
 *
 * @param {string} key
 * @param {() => void} act
 */
export function onRemembered(key, act) {
  // Without a key all was forgotten at once.
  addEventListener('storage', (event) => {
    if (event.key === null || event.key === PREFIX + key) act();
  });
}

/**
 * A section that stays as its reader left it.
 *
 * @param {HTMLDetailsElement} details
 * @param {string} key
 * @param {boolean} open at first
 */
export function rememberOpen(details, key, open) {
  const last = recall(`open.${key}`);
  details.open = last === null ? open : last === '1';
  details.addEventListener('toggle', () => remember(`open.${key}`, details.open ? '1' : '0'));
}
