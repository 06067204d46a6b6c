// Places, levels and pages of a terrain: plain arithmetic, no state.

/**
 * @typedef {object} Terrain what `hello` says
 * @property {string} name
 * @property {number} width samples along x
 * @property {number} depth samples along z
 * @property {number} spacing_m
 * @property {number} pageSize samples a side
 * @property {number} levels above full resolution
 * @typedef {{x0: number, z0: number, x1: number, z1: number}} Rect far edges outside; metres or pages
 * @typedef {object} Selection what is subscribed to
 * @property {number} level
 * @property {Rect} pages
 */

/** @param {number} value @param {number} low @param {number} high */
export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/** @param {Terrain} terrain @param {number} level */
export const levelSpacing_m = (terrain, level) => terrain.spacing_m * 2 ** level;

/** Samples of a level: every 2^level-th one. @param {Terrain} terrain @param {number} level */
export const levelSize = (terrain, level) => ({
  width: Math.ceil(terrain.width / 2 ** level),
  depth: Math.ceil(terrain.depth / 2 ** level),
});

/** @param {Terrain} terrain @param {number} level */
export function levelPages(terrain, level) {
  const { width, depth } = levelSize(terrain, level);
  return { x0: 0, z0: 0, x1: Math.ceil(width / terrain.pageSize), z1: Math.ceil(depth / terrain.pageSize) };
}

/** From the first to the last sample. @param {Terrain} terrain @returns {{width_m: number, depth_m: number}} */
export const extent = (terrain) => ({
  width_m: Math.max(terrain.width - 1, 1) * terrain.spacing_m,
  depth_m: Math.max(terrain.depth - 1, 1) * terrain.spacing_m,
});

/** @param {Rect} rect */
export const numPages = (rect) => Math.max(rect.x1 - rect.x0, 0) * Math.max(rect.z1 - rect.z0, 0);

/** @param {Rect} a @param {Rect} b */
export const overlap = (a, b) => a.x0 < b.x1 && b.x0 < a.x1 && a.z0 < b.z1 && b.z0 < a.z1;

/** @param {Rect} outer @param {Rect} inner */
export const contains = (outer, inner) => outer.x0 <= inner.x0 && outer.z0 <= inner.z0 && outer.x1 >= inner.x1 && outer.z1 >= inner.z1;

/** @param {Rect} a @param {Rect} b @returns {Rect} */
export const union = (a, b) => ({ x0: Math.min(a.x0, b.x0), z0: Math.min(a.z0, b.z0), x1: Math.max(a.x1, b.x1), z1: Math.max(a.z1, b.z1) });

/** The pages that a place in metres touches. @param {Terrain} terrain @param {number} level @param {Rect} rect_m @returns {Rect} */
export function pagesOver(terrain, level, rect_m) {
  const page_m = levelSpacing_m(terrain, level) * terrain.pageSize;
  const all = levelPages(terrain, level);
  const [x0, z0] = [clamp(Math.floor(rect_m.x0 / page_m), 0, all.x1 - 1), clamp(Math.floor(rect_m.z0 / page_m), 0, all.z1 - 1)];
  return { x0, z0, x1: clamp(Math.ceil(rect_m.x1 / page_m), x0 + 1, all.x1), z1: clamp(Math.ceil(rect_m.z1 / page_m), z0 + 1, all.z1) };
}

/** @param {Terrain} terrain @param {number} level @param {Rect} pages @returns {Rect} in metres */
export function pagesToMetres(terrain, level, pages) {
  const page_m = levelSpacing_m(terrain, level) * terrain.pageSize;
  return { x0: pages.x0 * page_m, z0: pages.z0 * page_m, x1: pages.x1 * page_m, z1: pages.z1 * page_m };
}

/** @param {[number, number, number, number]} rect `[x, z, width, depth]` @returns {Rect} */
export const rectOf = ([x, z, width, depth]) => ({ x0: x, z0: z, x1: x + width, z1: z + depth });

// What one client asks for at most: 80 pages are 20 MB of heights, and 16 a side fit every graphics card's textures.
const MAX_PAGES = 80;
const MAX_PAGES_A_SIDE = 16;

/** @param {Rect} pages */
export const fits = (pages) =>
  numPages(pages) <= MAX_PAGES && pages.x1 - pages.x0 <= MAX_PAGES_A_SIDE && pages.z1 - pages.z0 <= MAX_PAGES_A_SIDE;

/** @param {Rect} rect @param {number} share of its size, added all around @returns {Rect} */
function grown(rect, share) {
  const [dx, dz] = [(rect.x1 - rect.x0) * share, (rect.z1 - rect.z0) * share];
  return { x0: rect.x0 - dx, z0: rect.z0 - dz, x1: rect.x1 + dx, z1: rect.z1 + dz };
}

/**
 * The finest level whose samples are still worth sending, and its pages over what is seen, with a margin if that fits.
 * @param {Terrain} terrain @param {Rect} seen_m @param {number} wanted_m metres between samples that the eye can tell apart
 * @returns {Selection}
 */
export function choose(terrain, seen_m, wanted_m) {
  const ideal = Math.floor(Math.log2(Math.max(wanted_m / terrain.spacing_m, 1)));
  let level = clamp(ideal, 0, terrain.levels);
  while (level < terrain.levels && !fits(pagesOver(terrain, level, seen_m))) level += 1;
  const wide = pagesOver(terrain, level, grown(seen_m, 0.2));
  return { level, pages: fits(wide) ? wide : pagesOver(terrain, level, seen_m) };
}
