// @ts-check
/** Whole responses as a CSV file. */

import {table} from '../plot_view/download.js';
import {JOINTS} from '../api/arm.js';

/** @typedef {import('../api/preview_message.js').Response} Response */

/**
 * Every point that was sent, all joints: for each lane its times and its values.
 *
 * @param {import('./views.js').ResponseView} view
 * @param {{name: string, response: Response}[]} responses `name`: '' for the current one
 * @returns {Blob}
 */
export function responseTable(view, responses) {
  const panels = view.panels(JOINTS);
  return table(responses.flatMap(({name: title, response}) => (
    [...response.lanes.values()].flatMap(({name, time, columns}) => {
      const of = title ? `${name} ${title}` : name;
      return [
        {header: `time of ${of} [s]`, values: time},
        ...panels.map(({title: place, quantity, unit, channel, scale}) => ({
          header: `${quantity} ${place} ${of} [${unit}]`,
          values: (columns.get(channel) ?? new Float32Array()).map((value) => value * scale),
        })),
      ];
    })
  )));
}
