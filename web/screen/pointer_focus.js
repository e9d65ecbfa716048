// @ts-check
/**
 * What is pressed with the pointer takes no focus, so that the space bar goes on to pause.
 * From the keyboard everything is reached as ever.
 */

const PRESSED = 'button, summary, .switch, .segments label, .lane-pick, .scene-ghosts';

/** Keep the focus where keys are meant for the page. */
export function keepFocusOffPressed() {
  addEventListener('mousedown', (event) => {
    const target = /** @type {Element} */ (event.target);
    if (!target.closest(PRESSED) || target.closest('dialog, [popover]')) return;
    event.preventDefault();
    // What is being typed elsewhere counts as finished, as it would by leaving its box.
    if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
  });
}
