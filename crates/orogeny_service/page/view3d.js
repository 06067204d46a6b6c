// The terrain in 3D, drawn from the same pages as the map.

import * as twgl from './vendor-twgl.js';
import { Camera, isInPicture, meet } from './camera.js';
import { extent, levelPages, levelSpacing_m } from './grid.js';
import { HeightGrid, patchArrays } from './heightgrid.js';
import { Pacing, hasGraphicsCard } from './pacing.js';
import { PALETTE, ROCK_SLOPE, SUN } from './relief.js';
import { Rings } from './rings.js';
import { GROUND_FRAGMENT, GROUND_VERTEX } from './shaders.js';

/** Nearer than so many samples every one is a corner of a triangle. */
const FULL_DETAIL = 180;
const SHARP_AFTER_ms = 350;

/** @param {string} css `rgb(…)` @returns {number[]} 0..1 */
const rgbOf = (css) => (css.match(/[\d.]+/g) ?? [0, 0, 0]).slice(0, 3).map((value) => value / 255);

export class View3d {
  #isWanted = false;
  #sharpTimer = 0;
  /** @type {HeightGrid | null} */
  #fine = null;
  /** @type {HeightGrid | null} */
  #coarse = null;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {import('./pages.js').PageStore} store
   * @param {{range: import('./relief.js').Range, cursors(): import('./people.js').Cursor[], moved(): void}} scene
   */
  constructor(canvas, store, scene) {
    Object.assign(this, { canvas, store, scene, exaggeration: 1 });
    this.camera = new Camera();
    this.camera.fit(store.terrain, 1);
    this.isFast = hasGraphicsCard();
    // Without a graphics card it is drawn all the same, only less finely.
    const gl = canvas.getContext('webgl2', { antialias: this.isFast, powerPreference: 'high-performance' });
    /** Whether this browser can draw it. */
    this.isAble = gl !== null;
    if (!gl) return;
    this.gl = gl;
    this.#begin();
    canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    canvas.addEventListener('webglcontextrestored', () => this.#begin());
    new ResizeObserver(() => (this.isFitted ? this.fit() : this.redraw())).observe(canvas);
    store.listeners.add({
      put: (page) => {
        this.#fine?.put(page);
        this.#coarse?.put(page);
        this.redraw();
      },
      clear: () => this.#forget(),
    });
  }

  #begin() {
    const { gl } = this;
    this.ground = twgl.createProgramInfo(gl, [GROUND_VERTEX, GROUND_FRAGMENT]);
    this.patch = twgl.createBufferInfoFromArrays(gl, patchArrays());
    // A driver that does not take them is one that cannot draw this.
    this.isAble = this.ground !== null && this.ground !== undefined;
    if (!this.isAble) return;
    this.rings = new Rings(gl);
    this.pacing = new Pacing(gl, this.isFast);
    this.palette = twgl.createTexture(gl, {
      width: PALETTE.length / 4,
      height: 1,
      src: PALETTE,
      minMag: gl.LINEAR,
      wrap: gl.CLAMP_TO_EDGE,
    });
    [this.#fine, this.#coarse] = [null, null];
    this.redraw();
  }

  #forget() {
    this.#fine?.free();
    this.#coarse?.free();
    [this.#fine, this.#coarse] = [null, null];
    this.redraw();
  }

  /** Another part of the terrain is kept up to date now. */
  selected() {
    if (!this.isAble) return;
    this.#fine?.free();
    this.#fine = null;
    this.redraw();
  }

  get isShown() {
    return this.isAble && this.canvas.clientWidth > 0;
  }

  get #aspect() {
    const { clientWidth, clientHeight } = this.canvas;
    return clientWidth > 0 && clientHeight > 0 ? clientWidth / clientHeight : 1;
  }

  fit() {
    this.camera.fit(this.store.terrain, this.#aspect);
    this.#moved(true);
  }

  /** @param {boolean} [isFitted] */
  #moved(isFitted = false) {
    this.isFitted = isFitted;
    this.redraw();
    this.scene.moved();
  }

