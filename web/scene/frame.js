// @ts-check
/** What the page does inside the scene's frame, which is Viser's own page from our own origin. */

/** All but the picture and warnings: Viser's panel has an address and switches that break things. */
const BARE = `body :not(:has(canvas, [role="alert"]), canvas, [role="alert"], [role="alert"] *) {
  display: none !important;
}`;
/** Viser's own button, in the panel that is not seen. */
const HOME = 'reset view';
/** Events that say which keys are held. */
const POINTER = ['pointerdown', 'pointermove', 'pointerup', 'pointerover', 'pointerenter'];

/**
 * Leave nothing but the picture. A browser that is too old for it shows Viser's panel.
 *
 * @param {HTMLIFrameElement} frame loaded
 */
export function bare({contentDocument: inside}) {
  const style = inside?.createElement('style');
  if (!inside || !style) return;
  style.textContent = BARE;
  inside.head.append(style);
}

/**
 * Put the camera back to where it began.
 *
 * @param {HTMLIFrameElement} frame
 */
export function goHome(frame) {
  const buttons = [...frame.contentDocument?.querySelectorAll('button') ?? []];
  const button = buttons.find(({textContent}) => textContent?.trim().toLowerCase() === HOME);
  // A fresh page begins there as well; it only takes longer.
  if (button) button.click();
  else frame.contentWindow?.location.reload();
}

/**
 * Let every pointer count as if Shift were held while `holds` says so: a finger has no keys.
 *
 * @param {HTMLIFrameElement} frame loaded
 * @param {() => boolean} holds
 */
export function holdShift({contentWindow: inside}, holds) {
  const hold = (/** @type {Event} */ event) => {
    if (holds()) Object.defineProperty(event, 'shiftKey', {value: true, enumerable: true});
  };
  for (const type of POINTER) inside?.addEventListener(type, hold, {capture: true});
}
