// What has to be said: briefly, in a corner, with what to do about it.

import { element } from './brushpanel.js';

const STAY_ms = 7000;
const MAX_NOTICES = 4;

/** @param {string} text @returns {string} with a capital and a full stop */
export const sentence = (text) => text.charAt(0).toUpperCase() + text.slice(1) + (/[.?!]$/.test(text) ? '' : '.');

export class Notices {
  /** @param {HTMLElement} place */
  constructor(place) {
    this.place = place;
  }

  /**
   * @param {string} text
   * @param {{kind?: 'note' | 'error', topic?: string, stays?: boolean, act?: [string, () => void]}} [how] of one topic there is one notice
   */
  show(text, { kind = 'note', topic = text, stays = kind === 'error', act } = {}) {
    this.clear(topic);
    const notice = element('div', { className: 'notice', data: { kind, topic } }, element('p', {}, text));
    const button = (label, title, pressed) => {
      const made = element('button', { type: 'button', ariaLabel: title }, label);
      made.addEventListener('click', pressed);
      notice.append(made);
    };
    if (act) button(act[0], act[0], act[1]);
    button('×', 'Dismiss', () => notice.remove());
    this.place.append(notice);
    while (this.place.children.length > MAX_NOTICES) this.place.firstChild.remove();
    if (!stays) setTimeout(() => notice.remove(), STAY_ms);
  }

  /** @param {string} text @param {object} [how] */
  error(text, how = {}) {
    this.show(text, { ...how, kind: 'error' });
  }

  /** @param {string} topic */
  clear(topic) {
    for (const notice of [...this.place.children]) if (notice.dataset.topic === topic) notice.remove();
  }
}
