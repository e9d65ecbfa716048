// @ts-check
/** Files that the browser keeps. */

import {element} from './element.js';

/**
 * @param {string} name
 * @param {BlobPart} content
 * @param {string} type such as application/yaml
 */
export function saveFile(name, content, type) {
  const address = URL.createObjectURL(new Blob([content], {type}));
  element('a', {href: address, download: name}).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}

/**
 * @param {string} title
 * @returns {string} it as the name of a file, without an ending; empty where nothing is left of it
 */
export function fileName(title) {
  return title.trim().replace(/[^\p{L}\p{N}._-]+/gu, '-').replace(/^[-.]+|[-.]+$/g, '');
}
