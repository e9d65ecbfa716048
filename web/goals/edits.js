// @ts-check
/** Changes of the experiment's goals: each can be undone, and a movement is one change. */

/** @typedef {import('./words.js').Goal} Goal */
/** @typedef {{[name in keyof Goal]?: Goal[name]|null}} GoalPatch null: as it is by default */

/** What a hand moves is ahead of the server. */
export class GoalEdits {
  #api;
  #history;
  /** @type {{name: string, goal: Goal}|null} */ #held = null;

  /**
   * @param {import('../api/api.js').Api} api
   * @param {import('../api/undo.js').History} history
   */
  constructor(api, history) {
    this.#api = api;
    this.#history = history;
  }

  /** @returns {{[name: string]: Goal}} as the hand has them */
  get all() {
    const goals = this.#api.experiment?.goals ?? {};
    const held = this.#held;
    return held && held.name in goals ? {...goals, [held.name]: held.goal} : goals;
  }

  /** Name of the goal that a hand moves, or ''. */
  get held() { return this.#held?.name ?? ''; }

  /**
   * @param {Goal} goal
   * @param {string} label of the edit
   * @returns {Promise<string>} why it was refused, or ''
   */
  add(goal, label) { return this.change(freeName(this.all), goal, label); }

  /**
   * @param {string} name
   * @param {GoalPatch|null} change null: remove it
   * @param {string} label of the edit
   * @returns {Promise<string>} why it was refused, or ''
   */
  async change(name, change, label) {
    try {
      await this.#history.change({goals: {[name]: change}}, label);
      return '';
    } catch (error) {
      return /** @type {Error} */ (error).message;
    }
  }

  /**
   * One value of a movement that goes on.
   *
   * @param {string} name
   * @param {GoalPatch} change
   */
  move(name, change) {
    const goal = this.all[name];
    if (!goal) return;
    const moved = Object.entries({...goal, ...change}).filter(([, value]) => value !== null);
    this.#held = {name, goal: /** @type {Goal} */ (Object.fromEntries(moved))};
    this.#history.move({goals: {[name]: change}}, `move ${name}`);
  }

  /** End the movement: it becomes one edit. */
  end() { return this.#leave(this.#history.commit()); }

  /** Give the movement up: the goal is as before. */
  cancel() { return this.#leave(this.#history.cancel()); }

  /**
   * Call back when something else than this hand changes a goal, or undoes.
   *
   * @param {string} name
   * @param {() => void} interrupt
   * @returns {() => void} ends that
   */
  watch(name, interrupt) {
    const watched = new AbortController();
    const {signal} = watched;
    this.#api.addEventListener('patch', (event) => {
      const {author, patch} = /** @type {CustomEvent} */ (event).detail;
      if (author !== this.#api.client && patch.goals?.[name] !== undefined) interrupt();
    }, {signal});
    this.#api.addEventListener('hello', interrupt, {signal});
    this.#history.addEventListener('interrupt', interrupt, {signal});
    return () => watched.abort();
  }

  /** @param {Promise<void>} answered */
  async #leave(answered) {
    const held = this.#held;
    await answered;
    // Someone may have taken hold again while the server was answering.
    if (this.#held === held) this.#held = null;
  }
}

/**
 * The least name of the form `goal 3` that isn't taken.
 *
 * @param {{[name: string]: Goal}} goals
 */
function freeName(goals) {
  let number = 1;
  while (`goal ${number}` in goals) number += 1;
  return `goal ${number}`;
}
