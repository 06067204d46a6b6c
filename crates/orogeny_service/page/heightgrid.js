// A rectangle of pages as one texture of heights, so that slopes go on across the pages' edges.

import { createTexture } from './vendor-twgl.js';
import { clamp, levelSize, levelSpacing_m, pagesOver } from './grid.js';
import { keyOf } from './pages.js';

/** Quads a side of the patch that everything is drawn with. */
export const PATCH = 64;

/** Corners and triangles of the patch with its skirt. */
export function patchArrays() {
  const side = PATCH + 1;
  const corner = [];
  const indices = [];
  const at = (x, z) => z * side + x;
  for (let z = 0; z < side; z += 1) for (let x = 0; x < side; x += 1) corner.push(x, z, 0);
  for (let z = 0; z < PATCH; z += 1) {
    for (let x = 0; x < PATCH; x += 1) indices.push(at(x, z), at(x, z + 1), at(x + 1, z), at(x + 1, z), at(x, z + 1), at(x + 1, z + 1));
  }
  const rim = [];
  for (let k = 0; k < PATCH; k += 1)
    rim.push(
      [
        [k, 0],
        [k + 1, 0],
      ],
      [
        [k, PATCH],
        [k + 1, PATCH],
      ],
      [
        [0, k],
        [0, k + 1],
      ],
      [
        [PATCH, k],
        [PATCH, k + 1],
      ],
    );
  for (const [[ax, az], [bx, bz]] of rim) {
    const below = corner.length / 3;
    corner.push(ax, az, 1, bx, bz, 1);
    indices.push(at(ax, az), below, at(bx, bz), at(bx, bz), below, below + 1);
  }
  return { corner: { numComponents: 3, data: new Float32Array(corner) }, indices: new Uint16Array(indices) };
}

export class HeightGrid {
  /** @type {Map<string, import('./frames.js').Page>} those to send to the texture */
  #dirty = new Map();
  /** @type {Set<string>} those that are in it */
  present = new Set();

  /**
   * @param {WebGL2RenderingContext} gl
   * @param {import('./pages.js').PageStore} store
   * @param {import('./grid.js').Selection} selection
   */
  constructor(gl, store, selection) {
    Object.assign(this, { gl, store, level: selection.level, pages: selection.pages });
    this.page = store.terrain.pageSize;
    const size = levelSize(store.terrain, this.level);
    const { x0, z0, x1, z1 } = this.pages;
    this.width = Math.min(x1 * this.page, size.width) - x0 * this.page;
    this.depth = Math.min(z1 * this.page, size.depth) - z0 * this.page;
    this.step_m = levelSpacing_m(store.terrain, this.level);
    this.origin_m = [x0 * this.page * this.step_m, z0 * this.page * this.step_m];
    this.texture = createTexture(gl, {
      width: this.width,
      height: this.depth,
      internalFormat: gl.R32F,
      format: gl.RED,
      type: gl.FLOAT,
      minMag: gl.NEAREST,
      wrap: gl.CLAMP_TO_EDGE,
      auto: false,
    });
    /** For each page whether it is there. */
    this.cover = createTexture(gl, {
      width: x1 - x0,
      height: z1 - z0,
      src: new Uint8Array((x1 - x0) * (z1 - z0)),
      internalFormat: gl.R8,
      format: gl.RED,
      type: gl.UNSIGNED_BYTE,
      minMag: gl.NEAREST,
      wrap: gl.CLAMP_TO_EDGE,
      auto: false,
      unpackAlignment: 1,
    });
    for (let pz = z0; pz < z1; pz += 1) {
      for (let px = x0; px < x1; px += 1) {
        const page = store.get(this.level, px, pz);
        if (page) this.put(page);
      }
    }
  }

  /** Whether a page is one of these. @param {import('./frames.js').Page} page */
  has({ level, px, pz }) {
    const { x0, z0, x1, z1 } = this.pages;
    return level === this.level && px >= x0 && px < x1 && pz >= z0 && pz < z1;
  }

  /** @param {import('./frames.js').Page} page */
  put(page) {
    if (this.has(page)) this.#dirty.set(keyOf(page.level, page.px, page.pz), page);
  }

  /** Sends what changed, and nothing else. */
  upload() {
    const { gl, page: size } = this;
    if (this.#dirty.size === 0) return;
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    for (const [key, page] of this.#dirty) {
      const [x, y] = [(page.px - this.pages.x0) * size, (page.pz - this.pages.z0) * size];
      if (x + page.width > this.width || y + page.depth > this.depth) continue;
      gl.texSubImage2D(gl.TEXTURE_2D, 0, x, y, page.width, page.depth, gl.RED, gl.FLOAT, page.heights_m);
      this.present.add(key);
    }
    gl.bindTexture(gl.TEXTURE_2D, this.cover);
    const there = new Uint8Array([255]);
    for (const page of this.#dirty.values())
      gl.texSubImage2D(gl.TEXTURE_2D, 0, page.px - this.pages.x0, page.pz - this.pages.z0, 1, 1, gl.RED, gl.UNSIGNED_BYTE, there);
    this.#dirty.clear();
  }

  /**
   * What is to be drawn: more samples a quad where it is further off.
   * @param {(x_m: number, z_m: number) => number} distance_m of the camera from a place
   * @param {number} full_m up to here every sample is drawn
   */
  *patches(distance_m, full_m) {
    const { page: size } = this;
    for (const key of this.present) {
      const [, px, pz] = key.split('/').map(Number);
      const [x, z] = [(px - this.pages.x0) * size, (pz - this.pages.z0) * size];
      const middle = [0, 1].map((i) => this.origin_m[i] + ([x, z][i] + size / 2) * this.step_m);
      const far = Math.max(distance_m(...middle) - (size / 2) * this.step_m, 0) / full_m;
      const stride = 2 ** clamp(Math.ceil(Math.log2(Math.max(far, 1))), 0, 2);
      const isThere = (dx, dz) => this.present.has(keyOf(this.level, px + dx, pz + dz));
      // The quads of a page reach to the next page's first samples, where these are known.
      const last = [
        Math.min(x + size - (isThere(1, 0) ? 0 : 1), this.width - 1),
        Math.min(z + size - (isThere(0, 1) ? 0 : 1), this.depth - 1),
      ];
      for (let dz = 0; dz < size && z + dz < this.depth; dz += PATCH * stride) {
        for (let dx = 0; dx < size && x + dx < this.width; dx += PATCH * stride) {
          const first = [x + dx, z + dz];
          const end = first.map((from, i) => Math.min(from + PATCH * stride, last[i]));
          const [x0, z0, x1, z1] = [...first, ...end].map((sample, i) => this.origin_m[i % 2] + sample * this.step_m);
          yield { first, last, stride, place_m: { x0, z0, x1, z1 } };
        }
      }
    }
  }

  /** Whether all of a place is here. @param {import('./grid.js').Rect} place_m */
  covers(place_m) {
    const { x0, z0, x1, z1 } = pagesOver(this.store.terrain, this.level, place_m);
    for (let pz = z0; pz < z1; pz += 1) {
      for (let px = x0; px < x1; px += 1) if (!this.present.has(keyOf(this.level, px, pz))) return false;
    }
    return true;
  }

  free() {
    this.gl.deleteTexture(this.texture);
    this.gl.deleteTexture(this.cover);
  }
}
