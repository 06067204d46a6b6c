// Draws no more pictures than the graphics card has time for, and coarser ones where it is slow, so that the page stays at hand.

// Measured in steps of a picture of the screen, some 17 ms.
const SLOW_ms = 75;
const FAST_ms = 38;
const ABSENT_ms = 3000;
const COARSEST = 0.5;

/** Browsers draw WebGL on the processor where there is no card, and say so in its name alone. */
export function hasGraphicsCard() {
  const gl = document.createElement('canvas').getContext('webgl2');
  const about = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = about ? gl.getParameter(about.UNMASKED_RENDERER_WEBGL) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return gl !== null && !/swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

export class Pacing {
  /** @type {{fence: WebGLSync, begin_ms: number, counts: boolean} | null} */
  #pending = null;
  /** Until then the page's other work goes first. */
  #rest_until_ms = 0;

  /** @param {WebGL2RenderingContext} gl @param {boolean} isFast whether there is a graphics card */
  constructor(gl, isFast) {
    this.gl = gl;
    /** Share of the full resolution. */
    this.scale = isFast ? 1 : COARSEST;
  }

  /** Whether another picture may be asked for. */
  get isReady() {
    return !this.#pending && performance.now() >= this.#rest_until_ms;
  }

  /** A picture was asked for. @param {number} begin_ms @param {boolean} counts whether it tells how fine the next ones may be */
  drawn(begin_ms, counts) {
    const { gl } = this;
    this.#pending = { fence: gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0), begin_ms, counts };
    gl.flush();
    const look = () => {
      if (!this.#finish()) requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  }

  /** @returns {boolean} whether the last picture is done */
  #finish() {
    const { gl } = this;
    const { fence, begin_ms, counts } = this.#pending;
    // A lost context has no fences, and nothing that one would wait for.
    if (!gl.isContextLost() && gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) return false;
    gl.deleteSync(fence);
    this.#pending = null;
    const took_ms = performance.now() - begin_ms;
    // What took so long was a page that no one looked at.
    if (!counts || took_ms > ABSENT_ms) return true;
    if (took_ms > SLOW_ms) {
      this.scale = Math.max(this.scale * 0.8, COARSEST);
      this.#rest_until_ms = performance.now() + took_ms;
    } else if (took_ms < FAST_ms) {
      this.scale = Math.min(this.scale * 1.1, 1);
    }
    return true;
  }
}
