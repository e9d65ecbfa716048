// @ts-check
/** The bar at the top: presets, documents, history, status. */

import {editsButton} from './edit_history.js';
import {element} from '../dom/element.js';
import {icon} from '../dom/icons.js';
import {RUNS_ARE_THE_OWNERS, isWatching} from '../api/watch_only.js';
import {exportNumbers} from '../experiment/export_numbers.js';
import {saveReport} from '../experiment/report.js';
import {showKeys} from '../screen/keys.js';
import {openMenu} from '../dom/menu.js';
import {mountStatus} from './status.js';
import {nextTheme, themeButton} from '../screen/theme.js';

/**
 * How experiments come and go.
 * @typedef {{presets: import('../experiment/presets.js').Presets,
 *   links: import('../experiment/link.js').Links, chooseFile: () => void,
 *   tell: import('../dom/notices.js').Tell}} Documents
 */

/**
 * @param {import('../dom/icons.js').IconName} name
 * @param {string} label
 * @param {string} title
 * @param {() => void} run
 */
function tool(name, label, title, run) {
  const button = element('button', {
    class: 'button', type: 'button', title, 'aria-label': label, on: {click: run},
  }, icon(name), element('span', {class: 'button-text'}, label));
  return button;
}

/**
 * @param {HTMLElement} place
 * @param {import('../api/api.js').Api} api
 * @param {import('../api/undo.js').History} history
 * @param {Documents} documents
 */
export function mountHeader(place, api, history, {presets, links, chooseFile, tell}) {
  const brand = element('h1', {class: 'brand'}, element('img', {
    src: '/static/icon.svg', alt: '', width: 20, height: 20,
  }), element('span', {}, 'Slidetune'));
  const documents = element('div', {class: 'tools wide-only', role: 'group', 'aria-label': 'Documents'},
    tool('save', 'Save', 'Save as a preset', () => presets.save()),
    exportButton(api, presets, tell),
    tool('upload', 'Import', 'Import a YAML experiment; dropping or pasting one works too', chooseFile),
    tool('link', 'Link', 'Copy a link to this experiment', () => links.share()));
  const status = element('div', {class: 'status', 'aria-label': 'Session'});
  mountStatus(status, api);
  const keys = element('button', {
    class: 'button icon-only', type: 'button', 'aria-label': 'Keys', title: 'Keys (?)',
    on: {click: showKeys},
  }, icon('keyboard'));
  const openLessons = () => { api.dispatchEvent(new CustomEvent('learn')); };
  const learn = tool('learn', 'Learn', 'Lessons (L)', openLessons);
  const openEdits = () => { api.dispatchEvent(new CustomEvent('edits')); };
  const more = moreButton(api, {presets, links, chooseFile, tell}, openLessons, openEdits);
  const extras = element('div', {class: 'tools wide-only'}, themeButton(), keys);
  place.append(brand, presets.button, documents, historyTools(api, history),
    element('div', {class: 'tools wide-only'}, learn), more,
    element('div', {class: 'spring'}), status, extras);
}

/**
 * @param {import('../api/api.js').Api} api
 * @param {import('../api/undo.js').History} history
 */
function historyTools(api, history) {
  const undo = tool('undo', 'Undo', 'Undo', () => { history.undo(); });
  const redo = tool('redo', 'Redo', 'Redo', () => { history.redo(); });
  for (const button of [undo, redo]) button.classList.add('icon-only');
  const show = () => {
    const {undoLabel, redoLabel} = history;
    undo.disabled = undoLabel === undefined;
    redo.disabled = redoLabel === undefined;
    undo.title = undoLabel ? `Undo: ${undoLabel} (Ctrl Z)` : 'Nothing to undo';
    redo.title = redoLabel ? `Redo: ${redoLabel} (Ctrl Shift Z)` : 'Nothing to redo';
  };
  history.addEventListener('change', show);
  show();
  return element('div', {class: 'tools', role: 'group', 'aria-label': 'History'}, undo, redo,
    element('span', {class: 'wide-only'}, editsButton(api, history)));
}

/**
 * @param {import('../api/api.js').Api} api
 * @param {import('../experiment/presets.js').Presets} presets
 * @param {import('../dom/notices.js').Tell} tell
 */
function exportButton(api, presets, tell) {
  const button = tool('download', 'Export', 'Download the experiment or a report', () => {
    openMenu(button, exports(api, presets, tell));
  });
  button.setAttribute('aria-haspopup', 'menu');
  button.setAttribute('aria-expanded', 'false');
  return button;
}

/**
 * What can be taken away as a file.
 *
 * @param {import('../api/api.js').Api} api
 * @param {import('../experiment/presets.js').Presets} presets
 * @param {import('../dom/notices.js').Tell} tell
 * @returns {import('../dom/menu.js').Item[]}
 */
function exports(api, presets, tell) {
  return [
    {
      label: 'Experiment (YAML)', icon: 'download', run: () => presets.export(),
      hint: 'All numbers with units and equations; drop it here to open it',
    },
    {
      label: 'Report (HTML)', icon: 'download', run: () => saveReport(api, tell),
      disabled: isWatching(),
      hint: isWatching() ? RUNS_ARE_THE_OWNERS
        : 'One file with figures, plots, a 3D replay and how to repeat it; opens anywhere',
    },
    {
      label: 'Numbers (CSV, Parquet, MCAP)…', icon: 'download', run: () => exportNumbers(api),
      disabled: isWatching(),
      hint: isWatching() ? RUNS_ARE_THE_OWNERS : 'Of the live session with every edit, or of a whole run',
    },
  ];
}

/**
 * @param {import('../api/api.js').Api} api
 * @param {Documents} documents
 * @param {() => void} openLessons
 * @param {() => void} openEdits
 */
function moreButton(api, {presets, links, chooseFile, tell}, openLessons, openEdits) {
  const button = element('button', {
    class: 'button icon-only narrow-only', type: 'button', 'aria-label': 'More',
    'aria-haspopup': 'menu',
    on: {click: () => openMenu(button, [
      {label: 'Save as preset…', icon: 'save', run: () => presets.save()},
      ...exports(api, presets, tell),
      {label: 'Import…', icon: 'upload', run: chooseFile},
      {label: 'Copy a link', icon: 'link', run: () => links.share()},
      {label: 'Lessons', icon: 'learn', run: openLessons},
      {label: 'Edits of this session', icon: 'clock', run: openEdits},
      'separator',
      {label: 'Light, dark or system theme', icon: 'moon', run: nextTheme},
      {label: 'Keys', icon: 'keyboard', run: showKeys},
    ])},
  }, icon('more'));
  return button;
}
