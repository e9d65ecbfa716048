// @ts-check
/** The page at /docs/live: the AsyncAPI document of this server, for people. */

import {element} from '../dom/element.js';
import {Schemas, fieldTable, table} from './fields.js';
import {applyTheme} from '../screen/theme.js';

/** @typedef {{[name: string]: any}} Document */

const SIDES = /** @type {const} */ ([
  ['to_', 'Messages you can send'],
  ['from_', 'Messages from the server'],
]);

/**
 * Text whose parts between backquotes are code.
 *
 * @param {string} text
 * @returns {(Node|string)[]}
 */
function prose(text) {
  return text.split('`').map((part, at) => (at % 2 ? element('code', {}, part) : part));
}

/** @param {string} text */
function paragraph(text) { return element('p', {}, ...prose(text)); }

/**
 * @param {Document} document
 * @param {Schemas} schemas
 * @param {string} id of a message
 */
function message(document, schemas, id) {
  const {title, summary, description, payload, examples, ...more} = document.components.messages[id];
  const layout = more['x-layout'];
  const answers = answersTo(document, id);
  return element('section', {class: 'message', id, 'aria-labelledby': `${id}-title`},
    element('h3', {id: `${id}-title`}, title),
    paragraph(summary),
    description && paragraph(description),
    layout ? layoutTable(layout) : details(fieldTable(schemas.fields(payload))),
    ...(examples ?? []).map((/** @type {Document} */ example) => element('pre', {},
      element('code', {}, JSON.stringify(example.payload)))),
    answers && element('p', {class: 'answers'}, ...answers));
}

/** @param {HTMLElement} fields */
function details(fields) {
  const rows = fields.querySelectorAll('tbody tr').length;
  // A long table would hide the messages that follow it.
  return rows <= 6 ? fields : element('details', {}, element('summary', {}, `${rows} fields`), fields);
}

/**
 * @param {Document} document
 * @param {string} id
 * @returns {(Node|string)[]|null} which messages answer one, in words; null for the server's own
 */
function answersTo(document, id) {
  const reply = document.operations[id.replace('to_', 'hear_')]?.reply;
  if (!reply) return null;
  const links = reply.messages.map((/** @type {{$ref: string}} */ one) => {
    const answer = one.$ref.split('/').at(-1) ?? '';
    return element('a', {href: `#${answer}`}, answer.replace('from_', ''));
  });
  const refusal = links.pop();
  const answers = links.flatMap((/** @type {Node} */ link, /** @type {number} */ at) => (at ? [' and ', link] : [link]));
  const begin = answers.length ? ['Answered by ', ...answers] : ['Not answered'];
  return [...begin, '; if refused, by ', refusal, '.'];
}

/** @param {Document} layout of a binary message */
function layoutTable(layout) {
  const rows = layout.header.map((/** @type {Document} */ field) => element('tr', {},
    element('td', {}, element('code', {}, field.name)),
    element('td', {}, `byte ${field.offset}: ${field.type}`, field.unit && ` [${field.unit}]`),
    element('td', {}, field.description)));
  const {offset, type, order} = layout.data;
  rows.push(element('tr', {},
    element('td', {}, element('code', {}, 'data')),
    element('td', {}, `byte ${offset}: ${type}`),
    element('td', {}, `Columns × rows numbers, ${order}.`)));
  return table(['Field', 'Place', 'Meaning'], rows);
}

/** @param {Document} channel */
function limits(channel) {
  const rows = channel['x-limits'].map((/** @type {Document} */ limit) => element('tr', {},
    element('td', {class: 'number'}, [limit.value.toLocaleString('en'), limit.unit].filter(Boolean).join(' ')),
    element('td', {}, ...prose(limit.description))));
  return section('limits', 'Limits', table(['Limit', 'Of what'], rows, 'plain'));
}

/** @param {Document} channel */
function closeCodes(channel) {
  const rows = channel['x-close-codes'].map((/** @type {Document} */ one) => element('tr', {},
    element('td', {class: 'number'}, String(one.code)),
    element('td', {}, one.description)));
  return section('close-codes', 'Close codes', table(['Code', 'Reason'], rows, 'plain'));
}

/**
 * @param {string} id
 * @param {string} title
 * @param {...Node} children
 */
function section(id, title, ...children) {
  return element('section', {'aria-labelledby': id}, element('h2', {id}, title), ...children);
}

/** @param {Document} content of the AsyncAPI document */
function show(content) {
  const {messages, schemas} = content.components;
  const ids = new Map(Object.keys(messages).filter((id) => id.startsWith('from_'))
    .map((id) => [id.slice('from_'.length), id]));
  const finder = new Schemas(schemas, ids);
  const sides = SIDES.map(([side, title]) => section(side.replace('_', '-side'), title,
    ...Object.keys(messages).filter((id) => id.startsWith(side))
      .map((id) => message(content, finder, id))));
  const {live} = content.channels;
  document.getElementById('description')?.replaceChildren(...prose(content.info.description));
  document.getElementById('contents')?.replaceChildren(...sides, limits(live), closeCodes(live));
  const {host, protocol} = content.servers.this;
  const script = document.getElementById('script');
  if (script) script.textContent = (script.textContent ?? '').replace('ws://127.0.0.1:8000', `${protocol}://${host}`);
  if (location.hash) document.getElementById(location.hash.slice(1))?.scrollIntoView();
}

applyTheme();
try {
  const answer = await fetch('/asyncapi.json');
  if (!answer.ok) throw new Error(`the server answered ${answer.status}`);
  show(await answer.json());
} catch (error) {
  const text = `The server’s AsyncAPI document could not be read: ${error}. Load the page again.`;
  document.getElementById('contents')?.replaceChildren(element('p', {role: 'alert'}, text));
}
