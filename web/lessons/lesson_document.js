// @ts-check
/** Messages from the server of lessons: their list, and one of them, whole. */

/** @typedef {import('../fields/merge_patch.js').Document} Document */
/**
 * @typedef {{name: string, title: string, summary: string, minutes: number, steps: number}}
 *   LessonSummary
 */
/**
 * @typedef {{label: string, window: string, quoted: string, unit: string, factor: number,
 *   metric: string, lane: string, joint: number|null, reduced: 'mean'|'greatest'|'none',
 *   since: number, until: number, at: number|null, layer: number[], high_frequency: number}}
 *   LessonFigure
 */
/**
 * @typedef {{text: string, choices: string[], answer: number, explanation: string[],
 *   figures: LessonFigure[]}} LessonQuestion
 */
/** @typedef {{path: string, label: string, was: string, now: string}} LessonChange */
/**
 * @typedef {{title: string, text: string[], preset: string, experiment: Document,
 *   changes: LessonChange[], lane: string, view: string|null, lens: string|null,
 *   exaggeration: number|null, figures: LessonFigure[], reset: boolean, samples: number,
 *   question: LessonQuestion|null}} LessonStep
 */
/** @typedef {{name: string, title: string, steps: LessonStep[]}} Lesson */

export {};
