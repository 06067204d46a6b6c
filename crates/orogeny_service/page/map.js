// The map: the terrain from above, north at the top.

import { clamp, extent, levelSpacing_m } from './grid.js';
import { cssOf } from './people.js';
import { Tiles } from './tiles.js';

const CLOSEST_px_A_SAMPLE = 24;

/** 1, 2 or 5 times a power of ten, at most `value`. @param {number} value */
function roundDown(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [5, 2, 1].find((factor) => factor * power <= value) * power;
}

/** @param {number} value_m */
export const lengthText = (value_m) => (value_m >= 1000 ? `${+(value_m / 1000).toPrecision(3)} km` : `${+value_m.toPrecision(3)} m`);

export class MapView {
  #isWanted = false;
  #size = { width: 1, height: 1, ratio: 1 };

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {import('./pages.js').PageStore} store
   * @param {{range: import('./relief.js').Range, cursors(): import('./people.js').Cursor[], moved(): void}} scene
   */
  constructor(canvas, store, scene) {
    Object.assign(this, { canvas, store, scene });
    this.context = canvas.getContext('2d');
    this.tiles = new Tiles(store, scene.range, () => this.redraw());
    this.centre = { x_m: 0, z_m: 0 };
    this.m_per_px = 1;
    new ResizeObserver(() => this.#resized()).observe(canvas);
  }

  get isShown() {
    return this.canvas.clientWidth > 0;
  }

  #resized() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    const ratio = window.devicePixelRatio || 1;
    const wasHidden = this.#size.width <= 1;
    this.#size = { width, height, ratio };
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    if (wasHidden || this.isFitted) this.fit();
    this.draw();
    this.scene.moved();
  }

  /** Shows all. */
  fit() {
    const { width_m, depth_m } = extent(this.store.terrain);
    this.centre = { x_m: width_m / 2, z_m: depth_m / 2 };
    this.m_per_px = this.#furthest();
    this.isFitted = true;
    this.#moved();
  }

  #furthest() {
    const { width_m, depth_m } = extent(this.store.terrain);
    return 1.04 * Math.max(width_m / this.#size.width, depth_m / this.#size.height);
  }

