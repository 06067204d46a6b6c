// The pages as pictures for the map: shaded when they come, a few milliseconds' worth a frame.

import { levelSpacing_m } from './grid.js';
import { keyOf } from './pages.js';
import { shade } from './relief.js';

const BUDGET_ms = 9;

/** @param {import('./frames.js').Page} page */
const whole = (page) => ({ x0: 0, z0: 0, x1: page.width, z1: page.depth });

export class Tiles {
  /** @type {Map<string, {canvas: HTMLCanvasElement, page: import('./frames.js').Page}>} */
  #tiles = new Map();
  /** @type {Map<string, import('./grid.js').Rect[]>} parts to shade, by page */
  #dirty = new Map();

  /** @param {import('./pages.js').PageStore} store @param {import('./relief.js').Range} range @param {() => void} changed */
  constructor(store, range, changed) {
    Object.assign(this, { store, range, changed });
    store.listeners.add({
      put: (page) => this.#put(page),
      drop: (page) => this.#drop(page),
      clear: () => {
        this.#tiles.clear();
        this.#dirty.clear();
        changed();
      },
    });
  }

  /** @param {import('./frames.js').Page} page */
  #put(page) {
    this.#mark(page, whole(page), true);
    // The slope at a neighbour's edge is measured across it.
    const { level, px, pz } = page;
    const edge = (dx, dz, part) => {
      const other = this.store.get(level, px + dx, pz + dz);
      if (other) this.#mark(other, part(other), false);
    };
    edge(-1, 0, (o) => ({ ...whole(o), x0: o.width - 1 }));
    edge(1, 0, (o) => ({ ...whole(o), x1: 1 }));
    edge(0, -1, (o) => ({ ...whole(o), z0: o.depth - 1 }));
    edge(0, 1, (o) => ({ ...whole(o), z1: 1 }));
    this.changed();
  }

  /** @param {import('./frames.js').Page} page @param {import('./grid.js').Rect} part @param {boolean} isAll */
  #mark(page, part, isAll) {
    const key = keyOf(page.level, page.px, page.pz);
    const parts = isAll ? [] : (this.#dirty.get(key) ?? []);
    this.#dirty.set(key, [...parts, part]);
  }

  /** @param {import('./frames.js').Page} page */
  #drop(page) {
    const key = keyOf(page.level, page.px, page.pz);
    this.#tiles.delete(key);
    this.#dirty.delete(key);
    this.changed();
  }

  /** All have other colours now. @param {import('./relief.js').Range} range */
  recolour(range) {
    this.range = range;
    for (const { page } of this.#tiles.values()) this.#mark(page, whole(page), true);
    this.changed();
  }

  /** Shades what there is time for. @returns {boolean} whether all is shaded */
  work() {
    const end_ms = performance.now() + BUDGET_ms;
    for (const [key, parts] of this.#dirty) {
      if (performance.now() > end_ms) return false;
      this.#dirty.delete(key);
      const [level, px, pz] = key.split('/').map(Number);
      const page = this.store.get(level, px, pz);
      if (page) this.#shade(key, page, parts);
    }
    return true;
  }

  /** @param {string} key @param {import('./frames.js').Page} page @param {import('./grid.js').Rect[]} parts */
  #shade(key, page, parts) {
    const { level, px, pz, width, depth } = page;
    let tile = this.#tiles.get(key);
    const isNew = !tile || tile.canvas.width !== width || tile.canvas.height !== depth;
    if (isNew) {
      const canvas = Object.assign(document.createElement('canvas'), { width, height: depth });
      tile = { canvas, pixels: new ImageData(width, depth), page };
      this.#tiles.set(key, tile);
    }
    tile.page = page;
    const at = (dx, dz) => this.store.get(level, px + dx, pz + dz);
    const near = { west: at(-1, 0), east: at(1, 0), north: at(0, -1), south: at(0, 1) };
    const step_m = levelSpacing_m(this.store.terrain, level);
    const context = tile.canvas.getContext('2d');
    for (const part of isNew ? [whole(page)] : parts) {
      shade(tile.pixels.data, page, near, step_m, this.range, part);
      context.putImageData(tile.pixels, 0, 0, part.x0, part.z0, part.x1 - part.x0, part.z1 - part.z0);
    }
  }

  /** @param {import('./frames.js').Page} page @returns {HTMLCanvasElement | undefined} */
  picture(page) {
    return this.#tiles.get(keyOf(page.level, page.px, page.pz))?.canvas;
  }
}
