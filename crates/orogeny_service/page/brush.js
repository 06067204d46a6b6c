// The hand: what the pointer does becomes `begin_stroke`, `points`, `end_stroke`.

const SEND_EVERY_ms = 12;
const REST_ms = 80;
const OPPOSITE = { raise: 'lower', lower: 'raise' };

/**
 * @typedef {object} Place
 * @property {number} x_m
 * @property {number} z_m
 * @property {number} [pressure] 0..1; left out: full
 */

export class Hand {
  /** The stroke at hand. @type {{id: number, operation: object, began_ms: number, last: Place} | null} */
  #stroke = null;
  /** @type {number[][]} points to be sent */
  #points = [];
  #timer = 0;
  #rest = 0;
  /** Strokes that are lifted and not yet done, the oldest first. @type {Set<number>} */
  #lifted = new Set();
  /** Strokes that were given up, of which no one needs to be told. @type {Set<number>} */
  #cancelled = new Set();

  /**
   * @param {() => import('./connection.js').Connection | null} connection
   * @param {() => {brush: object, layer: string | null}} choice
   * @param {(text: string, topic?: string) => void} refused
   */
  constructor(connection, choice, refused) {
    Object.assign(this, { connection, choice, refused });
    this.sent_ms = 0;
  }

  get isDrawing() {
    return this.#stroke !== null;
  }

  /** @param {Place} place @param {{isInverted?: boolean, isSmoothing?: boolean}} [how] */
  begin(place, how = {}) {
    if (this.#stroke) return;
    const { brush, layer } = this.choice();
    if (!brush) return;
    const { type, radius } = brush;
    const chosen = how.isSmoothing
      ? { type: 'smooth', radius }
      : how.isInverted && OPPOSITE[type]
        ? { ...brush, type: OPPOSITE[type] }
        : brush;
    this.#start({ op: 'stroke', brush: chosen, ...(layer === null ? {} : { layer }) }, place);
  }

  /** @param {object} operation @param {Place} place */
  #start(operation, place) {
    const id = this.connection()?.request({ type: 'begin_stroke', operation }) ?? 0;
    if (id === 0) {
      this.refused('There is no connection at the moment: nothing was painted. It comes back by itself.');
      return;
    }
    this.#stroke = { id, operation, began_ms: performance.now(), last: place };
    this.#add(place);
    this.#send();
    if (operation.brush.airbrush) this.#rest = setInterval(() => this.#add(this.#stroke.last), REST_ms);
  }

  /** @param {Place} place */
  #add(place) {
    const { x_m, z_m, pressure } = place;
    const { operation, began_ms } = this.#stroke;
    const point = [x_m, z_m];
    if (pressure !== undefined || operation.brush.airbrush) point.push(pressure ?? 1);
    if (operation.brush.airbrush) point.push((performance.now() - began_ms) / 1000);
    this.#points.push(point);
    this.#stroke.last = place;
    if (!this.#timer) this.#timer = setTimeout(() => this.#send(), SEND_EVERY_ms);
  }

  #send() {
    clearTimeout(this.#timer);
    this.#timer = 0;
    if (!this.#stroke || this.#points.length === 0) return;
    if (!this.connection()?.send({ type: 'points', id: this.#stroke.id, points: this.#points })) this.lost();
    this.#points = [];
    this.sent_ms = performance.now();
  }

  /** @param {Place} place */
  move(place) {
    if (this.#stroke) this.#add(place);
  }

  end() {
    if (!this.#stroke) return;
    this.#send();
    if (!this.#stroke) return;
    const { id } = this.#stroke;
    this.connection()?.send({ type: 'end_stroke', id });
    this.#lifted.add(id);
    this.#forget();
  }

  /** Takes back the stroke at hand; else gives up the last one that takes its time. */
  cancel() {
    const id = this.#stroke?.id ?? [...this.#lifted].at(-1);
    if (id === undefined) return;
    this.#cancelled.add(id);
    this.connection()?.send({ type: 'cancel_stroke', id });
    if (this.#stroke) this.#forget();
  }

  /** @param {number} id */
  wasCancelled(id) {
    return this.#cancelled.has(id);
  }

  #forget() {
    clearTimeout(this.#timer);
    clearInterval(this.#rest);
    this.#timer = 0;
    this.#points = [];
    this.#stroke = null;
  }

  /** The connection is gone, and with it the stroke. */
  lost() {
    if (this.#stroke || this.#lifted.size > 0)
      this.refused('The connection was lost during a stroke. Look whether it is there; else paint it again.', 'lost stroke');
    this.#lifted.clear();
    this.#cancelled.clear();
    this.#forget();
  }

  /** @param {{event: string, id?: number}} event */
  hear({ event, id }) {
    if (event === 'done' || event === 'error') this.#lifted.delete(id);
    if (id === undefined || this.#stroke?.id !== id) return;
    if (event === 'error') this.#forget();
    if (event === 'cut') {
      // Others had waited: what came so far is done, and the hand goes on with a stroke of its own.
      const { operation, last } = this.#stroke;
      this.#forget();
      this.#start(operation, last);
    }
  }
}
