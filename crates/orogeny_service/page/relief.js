// Colours of heights, and the shading of a page as seen from above with the sun in the north-west.

import { clamp } from './grid.js';

const NUM_COLOURS = 256;
// From the lowest to the highest: meadow, dry grass, earth, rock, snow.
const STOPS = [
  [0, [82, 116, 86]],
  [0.18, [112, 141, 92]],
  [0.4, [170, 168, 118]],
  [0.62, [166, 138, 106]],
  [0.82, [152, 143, 136]],
  [1, [244, 246, 247]],
];
const ROCK = [122, 112, 104];
/** Where slopes begin to look like rock, and where they do altogether: rise over run. */
export const ROCK_SLOPE = [0.55, 1.3];
/** Towards the sun: east, up, south. */
export const SUN = [-0.55, 0.66, -0.51];
const MAP_STEEPER = 1.6;

/** @param {number} share 0..1 @returns {number[]} red, green, blue */
function colourAt(share) {
  const next = Math.max(
    1,
    STOPS.findIndex(([at]) => at >= share),
  );
  const [[at0, from], [at1, to]] = [STOPS[next - 1], STOPS[next]];
  const t = (share - at0) / (at1 - at0);
  return from.map((value, i) => value + (to[i] - value) * t);
}

/** RGBA, from the lowest to the highest height. */
export const PALETTE = Uint8Array.from(
  Array.from({ length: NUM_COLOURS }, (_, i) => [...colourAt(i / (NUM_COLOURS - 1)), 255])
    .flat()
    .map(Math.round),
);

/** @typedef {{low_m: number, high_m: number}} Range */

/**
 * Shades a part of a page.
 * @param {Uint8ClampedArray} out RGBA of the page, row by row
 * @param {import('./frames.js').Page} page
 * @param {{west?: import('./frames.js').Page, east?: import('./frames.js').Page, north?: import('./frames.js').Page, south?: import('./frames.js').Page}} near
 * @param {number} step_m metres between samples
 * @param {Range} range
 * @param {import('./grid.js').Rect} part in samples
 */
export function shade(out, page, near, step_m, range, part) {
  const { width, depth, heights_m: h } = page;
  const scale = (NUM_COLOURS - 1) / Math.max(range.high_m - range.low_m, 1e-6);
  const steeper = MAP_STEEPER / step_m;
  for (let j = part.z0; j < part.z1; j += 1) {
    for (let i = part.x0; i < part.x1; i += 1) {
      const at = j * width + i;
      const here = h[at];
      const w = i > 0 ? h[at - 1] : near.west?.heights_m[j * near.west.width + near.west.width - 1];
      const e = i + 1 < width ? h[at + 1] : near.east?.heights_m[j * near.east.width];
      const n = j > 0 ? h[at - width] : near.north?.heights_m[(near.north.depth - 1) * near.north.width + i];
      const s = j + 1 < depth ? h[at + width] : near.south?.heights_m[i];
      // At an edge with nothing known beyond it, the slope of the one side counts for both.
      const dx = ((e ?? here) - (w ?? here)) * steeper * (w === undefined || e === undefined ? 1 : 0.5);
      const dz = ((s ?? here) - (n ?? here)) * steeper * (n === undefined || s === undefined ? 1 : 0.5);
      const slope2 = dx * dx + dz * dz;
      // Steep slopes count for less, or all that turns away from the sun would be one black.
      const less = 1 / (1 + 0.25 * Math.sqrt(slope2));
      const lit = Math.max((SUN[1] - (SUN[0] * dx + SUN[2] * dz) * less) / Math.sqrt(1 + slope2 * less * less), 0);
      const light = 0.42 + 0.88 * lit;
      const rock = clamp((Math.sqrt(slope2) / MAP_STEEPER - ROCK_SLOPE[0]) / (ROCK_SLOPE[1] - ROCK_SLOPE[0]), 0, 1) * 0.75;
      const colour = 4 * clamp(Math.round((here - range.low_m) * scale), 0, NUM_COLOURS - 1);
      for (let c = 0; c < 3; c += 1) out[4 * at + c] = (PALETTE[colour + c] * (1 - rock) + ROCK[c] * rock) * light;
      out[4 * at + 3] = 255;
    }
  }
}
