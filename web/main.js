// @ts-check
/** Puts the screen together and opens the line to the server. */

import {Api} from './api.js';
import {mount as mountControls} from './controls.js';
import {mountHeader} from './header.js';
import {History} from './history.js';
import {mountImport} from './import_experiment.js';
import {keyHandler} from './keys.js';
import {mount as mountLessons} from './lessons.js';
import {mount as mountMetrics} from './metrics.js';
import {mountNotices} from './notices.js';
import {keepFocusOffPressed} from './pointer_focus.js';
import {Presets} from './presets.js';
import {Preview} from './preview.js';
import {ResponseBefore} from './response_before.js';
import {mount as mountRightPanel} from './right_panel.js';
import {mount as mountScene} from './scene.js';
import {mountScrub} from './scrub.js';
import {mountSkipLinks} from './skip_links.js';
import {mountSplitters} from './splitters.js';
import {mountBanner} from './status.js';
import {mountTabs} from './tabs.js';
import {applyTheme} from './theme.js';
import {mount as mountTransport} from './transport.js';
import {mountTuningStrip} from './tuning_strip.js';
import {mountWatchOnly} from './watch_only.js';

/** @param {string} id */
function part(id) { return /** @type {HTMLElement} */ (document.getElementById(id)); }

applyTheme();
const api = new Api();
const history = new History(api);
const preview = new Preview(api);
const before = new ResponseBefore(api, preview);
const tell = mountNotices(part('notices'));
const presets = new Presets(api, history, tell);
const pressed = keyHandler(api, history);
const parts = {tune: part('tune'), plots: part('plots'), metrics: part('metrics')};

mountSkipLinks(part('skip'), part('workspace'));
mountHeader(part('header'), api, history, presets, mountImport(api, history, tell));
mountBanner(part('banner'), api);
mountControls(parts.tune, api, history, tell);
mountScene(part('scene'), api, pressed);
mountTransport(part('transport'), api);
mountScrub(part('transport'), api, history, tell);
mountRightPanel(parts.plots, api, {preview, before, history, presets, tell});
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
  tell(`Not possible any more: ${message}`, {error: true});
});
api.connect();
