// @ts-check
/**
 * The last minute of telemetry, column by column, on one uniform time grid.
 *
 * Rows are counted from the last restart and never re-numbered; rows that never arrived are NaN.
 */

/** @typedef {import('../api/api.js').Channel} Channel */
/** @typedef {import('../api/api.js').Frame} Frame */
/** @typedef {{row: number, after: number, revision: number}} Mark */
/** @typedef {{lane: string, after: number, before: number}} Gap times in [s], both kept */

const KEPT_SECONDS = 60;
/** Ours: 60 s of three lanes at 2 kHz take 55 MB; a faster loop keeps less time than memory. */
const LARGEST_BYTES = 256 * 2 ** 20;
/** Revisions are told apart this far back; the views show fewer. */
const KEPT_MARKS = 1000;

/**
 * @param {string} lane
 * @param {string} group
 * @param {number|string} joint
 */
function key(lane, group, joint) { return JSON.stringify([lane, group, joint]); }

/** Ring of float32 columns. */
export class Ring {
  /** Time step of the rows in [s]; 0 before the first frame. */
  dt = 0;
  /** One past the newest row. */
  end = 0;
  /** How often it was emptied: a reset, another time step. */
  restarts = 0;
  /** @type {Mark[]} Rows where a newer revision of the experiment took over. */
  marks = [];

  /** @type {string[]} */ #keys = [];
  /** @type {Map<string, number>} */ #places = new Map();
  /** @type {Float32Array[]} */ #columns = [];
  #capacity = 0;
  #endTime = 0;
  #revision = -1;
  /** @type {Gap[]} those whose rows haven't all arrived */ #gaps = [];

  /**
   * Take over a list of channels. Columns that stay keep their history; new ones begin as NaN.
   *
   * @param {Channel[]} channels
   */
  configure(channels) {
    const keys = channels.map(({lane, group, joint}) => key(lane, group, joint));
    if (JSON.stringify(keys) === JSON.stringify(this.#keys)) return;
    const capacity = this.#capacityFor(keys.length);
    const kept = capacity === this.#capacity && keys.some((name) => this.#places.has(name));
    const columns = keys.map((name) => {
      const place = this.#places.get(name);
      if (kept && place !== undefined) return this.#columns[place];
      return new Float32Array(capacity).fill(NaN);
    });
    this.#keys = keys;
    this.#places = new Map(keys.map((name, index) => [name, index]));
    this.#columns = columns;
    this.#capacity = capacity;
    if (!kept) this.clear();
  }

  /**
   * Keep a lane's history under its new name.
   *
   * @param {string} before
   * @param {string} after
   */
  rename(before, after) {
    this.#gaps = this.#gaps.map((gap) => (gap.lane === before ? {...gap, lane: after} : gap));
    this.#keys = this.#keys.map((name) => {
      const [lane, group, joint] = JSON.parse(name);
      return lane === before ? key(after, group, joint) : name;
    });
    this.#places = new Map(this.#keys.map((name, index) => [name, index]));
  }

  /**
   * Forget what a lane's own columns hold between two times, also what has yet to arrive.
   *
   * @param {Gap} gap
   */
  forget(gap) {
    this.#gaps.push(gap);
    if (!this.empty) this.#fillGaps();
  }