  /** @param {number} dx_px @param {number} dy_px */
  pan(dx_px, dy_px) {
    this.camera.pan(dx_px, dy_px, this.canvas.clientHeight);
    this.#moved();
  }

  /** @param {number} dx_px @param {number} dy_px */
  turn(dx_px, dy_px) {
    this.camera.turn(dx_px, dy_px);
    this.#moved();
  }

  /** @param {number} factor @param {{x: number, y: number}} [at] */
  zoom(factor, at) {
    this.camera.zoom(factor, at ? this.pick(at) : null);
    this.#moved();
  }

  /** @param {number} factor */
  exaggerate(factor) {
    this.exaggeration = factor;
    this.redraw();
  }

  /** The place of the ground under the pointer. @param {{x: number, y: number}} at @returns {{x_m: number, z_m: number} | null} */
  pick({ x, y }) {
    if (!this.isAble) return null;
    const { clientWidth, clientHeight } = this.canvas;
    const ray = this.camera.ray((2 * x) / clientWidth - 1, 1 - (2 * y) / clientHeight, this.#aspect);
    const { width_m, depth_m } = extent(this.store.terrain);
    const { low_m, high_m } = this.scene.range;
    const slack_m = 0.5 * (high_m - low_m) + this.store.terrain.spacing_m;
    const [low, high] = [low_m - slack_m, high_m + slack_m].map((height_m) => this.#drawn(height_m));
    const drawn = (x_m, z_m) => this.#drawn(this.store.height_m(x_m, z_m) ?? low_m);
    const step_m = levelSpacing_m(this.store.terrain, this.store.live?.level ?? 0) / 2;
    return meet(ray, drawn, { x0: 0, z0: 0, x1: width_m, z1: depth_m, low, high }, step_m);
  }

  middle() {
    return { x_m: this.camera.target[0], z_m: this.camera.target[2] };
  }

  seen() {
    const [x, , z] = this.camera.target;
    const reach_m = 0.9 * this.camera.distance_m;
    return { rect_m: { x0: x - reach_m, z0: z - reach_m, x1: x + reach_m, z1: z + reach_m }, wanted_m: this.camera.distance_m / 650 };
  }

  /** @param {number} height_m @returns {number} where it is drawn */
  #drawn(height_m) {
    return (height_m - this.scene.range.low_m) * this.exaggeration;
  }

  redraw() {
    if (this.#isWanted || !this.isAble) return;
    this.#isWanted = true;
    clearTimeout(this.#sharpTimer);
    const draw = () => {
      if (!this.pacing.isReady) {
        requestAnimationFrame(draw);
        return;
      }
      this.#isWanted = false;
      if (!this.isShown || this.gl.isContextLost()) return;
      const { scale } = this.pacing;
      this.#draw(scale);
      if (scale < 1) this.#sharpenSoon();
    };
    requestAnimationFrame(draw);
  }

  /** Once all is at rest there is time for a picture without compromise. */
  #sharpenSoon() {
    clearTimeout(this.#sharpTimer);
    this.#sharpTimer = setTimeout(() => {
      if (this.#isWanted || !this.isShown || this.gl.isContextLost()) return;
      if (this.pacing.isReady) this.#draw(1);
      else this.#sharpenSoon();
    }, SHARP_AFTER_ms);
  }

  #grids() {
    const { gl, store } = this;
    if (!this.#fine && store.live) this.#fine = new HeightGrid(gl, store, store.live);
    const level = store.overviewLevel;
    this.#coarse ??= new HeightGrid(gl, store, { level, pages: levelPages(store.terrain, level) });
    this.#fine?.upload();
    this.#coarse.upload();
  }

  /** @param {number} scale share of the full resolution and detail */
  #draw(scale) {
    const { gl, camera, store } = this;
    const begin_ms = performance.now();
    this.#grids();
    // The target keeps to the ground, unless it was far off anyway.
    camera.target[1] = this.#drawn(store.height_m(camera.target[0], camera.target[2]) ?? this.scene.range.low_m);
    twgl.resizeCanvasToDisplaySize(this.canvas, Math.min(window.devicePixelRatio || 1, 2) * scale);
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    const sky = rgbOf(getComputedStyle(this.canvas.parentElement).backgroundColor);
    gl.clearColor(...sky, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    const view_projection = camera.viewProjection(this.#aspect);
    gl.useProgram(this.ground.program);
    twgl.setBuffersAndAttributes(gl, this.ground, this.patch);
    const { low_m, high_m } = this.scene.range;
    twgl.setUniforms(this.ground, {
      view_projection,
      sky,
      sun: SUN,
      rock_slope: ROCK_SLOPE,
      palette: this.palette,
      range_m: [low_m, high_m],
      exaggeration: this.exaggeration,
      base_m: low_m + camera.target[1] / this.exaggeration,
      far_m: Math.max(4 * camera.distance_m, camera.limits.furthest_m / 4),
    });
    const uncovered = { cover: this.palette, cover_pages: [0, 0] };
    const isSeen = (place_m) => this.#isSeen(view_projection, place_m);
    const full_detail = FULL_DETAIL * scale;
    if (this.#fine) this.#drawGrid(this.#fine, uncovered, isSeen, full_detail);
    const isBare = (place_m) => !this.#fine?.covers(place_m) && isSeen(place_m);
    this.#drawGrid(this.#coarse, this.#fine ? this.#coverOf() : uncovered, isBare, full_detail);
    const drawn_m = (x_m, z_m) => this.#drawn(store.height_m(x_m, z_m) ?? low_m);
    this.rings.draw(this.scene.cursors(), camera, view_projection, drawn_m);
    this.pacing.drawn(begin_ms, scale < 1 || this.pacing.scale === 1);
  }

  /** Where the coarse ground gives way to the fine one. @returns {object} uniforms */
  #coverOf() {
    const fine = this.#fine;
    const { target } = this.camera;
    const { width_m, depth_m } = extent(this.store.terrain);
    return {
      cover: fine.cover,
      cover_pages: [fine.pages.x1 - fine.pages.x0, fine.pages.z1 - fine.pages.z0],
      cover_origin_m: [fine.origin_m[0] - target[0], fine.origin_m[1] - target[2]],
      cover_page_m: fine.page * fine.step_m,
      cover_margin_m: Math.max(this.#coarse.step_m, fine.step_m),
      terrain_m: [-target[0], -target[2], width_m - target[0], depth_m - target[2]],
    };
  }

  /** @param {ArrayLike<number>} view_projection @param {import('./grid.js').Rect} place_m */
  #isSeen(view_projection, { x0, z0, x1, z1 }) {
    const { low_m, high_m } = this.scene.range;
    // A stroke on its way may reach beyond what the range was when it began.
    const slack_m = high_m - low_m;
    const [x, y, z] = this.camera.target;
    const [low, high] = [low_m - slack_m, high_m + slack_m].map((height_m) => this.#drawn(height_m) - y);
    return isInPicture(view_projection, [x0 - x, low, z0 - z], [x1 - x, high, z1 - z]);
  }

  /** @param {HeightGrid} grid @param {object} cover uniforms @param {(place_m: import('./grid.js').Rect) => boolean} isWanted @param {number} full_detail samples */
  #drawGrid(grid, cover, isWanted, full_detail) {
    const { gl, camera } = this;
    const eye = camera.eye();
    const distance_m = (x_m, z_m) => Math.hypot(x_m - eye[0], eye[1], z_m - eye[2]);
    const origin_m = [grid.origin_m[0] - camera.target[0], grid.origin_m[1] - camera.target[2]];
    twgl.setUniforms(this.ground, { heights: grid.texture, step_m: grid.step_m, origin_m, ...cover });
    for (const { first, last, stride, place_m } of grid.patches(distance_m, full_detail * grid.step_m)) {
      if (!isWanted(place_m)) continue;
      twgl.setUniforms(this.ground, { first, last, stride, skirt_m: 2 * stride * grid.step_m });
      twgl.drawBufferInfo(gl, this.patch);
    }
  }
}
