// Rings on the ground of the 3D view: where pointers are, and how large their brushes.

import * as twgl from './vendor-twgl.js';
import { RING_FRAGMENT, RING_VERTEX } from './shaders.js';

const NUM_ANGLES = 97;
const ANGLES = Array.from({ length: NUM_ANGLES }, (_, k) => (2 * Math.PI * k) / (NUM_ANGLES - 1));
/** Width of a ring, as a share of the distance that it is seen from. */
const WIDTH = 0.0025;
const BLACK = [0, 0, 0, 1];
const WHITE = [1, 1, 1, 1];

export class Rings {
  /** @param {WebGL2RenderingContext} gl */
  constructor(gl) {
    this.gl = gl;
    this.program = twgl.createProgramInfo(gl, [RING_VERTEX, RING_FRAGMENT]);
    this.strip = twgl.createBufferInfoFromArrays(gl, {
      place: { numComponents: 3, data: new Float32Array(6 * NUM_ANGLES), drawType: gl.DYNAMIC_DRAW },
    });
  }

  /**
   * @param {import('./people.js').Cursor[]} cursors @param {import('./camera.js').Camera} camera @param {ArrayLike<number>} view_projection
   * @param {(x_m: number, z_m: number) => number} drawn_m height of the ground, as it is drawn
   */
  draw(cursors, camera, view_projection, drawn_m) {
    const { gl, program } = this;
    gl.useProgram(program.program);
    // Also those behind a hill are of interest.
    gl.disable(gl.DEPTH_TEST);
    const [eye_x, eye_y, eye_z] = camera.eye();
    for (const { x_m, z_m, radius_m, isOwn, rgb } of cursors) {
      const width_m = WIDTH * Math.hypot(x_m - eye_x, eye_y, z_m - eye_z);
      const ring = (inner_m, outer_m, tint) => {
        const place = (angle, far_m) => {
          const [x, z] = [x_m + Math.cos(angle) * far_m, z_m + Math.sin(angle) * far_m];
          return [x - camera.target[0], drawn_m(x, z) - camera.target[1], z - camera.target[2]];
        };
        const places = ANGLES.flatMap((angle) => [...place(angle, inner_m), ...place(angle, outer_m)]);
        twgl.setAttribInfoBufferFromArray(gl, this.strip.attribs.place, new Float32Array(places));
        twgl.setBuffersAndAttributes(gl, program, this.strip);
        twgl.setUniforms(program, { view_projection, tint });
        twgl.drawBufferInfo(gl, this.strip, gl.TRIANGLE_STRIP);
      };
      ring(radius_m - 0.5 * width_m, radius_m + 1.5 * width_m, BLACK);
      ring(radius_m, radius_m + width_m, isOwn ? WHITE : [...rgb, 1]);
    }
  }
}
