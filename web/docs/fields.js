// @ts-check
/** The fields of a message, after its schema in the AsyncAPI document. */

import {element} from '../dom/element.js';

/** @typedef {{[name: string]: any}} Schema */
/** @typedef {{path: string, type: string|Node, meaning: string, needed: boolean}} Field */

/** Finds what an AsyncAPI document refers to. */
export class Schemas {
  #schemas;
  /** @type {Map<string, string>} message by the value of its `type` */ #messages;

  /**
   * @param {Schema} schemas by name
   * @param {Map<string, string>} messages id on the page by the value of its `type`
   */
  constructor(schemas, messages) {
    this.#schemas = schemas;
    this.#messages = messages;
  }

  /**
   * @param {Schema} schema
   * @returns {Field[]} all fields of an object, those of objects in it too
   */
  fields(schema) { return this.#fields(this.#resolved(schema).schema, ''); }

  /**
   * @param {Schema} schema
   * @param {string} before path of the object
   * @returns {Field[]}
   */
  #fields(schema, before) {
    const entries = Object.entries(schema.properties ?? {});
    // What a message is comes first, what all of them may bear last.
    entries.sort(([one], [other]) => place(one) - place(other));
    return entries.flatMap(([name, value]) => {
      const path = before + name;
      const inner = this.#inner(value);
      const needed = (schema.required ?? []).includes(name);
      const field = {path, type: this.#type(value), meaning: this.#meaning(value), needed};
      return inner ? [field, ...this.#fields(inner.schema, path + inner.joint)] : [field];
    });
  }

  /** @param {Schema} schema */
  #resolved(schema) {
    const name = schema.$ref?.split('/').at(-1) ?? '';
    return {name, schema: name ? this.#schemas[name] : schema};
  }

  /**
   * @param {Schema} value
   * @returns {{schema: Schema, joint: string}|null} the object in a field that is told field by
   *   field as well, and what stands between both paths
   */
  #inner(value) {
    const one = this.#present(value);
    if (one.type === 'array' && one.items) {
      const inner = this.#inner(one.items);
      return inner && {...inner, joint: `[]${inner.joint}`};
    }
    if (typeof one.additionalProperties === 'object') {
      const inner = this.#inner(one.additionalProperties);
      return inner && {...inner, joint: `.*${inner.joint}`};
    }
    const {name, schema} = this.#resolved(one);
    if (!name || schema['x-address'] || this.#message(schema)) return null;
    return {schema, joint: '.'};
  }

  /**
   * @param {Schema} value
   * @returns {Schema} what it is where it isn't null
   */
  #present(value) {
    const [one, ...others] = (value.anyOf ?? []).filter((/** @type {Schema} */ each) => each.type !== 'null');
    return one && others.length === 0 ? one : value;
  }

  /** @param {Schema} schema */
  #message(schema) {
    const type = schema.properties?.type?.const;
    return this.#messages.has(type) ? type : null;
  }

  /** @param {Schema} value */
  #meaning(value) {
    return value.description ?? this.#resolved(this.#present(value)).schema.description ?? '';
  }

  /**
   * @param {Schema} value
   * @returns {string|Node}
   */
  #type(value) {
    const {name, schema} = this.#resolved(value);
    const address = schema['x-address'];
    if (address) return element('a', {href: address}, name);
    const message = name && this.#message(schema);
    if (message) return element('a', {href: `#${this.#messages.get(message)}`}, `as ${message}`);
    return this.#words(schema);
  }

  /**
   * @param {Schema} value
   * @returns {string}
   */
  #words(value) {
    const {schema} = this.#resolved(value);
    if ('const' in schema) return JSON.stringify(schema.const);
    if (schema.enum) return schema.enum.map((/** @type {any} */ each) => JSON.stringify(each)).join(' or ');
    const several = schema.anyOf ?? schema.oneOf;
    if (several) return several.map((/** @type {Schema} */ each) => this.#words(each)).join(' or ');
    if (schema.type === 'array') return `${count(schema)} ${plural(this.#words(schema.items ?? {}))}`;
    if (typeof schema.additionalProperties === 'object') return 'object by name';
    const least = schema.minimum ?? schema.exclusiveMinimum;
    const most = schema.maximum ?? schema.exclusiveMaximum;
    // Whole numbers up to 2^53 are all that JavaScript knows: no bound of ours.
    const bounded = least !== undefined && Math.abs(least) < 2 ** 53;
    return `${schema.type ?? 'anything'}${bounded ? ` ${interval(schema, least, most)}` : ''}`;
  }
}

/** @param {string} name of a field */
function place(name) { return ['type', '', 'id'].indexOf(name === 'type' || name === 'id' ? name : ''); }

/**
 * @param {Schema} schema
 * @param {number} least
 * @param {number} [most]
 */
function interval(schema, least, most) {
  if (most === undefined) return `≥ ${least}`;
  return `in ${'minimum' in schema ? '[' : '('}${least}, ${most}]`;
}

/** @param {Schema} schema */
function count(schema) {
  return schema.minItems && schema.minItems === schema.maxItems ? String(schema.minItems) : 'list of';
}

/** @param {string} words */
function plural(words) { return words.replace(/^(number|integer|string|object)/, '$1s'); }

/**
 * @param {Field[]} fields
 * @returns {HTMLElement}
 */
export function fieldTable(fields) {
  const row = (/** @type {Field} */ field) => element('tr', {},
    element('td', {}, element('code', {}, field.path)),
    element('td', {}, field.type, !field.needed && ' (may be left out)'),
    element('td', {}, field.meaning));
  return table(['Field', 'Type', 'Meaning'], fields.map(row), 'fields');
}

/**
 * @param {string[]} heads
 * @param {Node[]} rows
 * @param {string} [kind]
 * @returns {HTMLElement}
 */
export function table(heads, rows, kind = 'fields') {
  return element('table', {class: kind},
    element('thead', {}, element('tr', {}, ...heads.map((head) => element('th', {scope: 'col'}, head)))),
    element('tbody', {}, ...rows));
}
