// The live channel: one WebSocket, opened again when it is lost, with the same subscription.

import { terrainPath, token } from './api.js';
import { decodeFrame } from './frames.js';

const FIRST_WAIT_ms = 400;
const LONGEST_WAIT_ms = 10_000;
const WINDOW_FRAMES = 16;
// Half the bytes where they go over a network; the difference is thousandths of a metre, and only in what is shown.
const isNear = ['localhost', '127.0.0.1', '[::1]'].includes(location.hostname);
const FORMAT = isNear ? 'r32' : 'r16';

/**
 * @typedef {object} Hooks
 * @property {(event: object) => void} event an event of the service
 * @property {(page: import('./frames.js').Page) => void} page
 * @property {(why: string) => void} malformed
 * @property {(state: 'waiting' | 'open' | 'lost', wait_ms?: number) => void} state
 */

export class Connection {
  #socket = null;
  #timer = 0;
  #wait_ms = FIRST_WAIT_ms;
  #numFrames = 0;
  #nextId = 1;

  /** @param {string} terrain @param {string} author @param {Hooks} hooks */
  constructor(terrain, author, hooks) {
    Object.assign(this, { terrain, author, hooks });
    this.isOpen = false;
    this.#open();
  }

  /** A number that no answer but that to the next request carries. */
  newId() {
    return this.#nextId++;
  }

  #open() {
    this.hooks.state('waiting');
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const address = `${scheme}://${location.host}${terrainPath(this.terrain)}/live?author=${encodeURIComponent(this.author)}`;
    const protocols = token() ? ['orogeny.v1', `bearer.${token()}`] : ['orogeny.v1'];
    let socket;
    try {
      socket = new WebSocket(address, protocols);
    } catch {
      // A token with characters that no subprotocol may have.
      this.hooks.state('lost');
      this.hooks.event({ event: 'error', code: 'bad_token', message: 'the token has characters that cannot be sent' });
      return;
    }
    socket.binaryType = 'arraybuffer';
    this.#socket = socket;
    this.#numFrames = 0;
    socket.onmessage = ({ data }) => (typeof data === 'string' ? this.#text(data) : this.#frame(data));
    socket.onclose = () => this.#closed(socket);
  }

  /** @param {WebSocket} socket */
  #closed(socket) {
    if (socket !== this.#socket) return;
    this.isOpen = false;
    this.#socket = null;
    // Not all at the same moment when a service comes back.
    const wait_ms = this.#wait_ms * (0.75 + 0.5 * Math.random());
    this.#wait_ms = Math.min(this.#wait_ms * 1.7, LONGEST_WAIT_ms);
    this.#timer = setTimeout(() => this.#open(), wait_ms);
    this.hooks.state('lost', wait_ms);
  }

  /** Tries again now. */
  retry() {
    if (this.#socket) return;
    clearTimeout(this.#timer);
    this.#open();
  }

  /** For good. */
  close() {
    clearTimeout(this.#timer);
    const socket = this.#socket;
    this.#socket = null;
    this.isOpen = false;
    socket?.close();
  }

  /** @param {string} data */
  #text(data) {
    let event;
    try {
      event = JSON.parse(data);
    } catch {
      this.hooks.malformed('a message is no JSON');
      return;
    }
    if (event === null || typeof event !== 'object') return;
    if (event.event === 'hello') {
      this.isOpen = true;
      this.#wait_ms = FIRST_WAIT_ms;
      this.hooks.state('open');
    }
    this.hooks.event(event);
  }

  /** @param {ArrayBuffer} data */
  #frame(data) {
    // Also those that cannot be read count: the service counts what it sent.
    this.#numFrames += 1;
    const { page, wrong } = decodeFrame(data);
    if (page) this.hooks.page(page);
    if (wrong) this.hooks.malformed(`a page frame was left out: ${wrong}`);
    this.send({ type: 'ack', frames: this.#numFrames });
  }

  /** @param {object} message @returns {boolean} whether it could be sent */
  send(message) {
    if (this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  /** @param {object} message without its `id` @returns {number} the `id`; 0 where it could not be sent */
  request(message) {
    const id = this.newId();
    return this.send({ ...message, id }) ? id : 0;
  }

  /** @param {[number, number, number, number]} region metres @param {number} level */
  subscribe(region, level) {
    this.send({ type: 'subscribe', region, level, format: FORMAT, window: WINDOW_FRAMES });
  }
}
