// @ts-check
/** A button over a plot, to save it as a picture. */

import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {openMenu} from '../dom/menu.js';
import {fileName} from '../dom/save_file.js';
import {themeOf} from '../plots/figure.js';
import {download, image} from './download.js';

/** Longer names are cut: a label may be a whole sentence. */
const LONGEST_NAME = 60;
const TITLE_SIZE = 12;
const LINE = 16;

/** @typedef {{data: object[], layout: any}} Figure */

/**
 * @param {HTMLElement} graph whose label becomes the name of the file
 * @param {HTMLCanvasElement} [above] what is drawn over it by hand, as large as it is; all that there
 *   is where the plotting library has drawn nothing
 * @returns {HTMLButtonElement} to stand in the place that the plot has for itself
 */
export function saveImageButton(graph, above) {
  const button = element('button', {
    type: 'button', class: 'plot-save', 'aria-haspopup': 'menu', 'aria-expanded': 'false',
    'aria-label': 'Save this plot', title: 'Save this plot as PNG or SVG',
  }, icon('download'));
  const save = async (/** @type {'png'|'svg'} */ format) => {
    const label = graph.getAttribute('aria-label') ?? '';
    const name = fileName(label).slice(0, LONGEST_NAME) || 'plot';
    download(await image(figureOf(graph, above), format), `slidetune-${name}.${format}`);
  };
  for (const type of ['pointerdown', 'pointermove']) {
    button.addEventListener(type, (event) => event.stopPropagation());
  }
  button.addEventListener('click', (event) => {
    event.stopPropagation();
    openMenu(button, [
      {label: 'PNG image', run: () => { save('png'); }},
      {label: 'SVG image', run: () => { save('svg'); }},
    ]);
  });
  return button;
}

/**
 * @param {HTMLElement} graph
 * @param {HTMLCanvasElement} [above]
 * @returns {Figure} what is seen, on a ground of its own
 */
function figureOf(graph, above) {
  const {data = [], layout = {}} = /** @type {any} */ (graph);
  const {background, text} = themeOf(graph);
  const {clientWidth: width, clientHeight: height} = /** @type {HTMLElement} */ (graph.parentElement);
  const {l = 0, r = 0, t = 0, b = 0} = (/** @type {any} */ (graph))._fullLayout?._size ?? {};
  const lines = broken(graph.getAttribute('aria-label') ?? '', width);
  const head = lines.length * LINE + 8;
  const whole = {
    ...layout, paper_bgcolor: background, width, height: height + head,
    margin: {l, r, b, t: t + head},
    // On the page this is said around the plot.
    title: {
      text: lines.join('<br>'), font: {size: TITLE_SIZE, color: text},
      x: 0, xref: 'paper', xanchor: 'left', y: 1, yref: 'container', yanchor: 'top', pad: {t: 6},
    },
  };
  if (!above) return {data, layout: whole};
  const picture = {
    source: above.toDataURL(), layer: 'above', xref: 'paper', yref: 'paper', sizing: 'stretch',
    x: -l / (width - l - r), y: 1 + t / (height - t - b),
    sizex: width / (width - l - r), sizey: height / (height - t - b),
  };
  const empty = data.length ? {} : {
    xaxis: {visible: false}, yaxis: {visible: false}, plot_bgcolor: background,
  };
  return {data, layout: {...empty, ...whole, images: [picture]}};
}

/**
 * @param {string} label
 * @param {number} width in pixels
 * @returns {string[]} lines no longer than that, for the plotting library, which reads a little markup
 */
function broken(label, width) {
  const most = Math.max(20, Math.floor(width / (0.55 * TITLE_SIZE)));
  /** @type {string[]} */ const lines = [];
  for (const word of label.split(' ')) {
    const last = lines.at(-1);
    if (last !== undefined && last.length + word.length < most) lines[lines.length - 1] = `${last} ${word}`;
    else lines.push(word);
  }
  return lines.map((line) => line.replaceAll('&', '&amp;').replaceAll('<', '&lt;'));
}
