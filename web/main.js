// @ts-check
/** Puts the screen together and opens the line to the server. */

import {Api} from './api/api.js';
import {Arms} from './arms/arms.js';
import {beginAnewForAnother} from './api/arm.js';
import {mount as mountControls} from './experiment/panel.js';
import {mountHeader} from './page/header.js';
import {History} from './api/undo.js';
import {Links} from './experiment/link.js';
import {Logs} from './logs/logs.js';
import {mountImport} from './experiment/import_experiment.js';
import {keyHandler} from './screen/keys.js';
import {mount as mountLessons} from './lessons/lessons.js';
import {mount as mountMetrics} from './figures/table.js';
import {mountNotices} from './dom/notices.js';
import {keepFocusOffPressed} from './screen/pointer_focus.js';
import {OwnData} from './own_data/own_data.js';
import {Presets} from './experiment/presets.js';
import {Preview} from './api/preview.js';
import {ResponseBefore} from './response/before.js';
import {mount as mountRightPanel} from './page/right_panel.js';
import {mount as mountScene} from './scene/scene.js';
import {mountScrub} from './scene/scrub.js';
import {mountSkipLinks} from './screen/skip_links.js';
import {mountSplitters} from './screen/splitters.js';
import {mountBanner} from './page/status.js';
import {mountTabs} from './screen/tabs.js';
import {applyTheme} from './screen/theme.js';
import {mount as mountTransport} from './page/transport.js';
import {mountTuningStrip} from './tuning_strip/tuning_strip.js';
import {mountWatchOnly} from './api/watch_only.js';

/** @param {string} id */
function part(id) { return /** @type {HTMLElement} */ (document.getElementById(id)); }

applyTheme();
const api = new Api();
beginAnewForAnother(api);
const history = new History(api);
const preview = new Preview(api);
const before = new ResponseBefore(api, preview);
const tell = mountNotices(part('notices'));
const links = new Links(api, history, tell);
const presets = new Presets(api, history, tell);
const arms = new Arms(api, history, tell);
const logs = new Logs(api);
const ownData = new OwnData(api, {history, tell, logs});
const pressed = keyHandler(api, history);
const parts = {tune: part('tune'), plots: part('plots'), metrics: part('metrics')};

mountSkipLinks(part('skip'), part('workspace'));
mountHeader(part('header'), api, history, {
  presets, links, tell, chooseFile: mountImport(api, history, tell, {arms, ownData, links}),
});
mountBanner(part('banner'), api);
mountControls(parts.tune, api, history, tell, preview, arms);
mountScene(part('scene'), api, pressed);
mountTransport(part('transport'), api);
mountScrub(part('transport'), api, history, tell);
mountRightPanel(parts.plots, api, {preview, before, logs, history, presets, tell});
mountMetrics(parts.metrics, api);
mountTuningStrip(part('workspace'), api, preview, before);
mountTabs(part('tabs'), part('workspace'), api);
mountLessons(part('workspace'), api, history, tell);
mountSplitters(part('workspace'), parts);
mountWatchOnly(api, ['header', 'tune', 'scene', 'transport'].map(part));

addEventListener('keydown', pressed);
keepFocusOffPressed();
api.addEventListener('notice', (event) => tell(/** @type {CustomEvent} */ (event).detail.message));
history.addEventListener('refused', (event) => {
  const {message} = /** @type {CustomEvent} */ (event).detail;
  tell(`No longer possible: ${message}`, {error: true});
});
api.connect();
