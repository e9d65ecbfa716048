// @ts-check
/** A WebSocket that comes back by itself. */

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 10_000;
/** The server speaks five times a second; this much silence is a dead line. */
const SILENCE_MS = 10_000;
const REASONS = new Map([
  [1008, 'The server refused the connection.'],
  [1013, 'The server has reached its limit of open pages.'],
]);

/**
 * @typedef {{message: (message: any) => void, bytes: (bytes: ArrayBuffer) => void,
 *   change: (detail: {open: boolean, reason?: string, wait?: number}) => void}} Listener
 */

/** One line to the server; re-opens with growing waits and says so. */
export class Connection {
  #path;
  #listener;
  /** @type {WebSocket|null} */ #socket = null;
  #wait = FIRST_WAIT_MS;
  /** @type {ReturnType<typeof setTimeout>|undefined} */ #timer;
  #heard = 0;

  /**
   * @param {string} path
   * @param {Listener} listener
   */
  constructor(path, listener) {
    this.#path = path;
    this.#listener = listener;
  }

  open() {
    addEventListener('online', () => this.retry());
    // Out of sight a browser lets timers wait for a minute.
    document.addEventListener('visibilitychange', () => { if (!document.hidden) this.retry(); });
    document.addEventListener('resume', () => this.retry());
    setInterval(() => this.#watch(), SILENCE_MS / 4);
    this.#connect();
  }

  /** Try at once, unless the line is up. */
  retry() {
    if (this.#socket) return;
    clearTimeout(this.#timer);
    this.#connect();
  }

  /**
   * @param {object} message
   * @returns {boolean} whether it left
   */
  send(message) {
    if (this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  #connect() {
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const socket = new WebSocket(`${scheme}://${location.host}${this.#path}`);
    socket.binaryType = 'arraybuffer';
    this.#socket = socket;
    this.#heard = performance.now();
    socket.addEventListener('open', () => this.#listener.change({open: true}));
    socket.addEventListener('message', ({data}) => this.#received(data));
    socket.addEventListener('close', ({code}) => this.#closed(socket, code));
  }

  /** @param {string|ArrayBuffer} data */
  #received(data) {
    this.#heard = performance.now();
    this.#wait = FIRST_WAIT_MS;
    if (typeof data === 'string') this.#listener.message(JSON.parse(data));
    else this.#listener.bytes(data);
  }

  /**
   * @param {WebSocket} socket
   * @param {number} code
   */
  #closed(socket, code) {
    if (socket !== this.#socket) return;
    this.#socket = null;
    // Spread out, so that many screens don't all come back in the same instant.
    const wait = this.#wait * (0.8 + 0.4 * Math.random());
    this.#wait = Math.min(this.#wait * 2, LONGEST_WAIT_MS);
    this.#timer = setTimeout(() => this.#connect(), wait);
    const reason = REASONS.get(code) ?? 'The connection to the server is lost.';
    this.#listener.change({open: false, reason, wait: wait / 1000});
  }

  #watch() {
    const socket = this.#socket;
    if (!socket || performance.now() - this.#heard < SILENCE_MS) return;
    socket.close();
    // A dead line may take minutes to close in good order.
    this.#closed(socket, 1006);
  }
}
