// @ts-check
/** Since when the live figures of a lane count, in words. */

/** @typedef {{time: number, reason: 'reset'|'change'|'added'|'branch'}} Since */
/** @typedef {'total'|'recent'} Span */

const WORDS = {reset: 'reset', change: 'last change', added: 'new lane', branch: 'branch'};
const MEANINGS = {
  reset: 'since the session was reset or loaded',
  change: 'since this lane’s law or gains, or what all lanes share, changed last: the dotted line '
    + 'at this time in the live plots. Renaming does not count',
  added: 'since this lane was added; where it continues another one, it counts from then on',
  branch: 'since the session went back to this moment',
};

/**
 * @param {Since|null} since
 * @param {Span} span
 * @returns {{text: string, title: string}} such as `since 12.3 s (last change)`
 */
export function sinceWords(since, span) {
  if (!since) return {text: '', title: ''};
  if (span === 'recent') return {
    text: 'last 10 s', title: 'The last ten seconds, whatever changed in them.',
  };
  const {time, reason} = since;
  const when = `${time.toFixed(1)} s`;
  const text = `since ${time === 0 ? WORDS[reason] : `${when} (${WORDS[reason]})`}`;
  return {text, title: `From t = ${when}: ${MEANINGS[reason]}.`};
}
