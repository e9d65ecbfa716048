// @ts-check
/** A box that scrolls says at its edges that there is more beyond them. */

import {element} from './element.js';

/** Less than this in pixels is no more than rounding. */
const ROUNDING = 1;

/**
 * @param {HTMLElement} box that scrolls, around one element
 * @returns {HTMLElement} a frame around the box, with a shadow where it goes on
 */
export function withScrollCue(box) {
  const frame = element('div', {class: 'scroll-frame'}, box);
  const show = () => {
    const {scrollTop, scrollLeft, scrollWidth, scrollHeight, clientWidth, clientHeight} = box;
    frame.classList.toggle('goes-right', scrollLeft + clientWidth < scrollWidth - ROUNDING);
    frame.classList.toggle('goes-down', scrollTop + clientHeight < scrollHeight - ROUNDING);
  };
  box.addEventListener('scroll', show, {passive: true});
  const watch = new ResizeObserver(show);
  watch.observe(box);
  for (const content of box.children) watch.observe(content);
  return frame;
}
