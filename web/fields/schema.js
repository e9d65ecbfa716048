// @ts-check
/** Reads the experiment's JSON Schema: which fields there are, and how each is to be shown. */

/** @typedef {import('./merge_patch.js').Document} Document */
/** @typedef {readonly string[]} Path */
/**
 * One value of the experiment.
 *
 * - number: one number; joints: a number for all joints or one each; vector: always several
 * - choice: one of `options`; switch: on or off; constant: nothing to choose
 *
 * @typedef {object} Field
 * @property {'number'|'joints'|'vector'|'choice'|'switch'|'constant'|'text'} kind
 * @property {Path} path
 * @property {string} title
 * @property {string} symbol
 * @property {string} unit
 * @property {string} description
 * @property {string} equation
 * @property {string} group
 * @property {string} applies simulation mode that it belongs to, or ''
 * @property {{[choice: string]: string[]}} needs options of its neighbours under which it acts
 * @property {{name: string, symbol: string}|null} weight its neighbour that weights its term
 * @property {string} source
 * @property {number} minimum
 * @property {number} maximum
 * @property {number} step
 * @property {boolean} log
 * @property {boolean} odd
 * @property {{over: string, title: string, symbol: string, pairs: [number, number][]}|null} fraction
 *   of which it is the numerator
 * @property {boolean} integer
 * @property {boolean} nullable null means off
 * @property {number} length of a vector or of the values per joint
 * @property {any[]} options
 * @property {any} default
 * @property {any} usual what it is switched on with, or null
 */
/**
 * A heading with what stands below it. A union shows the fields of its chosen variant.
 *
 * @typedef {object} Section
 * @property {'object'|'union'} kind
 * @property {Path} path
 * @property {string} title
 * @property {string} description
 * @property {Document} node
 */

/** A schema with its references resolved as they are met. */
export class Schema {
  #root;

  /** @param {Document} root */
  constructor(root) { this.#root = root; }

  /** @returns {Section[]} the experiment's parts, without its lanes */
  sections() {
    return Object.entries(this.#root.properties)
      .filter(([key]) => key !== 'lanes')
      .map(([key, node]) => this.#item([key], node))
      .filter((item) => 'node' in item);
  }

  /** Most lanes that an experiment may have. */
  get mostLanes() { return this.#root.properties.lanes.maxProperties ?? Infinity; }

  /**
   * @param {'title'|'description'} text of the experiment
   * @returns {number} most characters of it
   */
  longest(text) { return this.#root.properties[text].maxLength; }

  /**
   * @param {string} law
   * @param {string} lane name
   * @returns {Field[]} the gains of a lane, each with its `group`
   */
  laneFields(law, lane) {
    const node = this.#variant(this.#root.properties.lanes.additionalProperties, law);
    return this.#items(['lanes', lane], node).filter((item) => 'options' in item);
  }

  /**
   * @param {Section} section
   * @param {Document} value the section's part of the experiment
   * @returns {(Field|Section)[]}
   */
  contents(section, value) {
    if (section.kind === 'object') return this.#items(section.path, section.node);
    return this.#items(section.path, this.#variant(section.node, value[this.tag(section)]));
  }

  /**
   * @param {Section} section a union
   * @returns {string} the key whose value says which variant it is
   */
  tag(section) { return section.node.discriminator.propertyName; }

  /**
   * @param {Section} section a union
   * @returns {{name: string, description: string}[]}
   */
  variants(section) {
    const tag = this.tag(section);
    return section.node.oneOf.map((/** @type {Document} */ reference) => {
      const node = this.#resolved(reference);
      return {name: node.properties[tag].const, description: node.description ?? ''};
    });
  }

  /**
   * @param {Document} union
   * @param {string} name
   */
  #variant(union, name) { return this.#resolved({$ref: union.discriminator.mapping[name]}); }

  /**
   * Follow `$ref`; what stands beside it wins.
   *
   * @param {Document} node
   * @returns {Document}
   */
  #resolved(node) {
    if (!node.$ref) return node;
    const {$ref, ...beside} = node;
    const target = $ref.split('/').slice(1)
      .reduce((/** @type {Document} */ inner, /** @type {string} */ key) => inner[key], this.#root);
    return {...this.#resolved(target), ...beside};
  }

  /**
   * @param {Path} path
   * @param {Document} node
   */
  #items(path, node) {
    return Object.entries(node.properties)
      .map(([key, property]) => this.#item([...path, key], property))
      // What says which variant this is has its own control.
      .filter((item) => !('options' in item && tagged(node, item)));
  }

  /**
   * @param {Path} path
   * @param {Document} property
   * @returns {Field|Section}
   */
  #item(path, property) {
    const node = this.#resolved(property);
    if (node.properties) return section('object', path, node);
    if (node.discriminator) return section('union', path, node);
    return field(path, node, (node.anyOf ?? [node]).map((/** @type {Document} */ one) => (
      this.#resolved(one)
    )));
  }
}

/**
 * @param {Document} node
 * @param {Field} item
 */
function tagged(node, item) {
  const key = item.path[item.path.length - 1];
  return (key === 'law' || key === 'kind') && 'const' in node.properties[key];
}

/**
 * @param {'object'|'union'} kind
 * @param {Path} path
 * @param {Document} node
 * @returns {Section}
 */
function section(kind, path, node) {
  const title = inWords(node.title ?? path[path.length - 1]);
  return {kind, path, title, description: node.description ?? '', node};
}

/**
 * @param {Path} path
 * @param {Document} node
 * @param {Document[]} shapes what the value may look like
 * @returns {Field}
 */
function field(path, node, shapes) {
  const list = shapes.find((shape) => shape.type === 'array');
  const options = node.enum ?? (node.const === undefined ? [] : [node.const]);
  const bounds = {minimum: -Infinity, maximum: Infinity, ...list?.items, ...node};
  return {
    kind: kindOf(shapes, options),
    path,
    title: node.title ?? inWords(path[path.length - 1]),
    symbol: node.symbol ?? '',
    unit: node.unit ?? '',
    description: node.description ?? '',
    equation: node.equation ?? '',
    group: node.group ?? '',
    applies: node.applies ?? '',
    needs: node.needs ?? {},
    weight: node.weight ?? null,
    source: node.source ?? '',
    minimum: bounds.minimum,
    maximum: bounds.maximum,
    step: node.step ?? 1,
    log: node.scale === 'log' && bounds.minimum > 0,
    odd: node.odd === true,
    fraction: node.fraction ?? null,
    integer: shapes.some((shape) => shape.type === 'integer'),
    nullable: shapes.some((shape) => shape.type === 'null'),
    length: list?.maxItems ?? 1,
    perJoint: list?.per_joint === true,
    options,
    default: node.default,
    usual: node.usual ?? null,
  };
}

/**
 * @param {Document[]} shapes
 * @param {any[]} options
 * @returns {Field['kind']}
 */
function kindOf(shapes, options) {
  const types = shapes.map((shape) => shape.type);
  const numeric = types.includes('number') || types.includes('integer');
  if (options.length) return options.length > 1 ? 'choice' : 'constant';
  if (types.includes('array')) return numeric ? 'joints' : 'vector';
  if (numeric) return 'number';
  return types.includes('boolean') ? 'switch' : 'text';
}

/**
 * @param {string} name such as `SineTorque` or `sine_torque`
 * @returns {string} such as `Sine torque`
 */
export function inWords(name) {
  const words = name.replaceAll('_', ' ').replace(/(?<=[a-z])[A-Z]/g, (letter) => ` ${letter}`);
  return words.charAt(0).toUpperCase() + words.slice(1).toLowerCase();
}
