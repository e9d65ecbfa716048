// @ts-check
/**
 * YAML in: picked, dropped on the page or pasted; links, arms and logs of a real arm as well. What is refused
 * changes nothing.
 */

import {droppedFiles, mayBeArm} from '../arms/dropped.js';
import {isRecording} from '../own_data/own_data.js';
import {element} from '../dom/element.js';
import {isTyping} from '../screen/keys.js';
import {tellWithUndo} from '../dom/undo_notice.js';
import {isLink} from './link.js';
import {showRefusal} from './refusal.js';

/** @typedef {import('../api/api.js').ApiError} ApiError */

const KIBIBYTE = 1024;
const LOOKS_LIKE_ONE = /^\s*("?)(slidetune|title|lanes|robot|trajectory)\1\s*:/m;

/**
 * @param {import('../api/api.js').Api} api
 * @param {import('../api/undo.js').History} history
 * @param {import('../dom/notices.js').Tell} tell
 * @param {{arms: import('../arms/arms.js').Arms,
 *   ownData: import('../own_data/own_data.js').OwnData, links: import('./link.js').Links}} others
 *   take what is no experiment
 * @returns {() => void} opens the file picker
 */
export function mountImport(api, history, tell, {arms, ownData, links}) {
  const take = async (/** @type {string} */ name, /** @type {string} */ text) => {
    try {
      await history.replace(`import of ${name}`, () => api.replaceExperiment(text));
      tellWithUndo(tell, history, `Imported ${name}.`);
    } catch (error) {
      showRefusal('Not imported', name, /** @type {ApiError} */ (error));
    }
  };
  const takeFile = async (/** @type {File|undefined} */ file) => {
    if (!file) return;
    if (isRecording(file)) {
      ownData.take(file);
      return;
    }
    try {
      // Before it is read: it may be a film.
      const {body_bytes: most} = await api.limits();
      if (file.size > most) throw new Error(`it is larger than ${most / KIBIBYTE} KiB.`);
      await take(file.name, await file.text());
    } catch (error) {
      const {message} = /** @type {Error} */ (error);
      tell(`${file.name} was not imported: ${message}`, {error: true});
    }
  };
  mountDrop(async (transfer) => {
    if (mayBeArm(transfer)) arms.bring(await droppedFiles(transfer));
    else await takeFile(transfer.files[0]);
  });
  addEventListener('paste', (event) => {
    const text = event.clipboardData?.getData('text/plain') ?? '';
    if (isTyping(event.target) || document.querySelector('dialog[open]')) return;
    if (isLink(text)) links.open(text);
    else if (LOOKS_LIKE_ONE.test(text)) take('the clipboard’s text', text);
  });
  return () => {
    const picker = element('input', {
      type: 'file', accept: '.yaml,.yml,.json,application/yaml,application/json,.csv,.mcap',
      on: {change: () => takeFile(picker.files?.[0])},
    });
    picker.click();
  };
}

/** @param {(transfer: DataTransfer) => void} take */
function mountDrop(take) {
  const veil = element('div', {class: 'drop-veil', hidden: true},
    element('p', {}, 'Drop a YAML experiment; an arm: its URDF, a ZIP or a folder; or a log of the real arm: CSV or MCAP'));
  document.body.append(veil);
  const carriesFile = (/** @type {DragEvent} */ event) => event.dataTransfer?.types.includes('Files');
  addEventListener('dragenter', (event) => { if (carriesFile(event)) veil.hidden = false; });
  addEventListener('dragover', (event) => { if (carriesFile(event)) event.preventDefault(); });
  // The veil covers the page, so that leaving it is leaving the window.
  veil.addEventListener('dragleave', () => { veil.hidden = true; });
  addEventListener('drop', (event) => {
    veil.hidden = true;
    if (!carriesFile(event)) return;
    event.preventDefault();
    if (event.dataTransfer) take(event.dataTransfer);
  });
}
