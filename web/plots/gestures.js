// @ts-check
/** Presses, double presses and swipes on the plots that the plotting library doesn't report. */

const DOUBLE_MS = 400;
const DOUBLE_PIXELS = 10;

/** Watches one graph inside a stage that may scroll. */
export class PlotGestures {
  /** A drag would break off if its plot were redrawn meanwhile. */
  pressed = false;
  /** Whether the finger that is down, or was last, moves mostly up or down: that scrolls. */
  vertical = false;

  #stage;
  #on;
  #presses = 0;
  #press = {time: -Infinity, x: 0, y: 0};
  #finger = {startX: 0, startY: 0, y: 0};

  /**
   * @param {HTMLElement} graph
   * @param {HTMLElement} stage
   * @param {{released: () => void, doubled: () => void}} on
   */
  constructor(graph, stage, on) {
    this.#stage = stage;
    this.#on = on;
    graph.addEventListener('pointerdown', (event) => this.#pressedAt(event), true);
    for (const type of ['pointerup', 'pointercancel', 'blur']) {
      addEventListener(type, () => this.#released());
    }
    const passive = {capture: true, passive: true};
    graph.addEventListener('touchstart', ({touches}) => this.#touched(touches[0]), passive);
    // Once a finger is down the library covers the page and prevents scrolling.
    addEventListener('touchmove', ({touches}) => this.#swiped(touches[0]), passive);
  }

  /** @param {PointerEvent} event */
  #pressedAt({timeStamp, clientX, clientY}) {
    const last = this.#press;
    const again = timeStamp - last.time < DOUBLE_MS
      && Math.hypot(clientX - last.x, clientY - last.y) < DOUBLE_PIXELS;
    this.#presses = again ? this.#presses + 1 : 1;
    this.#press = {time: timeStamp, x: clientX, y: clientY};
    this.pressed = true;
    this.vertical = false;
  }

  #released() {
    if (!this.pressed) return;
    // The library reports a zoom within this same turn. It covers the page while a button is
    // down, so that no double click arrives by itself.
    setTimeout(() => {
      this.pressed = false;
      if (this.#presses >= 2) this.#on.doubled();
      this.#on.released();
    });
  }

  /** @param {Touch} touch */
  #touched({clientX, clientY}) {
    this.#finger = {startX: clientX, startY: clientY, y: clientY};
  }

  /** @param {Touch} touch */
  #swiped({clientX, clientY}) {
    if (!this.pressed) return;
    const {startX, startY, y} = this.#finger;
    this.vertical = Math.abs(clientY - startY) > Math.abs(clientX - startX);
    if (this.vertical) this.#stage.scrollTop += y - clientY;
    this.#finger.y = clientY;
  }
}
