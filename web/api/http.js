// @ts-check
/** Requests to the server, and its one shape of errors. */

import {WATCH_ONLY, isWatching} from './watch_only.js';

/**
 * @typedef {{path: string, message: string, value?: any, allowed?: string, line?: number|null}}
 *   FieldError
 */

/** What the server refused, in words. */
export class ApiError extends Error {
  /**
   * @param {number} status HTTP status, 0 when the server wasn't reached
   * @param {string} code
   * @param {string} message
   * @param {FieldError[]} [fields]
   */
  constructor(status, code, message, fields = []) {
    super(message);
    this.name = 'ApiError';
    this.status = status;
    this.code = code;
    this.fields = fields ?? [];
  }
}

/**
 * @param {Response} response
 * @returns {Promise<ApiError>}
 */
async function refusal(response) {
  const fallback = `the server answered ${response.status} ${response.statusText}`.trim();
  try {
    const {code, message, fields} = (await response.json()).error;
    return new ApiError(response.status, code, message, fields);
  } catch {
    return new ApiError(response.status, 'http', fallback);
  }
}

/** @param {string|object} [body] */
function contentOf(body) {
  if (body === undefined) return {};
  if (body instanceof FormData) return {body};  // whose header only the browser can write
  const yaml = typeof body === 'string';
  const headers = {'Content-Type': yaml ? 'application/yaml' : 'application/json'};
  return {headers, body: yaml ? body : JSON.stringify(body)};
}

/**
 * @param {string} method
 * @param {string} address
 * @param {string|object} [body] text is YAML, files are sent as they are, anything else is JSON
 * @param {AbortSignal} [signal]
 * @returns {Promise<Response>}
 * @throws {ApiError} when the server refuses or can't be reached
 * @throws {DOMException} when `signal` aborts it
 */
async function answer(method, address, body, signal) {
  if (isWatching() && method !== 'GET') throw new ApiError(403, 'watch_only', WATCH_ONLY);
  const content = contentOf(body);
  let response;
  try {
    response = await fetch(address, {method, signal, ...content});
  } catch (error) {
    signal?.throwIfAborted();
    throw new ApiError(0, 'unreachable', 'the server can’t be reached; is it still running?');
  }
  if (!response.ok) throw await refusal(response);
  return response;
}

/**
 * @param {string} method
 * @param {string} address
 * @param {string|object} [body] text is YAML, anything else JSON
 * @param {AbortSignal} [signal]
 * @returns {Promise<any>} JSON, bytes, or the text of any other answer; null when there is none
 * @throws {ApiError} when the server refuses or can't be reached
 * @throws {DOMException} when `signal` aborts it
 */
export async function request(method, address, body, signal) {
  const response = await answer(method, address, body, signal);
  const type = response.headers.get('Content-Type') ?? '';
  if (response.status === 204) return null;
  if (/octet-stream|zip/.test(type)) return response.arrayBuffer();
  return type.includes('json') ? response.json() : response.text();
}

/**
 * @param {string} address
 * @param {object} body
 * @param {AbortSignal} [signal]
 * @returns {Promise<Blob>} the answer as a file, whatever is in it
 * @throws {ApiError} when the server refuses or can't be reached
 * @throws {DOMException} when `signal` aborts it
 */
export async function requestFile(address, body, signal) {
  return (await answer('POST', address, body, signal)).blob();
}

/**
 * Read an answer of one JSON object a line while it is still being written.
 *
 * @param {string} address
 * @param {object} body
 * @param {(row: any) => void} onRow called with each object as it comes
 * @param {AbortSignal} [signal] stops the server as well
 * @throws {ApiError} when the server refuses, can't be reached or breaks off
 * @throws {DOMException} when `signal` aborts it
 */
export async function requestLines(address, body, onRow, signal) {
  const response = await answer('POST', address, body, signal);
  const reader = /** @type {ReadableStream<Uint8Array>} */ (response.body)
    .pipeThrough(new TextDecoderStream()).getReader();
  let rest = '';
  for (;;) {
    let part;
    try {
      part = await reader.read();
    } catch {
      signal?.throwIfAborted();
      throw new ApiError(0, 'broken', 'the connection was lost before the answer was complete');
    }
    const lines = (rest + (part.value ?? '')).split('\n');
    rest = part.done ? '' : /** @type {string} */ (lines.pop());
    for (const line of lines) if (line) onRow(JSON.parse(line));
    if (part.done) return;
  }
}
