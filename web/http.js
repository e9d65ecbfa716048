// @ts-check
/** Requests to the server, and its one shape of errors. */

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

/**
 * @param {string} method
 * @param {string} address
 * @param {string|object} [body] text is YAML, anything else JSON
 * @returns {Promise<any>} JSON, or the text of any other answer
 * @throws {ApiError} when the server refuses or can't be reached
 */
export async function request(method, address, body) {
  const yaml = typeof body === 'string';
  const headers = {'Content-Type': yaml ? 'application/yaml' : 'application/json'};
  const content = body === undefined ? {} : {headers, body: yaml ? body : JSON.stringify(body)};
  let response;
  try {
    response = await fetch(address, {method, ...content});
  } catch {
    throw new ApiError(0, 'unreachable', 'the server can’t be reached; is it still running?');
  }
  if (!response.ok) throw await refusal(response);
  const type = response.headers.get('Content-Type') ?? '';
  if (response.status === 204) return null;
  return type.includes('json') ? response.json() : response.text();
}
