// @ts-check
/** What the fields of an experiment are called: by their path, for lists and buttons. */

import {valueAt} from './merge_patch.js';
import {withUnit, written} from './quantity.js';
import {inWords} from './schema.js';

/** @typedef {import('./schema.js').Field} Field */
/** @typedef {import('./schema.js').Section} Section */
/** @typedef {{symbol: string, title: string, unit: string, lane: string}} FieldName */

const MOST_VALUES = 3;

/** Reads names from the schema. */
export class FieldNames {
  #schema;
  #api;

  /**
   * @param {import('./schema.js').Schema} schema
   * @param {import('../api/api.js').Api} api
   */
  constructor(schema, api) {
    this.#schema = schema;
    this.#api = api;
  }

  /**
   * @param {readonly string[]} path
   * @returns {FieldName}
   */
  of(path) {
    const [section, name] = path;
    const lane = section === 'lanes' ? name : '';
    const found = lane ? this.#gain(path) : this.#part(path);
    const title = inWords((path[path.length - 1] ?? '').replace(/_$/, ''));
    const {symbol = '', unit = ''} = found ?? {};
    return {symbol, title: found?.title ?? title, unit, lane};
  }

  /**
   * Values that a patch sets, such as `ν = 3`.
   *
   * @param {readonly string[]} path
   * @param {any} value
   * @returns {string}
   */
  assignment(path, value) {
    const {symbol, title, unit} = this.of(path);
    if (symbol) return `${symbol} = ${valueText(value)}`;
    return `${title.charAt(0).toLowerCase()}${title.slice(1)} = ${valueText(value, unit)}`;
  }

  /** @param {readonly string[]} path */
  #gain([, lane, key]) {
    const {laws, experiment} = this.#api;
    const present = experiment.lanes[lane]?.law;
    const names = [present, ...laws.map(({name}) => name)].filter(Boolean);
    for (const law of new Set(names)) {
      const field = this.#schema.laneFields(law, lane).find(({path}) => path[2] === key);
      if (field) return field;
    }
    return undefined;
  }

  /** @param {readonly string[]} path */
  #part(path) {
    let items = /** @type {(Field|Section)[]} */ (this.#schema.sections());
    for (let depth = 1; depth <= path.length; depth += 1) {
      const item = items.find((one) => one.path[one.path.length - 1] === path[depth - 1]);
      if (!item || !('node' in item)) return item;
      const value = valueAt(this.#api.experiment, item.path);
      if (depth < path.length && value) items = this.#schema.contents(item, value);
    }
    return undefined;
  }
}

/**
 * @param {any} value
 * @param {string} [unit]
 * @returns {string}
 */
export function valueText(value, unit = '') {
  if (value === null || value === undefined) return 'off';
  if (typeof value === 'boolean') return value ? 'on' : 'off';
  if (typeof value === 'number') return withUnit(value, unit);
  if (!Array.isArray(value)) return String(value);
  const numbers = value.map((one) => written(Number(Number(one).toPrecision(3))));
  const shown = new Set(numbers).size === 1 ? [numbers[0]] : numbers;
  const few = shown.length > MOST_VALUES ? [...shown.slice(0, MOST_VALUES), '…'] : shown;
  return `${few.join(', ')}${unit && ` ${unit}`}`;
}