  #moved() {
    const { width_m, depth_m } = extent(this.store.terrain);
    this.centre = { x_m: clamp(this.centre.x_m, 0, width_m), z_m: clamp(this.centre.z_m, 0, depth_m) };
    this.redraw();
    this.scene.moved();
  }

  /** @param {number} dx_px @param {number} dy_px */
  pan(dx_px, dy_px) {
    this.centre = { x_m: this.centre.x_m - dx_px * this.m_per_px, z_m: this.centre.z_m - dy_px * this.m_per_px };
    this.isFitted = false;
    this.#moved();
  }

  /** A map does not turn; it goes along. @param {number} dx_px @param {number} dy_px */
  turn(dx_px, dy_px) {
    this.pan(dx_px, dy_px);
  }

  /** The place under the pointer stays there. @param {number} factor above 1: closer @param {{x: number, y: number}} [at] pixels */
  zoom(factor, at = { x: this.#size.width / 2, y: this.#size.height / 2 }) {
    const before = this.#toGround(at);
    const closest = this.store.terrain.spacing_m / CLOSEST_px_A_SAMPLE;
    this.m_per_px = clamp(this.m_per_px / factor, closest, 2 * this.#furthest());
    const after = this.#toGround(at);
    this.centre = { x_m: this.centre.x_m + before.x_m - after.x_m, z_m: this.centre.z_m + before.z_m - after.z_m };
    this.isFitted = false;
    this.#moved();
  }

  #toGround({ x, y }) {
    return {
      x_m: this.centre.x_m + (x - this.#size.width / 2) * this.m_per_px,
      z_m: this.centre.z_m + (y - this.#size.height / 2) * this.m_per_px,
    };
  }

  /** @param {{x_m: number, z_m: number}} place @returns {{x: number, y: number}} pixels of the page */
  toPixels({ x_m, z_m }) {
    return {
      x: (x_m - this.centre.x_m) / this.m_per_px + this.#size.width / 2,
      y: (z_m - this.centre.z_m) / this.m_per_px + this.#size.height / 2,
    };
  }

  /** The place under the pointer, also beyond the border: strokes may come from there. @param {{x: number, y: number}} at */
  pick(at) {
    return this.#toGround(at);
  }

  middle() {
    return this.centre;
  }

  /** What is seen, and how finely. */
  seen() {
    const [nw, se] = [this.#toGround({ x: 0, y: 0 }), this.#toGround({ x: this.#size.width, y: this.#size.height })];
    return { rect_m: { x0: nw.x_m, z0: nw.z_m, x1: se.x_m, z1: se.z_m }, wanted_m: (1.4 * this.m_per_px) / this.#size.ratio };
  }

  /** Draws before the next picture is shown. */
  redraw() {
    if (this.#isWanted) return;
    this.#isWanted = true;
    requestAnimationFrame(() => {
      this.#isWanted = false;
      if (!this.tiles.work()) this.redraw();
      if (this.isShown) this.draw();
    });
  }

  draw() {
    const { context, canvas } = this;
    const { width, height, ratio } = this.#size;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = getComputedStyle(canvas.parentElement).backgroundColor;
    context.fillRect(0, 0, width, height);
    this.#drawPages();
    for (const cursor of this.scene.cursors()) this.#drawCursor(cursor);
    this.#drawScale();
  }

  #drawPages() {
    const { context, store } = this;
    const { width, height, ratio } = this.#size;
    for (const page of store.inOrder()) {
      const picture = this.tiles.picture(page);
      if (!picture) continue;
      const step_m = levelSpacing_m(store.terrain, page.level);
      const size = store.terrain.pageSize;
      // A sample is a square about its place.
      const corner = (i, j) => this.toPixels({ x_m: (i - 0.5) * step_m, z_m: (j - 0.5) * step_m });
      const snap = (value) => Math.round(value * ratio) / ratio;
      const [a, b] = [corner(page.px * size, page.pz * size), corner(page.px * size + page.width, page.pz * size + page.depth)];
      const [x0, y0, x1, y1] = [a.x, a.y, b.x, b.y].map(snap);
      if (x1 < 0 || y1 < 0 || x0 > width || y0 > height) continue;
      context.imageSmoothingEnabled = step_m / this.m_per_px < 4;
      context.imageSmoothingQuality = 'medium';
      context.drawImage(picture, x0, y0, x1 - x0, y1 - y0);
    }
  }

  /** @param {import('./people.js').Cursor} cursor */
  #drawCursor({ author, x_m, z_m, radius_m, isOwn, rgb }) {
    const { context } = this;
    const { x, y } = this.toPixels({ x_m, z_m });
    const radius = Math.max(radius_m / this.m_per_px, 2);
    const ring = (lineWidth, style) => {
      context.lineWidth = lineWidth;
      context.strokeStyle = style;
      context.beginPath();
      context.arc(x, y, radius, 0, 2 * Math.PI);
      context.stroke();
    };
    ring(3, 'rgb(0 0 0 / .55)');
    ring(1.5, isOwn ? '#fff' : cssOf(rgb));
    if (isOwn) return;
    context.font = '600 12px system-ui, sans-serif';
    const width = context.measureText(author).width + 10;
    context.fillStyle = 'rgb(0 0 0 / .65)';
    context.fillRect(x - width / 2, y + radius + 5, width, 18);
    context.fillStyle = '#fff';
    context.textAlign = 'center';
    context.fillText(author, x, y + radius + 18);
  }

  #drawScale() {
    const { context } = this;
    if (this.store.terrain.name === '') return;
    const length_m = roundDown(Math.min(140, this.#size.width / 4) * this.m_per_px);
    const length = length_m / this.m_per_px;
    context.fillStyle = 'rgb(0 0 0 / .6)';
    context.fillRect(10, 10, Math.max(length, 50) + 16, 28);
    context.fillStyle = '#fff';
    context.fillRect(18, 30, length, 3);
    context.font = '12px system-ui, sans-serif';
    context.textAlign = 'left';
    context.fillText(lengthText(length_m), 18, 25);
  }
}
