// The pages that are known, by level. The map and the 3D view both draw from here.

import { clamp, levelPages, levelSpacing_m, overlap, pagesToMetres } from './grid.js';

/** @typedef {import('./frames.js').Page} Page @typedef {import('./grid.js').Terrain} Terrain @typedef {import('./grid.js').Rect} Rect */

const MAX_KEPT_PAGES = 200;
const MAX_OVERVIEW_PAGES = 4;

/** @param {number} level @param {number} px @param {number} pz */
export const keyOf = (level, px, pz) => `${level}/${px}/${pz}`;

export class PageStore {
  /** @type {Map<string, Page>} the oldest first */
  #pages = new Map();
  /** @type {import('./grid.js').Selection | null} what the service keeps up to date */
  live = null;
  /** @type {Set<{put?(page: Page): void, drop?(page: Page): void, clear?(): void}>} */
  listeners = new Set();

  /** @param {Terrain} terrain */
  constructor(terrain) {
    this.reset(terrain);
  }

  /** Begins anew. @param {Terrain} terrain */
  reset(terrain) {
    this.terrain = terrain;
    this.live = null;
    this.#pages.clear();
    const isSmall = (level) => {
      const all = levelPages(terrain, level);
      return all.x1 * all.z1 <= MAX_OVERVIEW_PAGES;
    };
    /** The finest level of which all is kept, as what is seen until something better comes. */
    this.overviewLevel = 0;
    while (this.overviewLevel < terrain.levels && !isSmall(this.overviewLevel)) this.overviewLevel += 1;
    for (const listener of this.listeners) listener.clear?.();
  }

  /** @param {Page} page */
  isLive(page) {
    const at = { x0: page.px, z0: page.pz, x1: page.px + 1, z1: page.pz + 1 };
    return this.live !== null && this.live.level === page.level && overlap(this.live.pages, at);
  }

  /** @param {number} level @param {number} px @param {number} pz */
  get(level, px, pz) {
    return this.#pages.get(keyOf(level, px, pz));
  }

  /** Pages from behind to the front: coarse ones, finer ones, and those that are up to date. */
  inOrder() {
    const rank = (page) => (this.isLive(page) ? -1 : page.level);
    return [...this.#pages.values()].sort((a, b) => rank(b) - rank(a));
  }

  /** @param {Page} page @returns {boolean} whether it can be a page of this terrain */
  put(page) {
    if (page.level > this.terrain.levels) return false;
    const all = levelPages(this.terrain, page.level);
    if (page.px >= all.x1 || page.pz >= all.z1) return false;
    const key = keyOf(page.level, page.px, page.pz);
    this.#pages.delete(key);
    this.#pages.set(key, page);
    for (const listener of this.listeners) listener.put?.(page);
    this.#shrink();
    return true;
  }

  /** Those outside of a changed place stay; the service keeps those that are live, the overview is asked for again. @param {Rect | null} rect_m `null`: everywhere */
  forget(rect_m) {
    for (const [key, page] of this.#pages) {
      if (this.isLive(page) || page.level === this.overviewLevel) continue;
      if (rect_m === null || overlap(this.rect_m(page), rect_m)) this.#drop(key, page);
    }
  }

  /** @param {Page} page @returns {Rect} */
  rect_m(page) {
    const { level, px, pz } = page;
    return pagesToMetres(this.terrain, level, { x0: px, z0: pz, x1: px + 1, z1: pz + 1 });
  }

  #shrink() {
    for (const [key, page] of this.#pages) {
      if (this.#pages.size <= MAX_KEPT_PAGES) return;
      if (!this.isLive(page) && page.level !== this.overviewLevel) this.#drop(key, page);
    }
  }

  /** @param {string} key @param {Page} page */
  #drop(key, page) {
    this.#pages.delete(key);
    for (const listener of this.listeners) listener.drop?.(page);
  }

  /** @param {number} level @param {number} i @param {number} j @returns {number | undefined} */
  sample_m(level, i, j) {
    const size = this.terrain.pageSize;
    const [px, pz] = [Math.floor(i / size), Math.floor(j / size)];
    const page = this.#pages.get(keyOf(level, px, pz));
    const [x, z] = [i - px * size, j - pz * size];
    return page && x < page.width && z < page.depth ? page.heights_m[z * page.width + x] : undefined;
  }

  /** Between the four samples around a place of a level. @param {number} level @param {number} x_m @param {number} z_m */
  #between_m(level, x_m, z_m) {
    const step_m = levelSpacing_m(this.terrain, level);
    const [x, z] = [x_m / step_m, z_m / step_m];
    const [i, j] = [Math.floor(x), Math.floor(z)];
    const nw = this.sample_m(level, i, j);
    if (nw === undefined) return undefined;
    // At the edge of what is known the next sample is as high as this one.
    const ne = this.sample_m(level, i + 1, j) ?? nw;
    const sw = this.sample_m(level, i, j + 1) ?? nw;
    const se = this.sample_m(level, i + 1, j + 1) ?? (ne + sw) / 2;
    const [u, v] = [x - i, z - j];
    return (nw * (1 - u) + ne * u) * (1 - v) + (sw * (1 - u) + se * u) * v;
  }

  /** Height of a place, from what is up to date, else from the finest there is. @param {number} x_m @param {number} z_m @returns {number | undefined} */
  height_m(x_m, z_m) {
    const { width, depth, spacing_m, levels } = this.terrain;
    const x = clamp(x_m, 0, (width - 1) * spacing_m);
    const z = clamp(z_m, 0, (depth - 1) * spacing_m);
    const best = this.live ? this.#between_m(this.live.level, x, z) : undefined;
    if (best !== undefined) return best;
    for (let level = 0; level <= levels; level += 1) {
      const height_m = this.#between_m(level, x, z);
      if (height_m !== undefined) return height_m;
    }
    return undefined;
  }
}
