// A camera that looks at a place of the ground and goes around it. y is up.

import { m4, v3 } from './vendor-twgl.js';
import { clamp, extent } from './grid.js';

const FIELD_OF_VIEW = Math.PI / 4.5;
const LOWEST = 0.06;
const HIGHEST = Math.PI / 2 - 0.01;
const TURN_PER_px = 0.006;

export class Camera {
  /** @type {number[]} what is looked at; its height is that of the ground, drawn */
  target = [0, 0, 0];
  distance_m = 1;
  /** From where, clockwise from the south; and how far from above. */
  yaw = 0.5;
  pitch = 0.75;

  /** All of it is seen. @param {import('./grid.js').Terrain} terrain @param {number} aspect of the view, width over height */
  fit(terrain, aspect) {
    const { width_m, depth_m } = extent(terrain);
    this.limits = { width_m, depth_m, nearest_m: 6 * terrain.spacing_m, furthest_m: 5 * Math.max(width_m, depth_m) };
    this.target = [width_m / 2, this.target[1], depth_m / 2];
    this.distance_m = (1.3 * Math.max(width_m, depth_m)) / clamp(aspect, 0.5, 1.15);
    [this.yaw, this.pitch] = [0.5, 0.75];
  }

  /** Where the eye is, relative to the target. */
  #offset() {
    const flat = Math.cos(this.pitch) * this.distance_m;
    return [Math.sin(this.yaw) * flat, Math.sin(this.pitch) * this.distance_m, Math.cos(this.yaw) * flat];
  }

  eye() {
    return v3.add(this.target, this.#offset());
  }

  /** @param {number} dx_px @param {number} dy_px */
  turn(dx_px, dy_px) {
    this.yaw -= dx_px * TURN_PER_px;
    this.pitch = clamp(this.pitch + dy_px * TURN_PER_px, LOWEST, HIGHEST);
  }

  /** Moves along the ground. @param {number} dx_px @param {number} dy_px @param {number} height_px of the view */
  pan(dx_px, dy_px, height_px) {
    const m_per_px = (2 * Math.tan(FIELD_OF_VIEW / 2) * this.distance_m) / height_px;
    const [sin, cos] = [Math.sin(this.yaw), Math.cos(this.yaw)];
    const [right, near] = [-dx_px * m_per_px, (-dy_px * m_per_px) / Math.max(Math.sin(this.pitch), 0.3)];
    this.#moveTo(this.target[0] + right * cos + near * sin, this.target[2] - right * sin + near * cos);
  }

  #moveTo(x_m, z_m) {
    this.target = [clamp(x_m, 0, this.limits.width_m), this.target[1], clamp(z_m, 0, this.limits.depth_m)];
  }

  /** @param {number} factor above 1: closer @param {{x_m: number, z_m: number} | null} towards stays about where it is */
  zoom(factor, towards) {
    const before_m = this.distance_m;
    this.distance_m = clamp(before_m / factor, this.limits.nearest_m, this.limits.furthest_m);
    if (!towards) return;
    const share = clamp(1 - this.distance_m / before_m, -1, 1);
    const [x, , z] = this.target;
    this.#moveTo(x + (towards.x_m - x) * share, z + (towards.z_m - z) * share);
  }

  /**
   * World to clip space. The world's origin is the target here, so that far-off places do not shake.
   * @param {number} aspect width over height
   */
  viewProjection(aspect) {
    const projection = m4.perspective(FIELD_OF_VIEW, aspect, this.distance_m / 80, this.distance_m * 40 + this.limits.furthest_m);
    const view = m4.inverse(m4.lookAt(this.#offset(), [0, 0, 0], [0, 1, 0]));
    return m4.multiply(projection, view);
  }

  /** A ray through a place of the view. @param {number} u -1..1, to the right @param {number} v -1..1, up @param {number} aspect */
  ray(u, v, aspect) {
    const half = Math.tan(FIELD_OF_VIEW / 2);
    const [right, up, back] = [0, 4, 8].map((at) => [...m4.lookAt(this.#offset(), [0, 0, 0], [0, 1, 0]).slice(at, at + 3)]);
    const direction = v3.add(v3.add(v3.mulScalar(right, u * half * aspect), v3.mulScalar(up, v * half)), v3.negate(back));
    return { from: this.eye(), direction: v3.normalize(direction) };
  }
}

/**
 * Whether a box can be in the picture: it cannot where all its corners are beyond one of its sides.
 * @param {ArrayLike<number>} view_projection @param {number[]} low x, y, z @param {number[]} high
 */
export function isInPicture(view_projection, low, high) {
  const m = view_projection;
  const outside = new Array(6).fill(0);
  for (let corner = 0; corner < 8; corner += 1) {
    const [x, y, z] = [0, 1, 2].map((i) => ((corner >> i) & 1 ? high : low)[i]);
    const [cx, cy, cz, cw] = [0, 1, 2, 3].map((row) => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row]);
    [cx < -cw, cx > cw, cy < -cw, cy > cw, cz < -cw, cz > cw].forEach((isOut, side) => {
      outside[side] += isOut ? 1 : 0;
    });
  }
  return outside.every((count) => count < 8);
}

/**
 * Where a ray meets the ground: goes along it in steps that grow with the distance, then halves the last one.
 * @param {{from: ArrayLike<number>, direction: ArrayLike<number>}} ray
 * @param {(x_m: number, z_m: number) => number | undefined} height_m as drawn
 * @param {{x0: number, z0: number, x1: number, z1: number, low: number, high: number}} box
 * @param {number} step_m the shortest
 * @returns {{x_m: number, z_m: number} | null}
 */
export function meet({ from, direction }, height_m, box, step_m) {
  const at = (t) => [0, 1, 2].map((i) => from[i] + t * direction[i]);
  const above = (t) => {
    const [x, y, z] = at(t);
    return y - (height_m(x, z) ?? box.low);
  };
  let [begin, end] = [0, Infinity];
  for (const [i, low, high] of [
    [0, box.x0, box.x1],
    [1, box.low, box.high],
    [2, box.z0, box.z1],
  ]) {
    if (Math.abs(direction[i]) < 1e-9) {
      if (from[i] < low || from[i] > high) return null;
      continue;
    }
    const [a, b] = [(low - from[i]) / direction[i], (high - from[i]) / direction[i]];
    [begin, end] = [Math.max(begin, Math.min(a, b)), Math.min(end, Math.max(a, b))];
  }
  if (begin > end) return null;
  let before = begin;
  for (let t = begin, n = 0; t <= end && n < 3000; n += 1) {
    if (above(t) <= 0) {
      let [high, low] = [before, t];
      for (let k = 0; k < 24; k += 1) {
        const middle = (high + low) / 2;
        if (above(middle) <= 0) low = middle;
        else high = middle;
      }
      const [x_m, , z_m] = at(low);
      return { x_m, z_m };
    }
    before = t;
    // Half of what is below, as slopes seldom are steeper than that.
    t += Math.max(step_m, 0.4 * above(t), 0.0008 * t);
  }
  const [x_m, , z_m] = at(end);
  return above(end) <= step_m ? { x_m, z_m } : null;
}