  #fillGaps() {
    this.#gaps = this.#gaps.filter(({lane, after, before}) => {
      const places = this.#keys.flatMap((name, place) => (JSON.parse(name)[0] === lane ? [place] : []));
      const from = this.timeOf(this.start) > after ? this.start : this.rowAt(after) + 1;
      const to = this.rowAt(before);
      for (let row = from; row < to; row += 1) {
        for (const place of places) this.#columns[place][row % this.#capacity] = NaN;
      }
      return this.newest < before - this.dt;
    });
  }

  /** Forget every row. */
  clear() {
    this.end = 0;
    this.marks = [];
    this.#gaps = [];
    this.#revision = -1;
    this.restarts += 1;
  }

  /**
   * Add a frame. Missed rows become NaN; time that runs back, or another step, restarts.
   *
   * @param {Frame} frame
   */
  append(frame) {
    const {rows, columns, dt, time} = frame;
    if (!rows || columns !== this.#keys.length) return;
    if (Math.abs(dt - this.dt) > 1e-6 * dt) this.#regrid(dt);
    const missed = this.end ? Math.round((time - this.#endTime) / dt) : 0;
    if (missed < 0 || missed > this.#capacity) this.clear();
    else if (missed > 0) this.#skip(missed);
    this.#noteRevision(frame.revision);
    for (let column = 0; column < columns; column += 1) {
      const values = frame.data.subarray(column * rows, (column + 1) * rows);
      this.#write(this.#columns[column], values);
    }
    this.end += rows;
    this.#endTime = time + rows * dt;
    if (this.#gaps.length) this.#fillGaps();
    const start = this.start;
    if (this.marks.length && this.marks[0].row < start) {
      this.marks = this.marks.filter((mark) => mark.row >= start);
    }
  }

  /** Oldest row still kept. */
  get start() { return Math.max(0, this.end - this.#capacity); }

  /** Whether there is nothing to draw. */
  get empty() { return this.end === 0; }

  /** Time of the newest row in [s]. */
  get newest() { return this.timeOf(this.end - 1); }

  /**
   * @param {number} row
   * @returns {number} in [s]
   */
  timeOf(row) { return this.#endTime - (this.end - row) * this.dt; }

  /**
   * First kept row at or after a time.
   *
   * @param {number} time in [s]
   */
  rowAt(time) {
    const row = this.end - Math.floor((this.#endTime - time) / this.dt + 1e-6);
    return Math.min(Math.max(row, this.start), this.end);
  }

  /**
   * Where a channel stands.
   *
   * @param {string} lane '' for what all lanes share
   * @param {string} group
   * @param {number|string} joint
   * @returns {number} -1 when the server sends no such channel
   */
  place(lane, group, joint) { return this.#places.get(key(lane, group, joint)) ?? -1; }

  /**
   * Copy rows of one column.
   *
   * @param {number} place
   * @param {number} from first row, kept
   * @param {number} to one past the last row
   * @returns {Float32Array} Shape (to - from,).
   */
  copy(place, from, to) {
    const column = this.#columns[place];
    const values = new Float32Array(to - from);
    const head = from % this.#capacity;
    const first = Math.min(to - from, this.#capacity - head);
    values.set(column.subarray(head, head + first));
    values.set(column.subarray(0, to - from - first), first);
    return values;
  }

  /** @param {number} count of columns */
  #capacityFor(count) {
    if (!this.dt || !count) return 0;
    const wanted = Math.ceil(KEPT_SECONDS / this.dt) + 1;
    return Math.min(wanted, Math.floor(LARGEST_BYTES / 4 / count));
  }

  /** @param {number} dt */
  #regrid(dt) {
    this.dt = dt;
    this.#capacity = this.#capacityFor(this.#keys.length);
    this.#columns = this.#keys.map(() => new Float32Array(this.#capacity));
    this.clear();
  }

  /** @param {number} rows that never arrived */
  #skip(rows) {
    const gap = new Float32Array(rows).fill(NaN);
    for (const column of this.#columns) this.#write(column, gap);
    this.end += rows;
  }

  /**
   * @param {Float32Array} column
   * @param {Float32Array} values
   */
  #write(column, values) {
    const kept = values.subarray(Math.max(0, values.length - this.#capacity));
    const head = (this.end + values.length - kept.length) % this.#capacity;
    const first = Math.min(kept.length, this.#capacity - head);
    column.set(kept.subarray(0, first), head);
    column.set(kept.subarray(first), 0);
  }

  /** @param {number} revision */
  #noteRevision(revision) {
    if (revision === this.#revision) return;
    if (this.#revision >= 0) {
      this.marks.push({row: this.end, after: this.#revision, revision});
      if (this.marks.length > KEPT_MARKS) this.marks.shift();
    }
    this.#revision = revision;
  }
}
