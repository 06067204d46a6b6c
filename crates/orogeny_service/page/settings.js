// Brushes and their parameters, from the service's JSON Schemas; no document, only values.

/**
 * @typedef {object} Parameter
 * @property {string} name
 * @property {'number' | 'choice' | 'switch'} kind
 * @property {unknown} initial `null`: none, and the brush finds its own
 * @property {boolean} isNeeded
 * @property {boolean} isWhole
 * @property {number} low
 * @property {number} high
 * @property {boolean} isLowOpen whether `low` itself is too low
 * @property {string[]} choices
 * @property {string} about
 * @property {string} unit
 */

// What the page offers behind "More".
const SHAPE = ['falloff', 'profile', 'power', 'steepness', 'spacing', 'flow', 'blending', 'airbrush', 'pressure'];
// These need files or a second place, or paint what this page does not show.
const isUsable = (schema) => !['stamp', 'clone', 'custom'].includes(schema.title) && !schema.title.endsWith('_mask');

/** The unit is what the description has in brackets at its end. @param {string} about */
function splitUnit(about) {
  const match = about.match(/^(.*) \(([^()]{1,6})\)$/);
  return match ? [match[1], match[2]] : [about, ''];
}

/** @param {string} name @param {object} schema @param {boolean} isNeeded @returns {Parameter | null} `null`: too much for a form */
function parameter(name, schema, isNeeded) {
  const kinds = { number: 'number', integer: 'number', boolean: 'switch' };
  const kind = schema.enum ? 'choice' : kinds[schema.type];
  if (!kind) return null;
  const [about, unit] = splitUnit(schema.description ?? '');
  return {
    name,
    kind,
    about,
    unit,
    isNeeded,
    initial: schema.default ?? (isNeeded ? 0 : null),
    isWhole: schema.type === 'integer',
    low: schema.minimum ?? schema.exclusiveMinimum ?? -1e9,
    isLowOpen: schema.minimum === undefined && schema.exclusiveMinimum !== undefined,
    high: schema.maximum ?? 1e9,
    choices: schema.enum ?? [],
  };
}

/** @typedef {{name: string, about: string, main: Parameter[], more: Parameter[], isInMetres: boolean}} Brush */

/** @param {object[]} schemas @returns {Brush[]} */
export function brushesOf(schemas) {
  return schemas
    .filter((schema) => typeof schema?.title === 'string' && isUsable(schema))
    .map((schema) => {
      const needed = new Set(schema.required ?? []);
      const all = Object.entries(schema.properties ?? {})
        .map(([name, value]) => parameter(name, value, needed.has(name)))
        .filter(Boolean);
      const first = ['radius', 'strength'];
      const named = (name) => all.find((each) => each.name === name);
      return {
        name: schema.title,
        about: schema.description ?? '',
        isInMetres: schema['x-strength-is'] === 'metres',
        main: [...first.map(named).filter(Boolean), ...all.filter(({ name }) => !first.includes(name) && !SHAPE.includes(name))],
        more: SHAPE.map(named).filter(Boolean),
      };
    });
}

/** A number as it may be sent. @param {Parameter} about @param {number} value */
export function within(about, value) {
  const low = about.isLowOpen ? Math.max(about.low, 1e-3) : about.low;
  const inside = Math.min(Math.max(value, low), about.high);
  return about.isWhole ? Math.round(inside) : inside;
}

/** Three digits, as people set sizes. @param {number} value */
export const rounded = (value) => (value === 0 ? 0 : Number(value.toPrecision(3)));

/** A slider runs from 0 to this. */
export const SLIDER = 1000;

/** Sizes are set by ratios: a slider's step is a share of the value. @param {number} at @param {number} low above 0 @param {number} high */
export const fromRatio = (at, low, high) => rounded(low * (high / low) ** (at / SLIDER));

/** @param {number} value @param {number} low above 0 @param {number} high */
export const toRatio = (value, low, high) => (value <= low ? 0 : (SLIDER * Math.log(value / low)) / Math.log(high / low));
