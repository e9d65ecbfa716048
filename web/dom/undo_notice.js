// @ts-check
/** A message whose button undoes what it tells of, while that is the last thing done. */

/**
 * @param {import('./notices.js').Tell} tell
 * @param {import('../api/undo.js').History} history
 * @param {string} text what was done last
 */
export function tellWithUndo(tell, history, text) {
  const action = {label: 'Undo', run: () => { history.undo(); }};
  const takeBack = tell(text, {action});
  // From the next change on the button would undo that one.
  history.addEventListener('change', takeBack, {once: true});
}
