// @ts-check
/** Line icons on a grid of 16. */

const SHAPES = {
  play: 'M5 3.2v9.6l7.5-4.8z',
  pause: 'M5 3.5v9M11 3.5v9',
  step: 'M4 3.5v9l6-4.5zM12.2 3.5v9',
  reset: 'M3.2 8a4.8 4.8 0 1 0 1.6-3.6M3 2.5v3h3',
  kick: 'M9 1.8 3.8 9H8l-1 5.2L12.2 7H8z',
  undo: 'M5.5 3 2.8 5.7l2.7 2.7M3 5.7h6.2a3.6 3.6 0 0 1 0 7.2H6',
  redo: 'M10.5 3l2.7 2.7-2.7 2.7M13 5.7H6.8a3.6 3.6 0 0 0 0 7.2H10',
  save: 'M3 3h8l2 2v8H3zM5.5 3v3.2h4.5V3M5.5 13V9.5h5V13',
  download: 'M8 2.5v7.2M5 7l3 3 3-3M3 12.8h10',
  upload: 'M8 10V2.8M5 5.6l3-3 3 3M3 12.8h10',
  more: 'M3.5 8h.01M8 8h.01M12.5 8h.01',
  plus: 'M8 3.2v9.6M3.2 8h9.6',
  close: 'M4 4l8 8M12 4l-8 8',
  chevron: 'M6 4l4 4-4 4',
  down: 'M4 6l4 4 4-4',
  check: 'M3.2 8.4l3 3 6.6-6.8',
  sun: 'M8 5.2a2.8 2.8 0 1 0 0 5.6 2.8 2.8 0 0 0 0-5.6M8 1.5v1.3M8 13.2v1.3M1.5 8h1.3M13.2 8h1.3'
    + 'M3.4 3.4l.9.9M11.7 11.7l.9.9M3.4 12.6l.9-.9M11.7 4.3l.9-.9',
  moon: 'M12.9 9.6A5.4 5.4 0 1 1 6.4 3.1a4.3 4.3 0 0 0 6.5 6.5z',
  auto: 'M8 2.4a5.6 5.6 0 1 0 0 11.2 5.6 5.6 0 0 0 0-11.2M8 2.4v11.2',
  keyboard: 'M2 4.5h12v7H2zM4.5 7h.01M7 7h.01M9.5 7h.01M11.7 7h.01M5 9.4h6',
  warning: 'M8 2.6 1.9 13h12.2zM8 6.6v3M8 11.4h.01',
  trash: 'M3 4.5h10M6.2 4.5V3h3.6v1.5M4.4 4.5l.6 8.5h6l.6-8.5',
  tune: 'M3 4.5h5M11 4.5h2M9.5 3v3M3 11.5h2M8 11.5h5M6.5 10v3',
  cube: 'M8 2l5.2 3v6L8 14l-5.2-3V5zM2.8 5 8 8l5.2-3M8 8v6',
  plots: 'M2.5 13.2h11M3 10l3-4 2.6 2.4L13 3.2',
  learn: 'M1.6 6.1 8 3.2l6.4 2.9L8 9zM4.3 7.4v3.2c1 .9 2.2 1.4 3.7 1.4s2.7-.5 3.7-1.4V7.4M14.4 6.1v3.7',
  cursors: 'M5 2.5v11M11 2.5v11M2.5 8h2.5M11 8h2.5',
  pin: 'M6 2.5h4l-.5 4.2 2 2.3h-7l2-2.3zM8 9v4.5',
  clock: 'M8 2.4a5.6 5.6 0 1 0 0 11.2 5.6 5.6 0 0 0 0-11.2M8 5v3.2l2.2 1.4',
  info: 'M8 2.4a5.6 5.6 0 1 0 0 11.2 5.6 5.6 0 0 0 0-11.2M8 7.4v3.4M8 5.2h.01',
  rewind: 'M7.6 4 3 8l4.6 4zM13 4 8.4 8l4.6 4z',
  fork: 'M4.5 2.8v10.4M4.5 9.6c0-2.6 6.6-1.6 6.6-5.6M9 5.4 11.1 3l2.1 2.4',
  home: 'M2.5 7.6 8 2.8l5.5 4.8M4 6.6v6.6h8V6.6M6.6 13.2V9.4h2.8v3.8',
  bound: 'M2 4h2.4M6.8 4h2.4M11.6 4H14M2 12h2.4M6.8 12h2.4M11.6 12H14M2 9c2-4 4 2.4 6-.8s4-1.4 6 .2',
  target: 'M8 2.4a5.6 5.6 0 1 0 0 11.2 5.6 5.6 0 0 0 0-11.2M8 5.6a2.4 2.4 0 1 0 0 4.8 2.4 2.4 0 0 0 0-4.8',
  link: 'M6.6 9.4 9.4 6.6M7.4 4.6l1.3-1.3a2.8 2.8 0 0 1 4 4L11.4 8.6M8.6 11.4l-1.3 1.3a2.8 2.8 0 0 1-4-4L4.6 7.4',
  table: 'M2.5 3.5h11v9h-11zM2.5 6.6h11M6.3 6.6v5.9',
};

/** @typedef {keyof typeof SHAPES} IconName */

/**
 * @param {IconName} name
 * @returns {SVGSVGElement}
 */
export function icon(name) {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', '0 0 16 16');
  svg.setAttribute('class', `icon icon-${name}`);
  svg.setAttribute('aria-hidden', 'true');
  const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
  path.setAttribute('d', SHAPES[name]);
  svg.append(path);
  return svg;
}
