// Coarse heights of all of the terrain, by HTTP: what is seen where nothing is subscribed to.

import { get, terrainPath } from './api.js';
import { levelPages, levelSpacing_m, overlap, pagesToMetres } from './grid.js';

const WAIT_ms = 250;

export class Overview {
  #dirty = new Set();
  #timer = 0;
  #isBusy = false;
  #abort = new AbortController();

  /** @param {import('./pages.js').PageStore} store @param {(why: string) => void} failed */
  constructor(store, failed) {
    Object.assign(this, { store, failed });
  }

  /** Marks what is to be asked for anew. @param {import('./grid.js').Rect | null} rect_m `null`: all */
  touch(rect_m) {
    const { terrain, overviewLevel: level } = this.store;
    const all = levelPages(terrain, level);
    for (let pz = 0; pz < all.z1; pz += 1) {
      for (let px = 0; px < all.x1; px += 1) {
        const page_m = pagesToMetres(terrain, level, { x0: px, z0: pz, x1: px + 1, z1: pz + 1 });
        if (rect_m === null || overlap(page_m, rect_m)) this.#dirty.add(`${px},${pz}`);
      }
    }
    // Many strokes after one another are asked for once.
    if (!this.#timer && !this.#isBusy) this.#timer = setTimeout(() => this.#fetch(), WAIT_ms);
  }

  /** Forgets what is under way: another terrain begins. */
  stop() {
    clearTimeout(this.#timer);
    this.#timer = 0;
    this.#dirty.clear();
    this.#abort.abort();
    this.#abort = new AbortController();
  }

  async #fetch() {
    this.#timer = 0;
    this.#isBusy = true;
    const { signal } = this.#abort;
    try {
      while (this.#dirty.size > 0 && !signal.aborted) {
        const [next] = this.#dirty;
        this.#dirty.delete(next);
        const [px, pz] = next.split(',').map(Number);
        // The live channel brings these.
        if (!this.store.isLive({ level: this.store.overviewLevel, px, pz })) await this.#fetchPage(px, pz, signal);
      }
    } catch (error) {
      if (!signal.aborted) this.failed(`heights of the whole terrain could not be had: ${error.message}`);
    } finally {
      this.#isBusy = false;
      // What was marked meanwhile, perhaps of another terrain.
      if (this.#dirty.size > 0 && !this.#timer) this.#timer = setTimeout(() => this.#fetch(), WAIT_ms);
    }
  }

  /** @param {number} px @param {number} pz @param {AbortSignal} signal */
  async #fetchPage(px, pz, signal) {
    const { terrain, overviewLevel: level } = this.store;
    const all_m = { x1: terrain.width * terrain.spacing_m, z1: terrain.depth * terrain.spacing_m };
    const { x0, z0, x1, z1 } = pagesToMetres(terrain, level, { x0: px, z0: pz, x1: px + 1, z1: pz + 1 });
    const query = new URLSearchParams({
      x: x0,
      z: z0,
      width: Math.min(x1, all_m.x1) - x0,
      depth: Math.min(z1, all_m.z1) - z0,
      level,
      format: 'r32',
    });
    const response = await get(`${terrainPath(terrain.name)}/heights?${query}`, signal);
    const number = (name) => Number(response.headers.get(`orogeny-${name}`));
    const [width, depth] = [number('width'), number('depth')];
    const data = new DataView(await response.arrayBuffer());
    const isThere = Math.abs(number('x') - x0) + Math.abs(number('z') - z0) < levelSpacing_m(terrain, level) / 2;
    const isWhole =
      width > 0 && depth > 0 && width <= terrain.pageSize && depth <= terrain.pageSize && data.byteLength === 4 * width * depth;
    if (!isThere || !isWhole) throw new Error('the answer is not of the place that was asked for');
    if (signal.aborted || this.store.isLive({ level, px, pz })) return;
    const heights_m = Float32Array.from({ length: width * depth }, (_, i) => data.getFloat32(4 * i, true));
    this.store.put({ level, px, pz, width, depth, revision: 0, heights_m });
  }
}
