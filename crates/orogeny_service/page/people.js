// Who is there, where their pointers are, and what was done lately.

import { element } from './brushpanel.js';

const FORGET_ms = 60_000;
const SEND_EVERY_ms = 50;
const NUM_LATELY = 6;

/**
 * @typedef {object} Cursor
 * @property {number} client
 * @property {string} author
 * @property {number} x_m
 * @property {number} z_m
 * @property {number} radius_m
 * @property {boolean} isOwn
 * @property {number[]} rgb 0..1
 */

/** A colour for a client, the same on every screen: hues far from those before. @param {number} client @returns {number[]} 0..1 */
function colourOf(client) {
  const hue = (client * 137.5) % 360;
  return [0, 8, 4].map((n) => {
    const k = (n + hue / 30) % 12;
    return 0.58 - 0.4 * Math.max(-1, Math.min(k - 3, 9 - k, 1));
  });
}

/** @param {number[]} rgb 0..1 */
export const cssOf = (rgb) => `rgb(${rgb.map((value) => Math.round(255 * value)).join(' ')})`;

export class People {
  #own = null;
  #clients = [];
  /** @type {Map<number, Cursor & {heard_ms: number}>} */
  #cursors = new Map();
  /** @type {Cursor | null} */
  #hover = null;
  #sent_ms = 0;

  /** @param {HTMLElement} list @param {HTMLElement} lately @param {(message: object) => void} send @param {() => void} changed */
  constructor(list, lately, send, changed) {
    Object.assign(this, { list, lately, send, changed });
    setInterval(() => this.#expire(), FORGET_ms / 10);
  }

  /** @param {number | null} client this one; `null`: there is no connection */
  begin(client) {
    this.#own = client;
    this.#clients = [];
    this.#cursors.clear();
    this.#render();
  }

  #expire() {
    const since_ms = performance.now() - FORGET_ms;
    for (const [client, { heard_ms }] of this.#cursors) if (heard_ms < since_ms) this.#cursors.delete(client);
    this.changed();
  }

  /** @param {object} event */
  hear(event) {
    if (event.event === 'clients' && Array.isArray(event.clients)) {
      this.#clients = event.clients;
      const there = new Set(event.clients.map(({ client }) => client));
      for (const client of this.#cursors.keys()) if (!there.has(client)) this.#cursors.delete(client);
      this.#render();
    }
    if (event.event === 'cursor' && event.client !== this.#own && [event.x, event.z].every(Number.isFinite)) {
      const { client, x: x_m, z: z_m, radius: radius_m = 0 } = event;
      this.#cursors.set(client, {
        client,
        author: this.#nameOf(client),
        x_m,
        z_m,
        radius_m,
        isOwn: false,
        rgb: colourOf(client),
        heard_ms: performance.now(),
      });
    }
    if (event.event === 'operation') this.#add(event);
    this.changed();
  }

  /** @param {number} client */
  #nameOf(client) {
    return this.#clients.find((each) => each.client === client)?.author ?? 'someone';
  }

  /** @param {{author?: string, what?: string}} event */
  #add({ author, what }) {
    this.lately.prepend(element('li', {}, `${author ?? 'someone'}: ${(what ?? 'something').replaceAll('_', ' ')}`));
    while (this.lately.children.length > NUM_LATELY) this.lately.lastChild.remove();
  }

  #render() {
    const items = this.#clients.map(({ client, author }) => {
      const mark = element('canvas', { width: 1, height: 1, ariaHidden: 'true' });
      const context = mark.getContext('2d');
      context.fillStyle = client === this.#own ? '#fff' : cssOf(colourOf(client)); // as on the map
      context.fillRect(0, 0, 1, 1);
      return element('li', {}, mark, author, element('span', { className: 'note' }, client === this.#own ? '(you)' : ''));
    });
    this.list.replaceChildren(...items);
  }

  /** Where this one's pointer is. @param {{x_m: number, z_m: number} | null} place @param {number} radius_m */
  hover(place, radius_m) {
    this.#hover = place && { client: this.#own, author: '', ...place, radius_m, isOwn: true, rgb: [1, 1, 1] };
    this.changed();
    const now_ms = performance.now();
    if (!place || this.#clients.length < 2 || now_ms - this.#sent_ms < SEND_EVERY_ms) return;
    this.#sent_ms = now_ms;
    this.send({ type: 'cursor', x: place.x_m, z: place.z_m, radius: radius_m });
  }

  /** @param {number} radius_m */
  resize(radius_m) {
    if (this.#hover) this.#hover.radius_m = radius_m;
    this.changed();
  }

  /** @returns {Cursor[]} */
  cursors() {
    return [...this.#cursors.values(), ...(this.#hover ? [this.#hover] : [])];
  }
}
