// @ts-check
/** A mark on the slider of ε: where the selected lane stops chattering. */

import {element} from '../dom/element.js';
import {fieldPath} from '../fields/field_path.js';
import {fraction, written} from '../fields/quantity.js';

/** @typedef {import('../fields/schema.js').Field} Field */
/**
 * Boundary layers in [rad/s] from which on a lane is silent: one for all joints, or one for each.
 * @typedef {{lane: string, threshold: number|null, joints: (number|null)[]}} Silence
 */

/**
 * @param {HTMLElement} place holds the controls of the selected lane
 * @param {import('../api/api.js').Api} api tells of it by its event `silence`
 * @param {(path: string) => Field|undefined} fieldAt by its dotted path
 */
export function mountSilenceMark(place, api, fieldAt) {
  /** @type {Silence|null} */ let silence = null;
  const note = element('p', {class: 'silence-note'});
  const show = () => {
    const path = fieldPath(['lanes', api.selected, 'epsilon']);
    const control = place.querySelector(`.control[data-path="${CSS.escape(path)}"]`);
    const field = fieldAt(path);
    const mine = silence && silence.lane === api.selected ? silence : null;
    if (!control || !field) { note.remove(); return; }
    const each = Array.isArray(api.experiment.lanes?.[api.selected]?.epsilon);
    const sliders = /** @type {NodeListOf<HTMLInputElement>} */ (control.querySelectorAll('.slider'));
    for (const slider of sliders) {
      const joint = Number(slider.closest('.joint-row')?.getAttribute('data-joint') ?? 0);
      const value = joint ? mine?.joints[joint - 1] : each ? null : mine?.threshold;
      slider.classList.toggle('is-silence-marked', Boolean(value));
      if (value) slider.style.setProperty('--silence', String(fraction(value, field)));
    }
    const threshold = mine?.threshold ?? null;
    const wanted = threshold === null ? ''
      : each ? 'Marks: each joint is silent right of its own.'
        : `Silent from ε* = ${written(Number(threshold.toPrecision(3)))} ${field.unit} on (mark).`;
    if (note.textContent !== wanted) note.textContent = wanted;
    if (!wanted) note.remove();
    else if (note.parentElement !== control) control.append(note);
  };
  api.addEventListener('silence', (event) => {
    silence = /** @type {CustomEvent} */ (event).detail;
    show();
  });
  for (const type of ['select', 'hello', 'patch']) api.addEventListener(type, show);
}
