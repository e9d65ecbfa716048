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
  const {background} = themeOf(graph);
  const {clientWidth: width, clientHeight: height} = /** @type {HTMLElement} */ (graph.parentElement);
  const whole = {...layout, paper_bgcolor: background, width, height};
  if (!above) return {data, layout: whole};
  const {l = 0, r = 0, t = 0, b = 0} = (/** @type {any} */ (graph))._fullLayout?._size ?? {};
  const picture = {
    source: above.toDataURL(), layer: 'above', xref: 'paper', yref: 'paper', sizing: 'stretch',
    x: -l / (width - l - r), y: 1 + t / (height - t - b),
    sizex: width / (width - l - r), sizey: height / (height - t - b),
  };
  const empty = data.length ? {} : {
    margin: {l, r, t, b}, xaxis: {visible: false}, yaxis: {visible: false}, plot_bgcolor: background,
  };
  return {data, layout: {...empty, ...whole, images: [picture]}};
}
