// The layers: which is painted on, and which are seen.

import { element } from './brushpanel.js';

/** @typedef {{id: number, name: string, content?: string, visible: boolean, locked?: boolean, opacity?: number, blend?: string}} Layer */

/** @param {Layer} layer */
const isPaintable = ({ content = 'heights', locked }) => content === 'heights' && !locked;

/** @param {Layer} layer */
function noteOf({ content = 'heights', locked, opacity = 1, blend = 'add' }) {
  const notes = [
    content === 'heights' ? '' : content,
    locked ? 'locked' : '',
    blend === 'add' ? '' : blend,
    opacity < 1 ? `${Math.round(100 * opacity)} %` : '',
  ];
  return notes.filter(Boolean).join(', ');
}

export class Layers {
  /** @type {Layer[]} from the bottom */
  #layers = [];
  /** @type {string | null} painted on */
  chosen = null;

  /** @param {HTMLElement} list @param {(layer: string, isVisible: boolean) => void} toggle */
  constructor(list, toggle) {
    Object.assign(this, { list, toggle });
  }

  clear() {
    this.show([]);
  }

  /** @param {unknown} layers */
  show(layers) {
    if (!Array.isArray(layers)) return;
    this.#layers = layers;
    const isStill = layers.some((layer) => layer.name === this.chosen && isPaintable(layer));
    if (!isStill) this.chosen = (layers.find((layer) => isPaintable(layer) && layer.visible) ?? layers.find(isPaintable))?.name ?? null;
    const focus = document.activeElement?.id;
    this.list.replaceChildren(...[...layers].reverse().map((layer) => this.#item(layer)));
    // Whoever works with the keyboard stays where they were.
    if (focus?.startsWith('layer-')) document.getElementById(focus)?.focus();
  }

  /** The layer that is painted on, where it does not show. */
  get hidden() {
    const layer = this.#layers.find(({ name }) => name === this.chosen);
    return layer && !layer.visible ? layer.name : null;
  }

  /** @param {Layer} layer */
  #item(layer) {
    const { id, name, visible } = layer;
    const seen = element('input', {
      type: 'checkbox',
      id: `layer-${id}-seen`,
      checked: visible,
      attributes: { 'aria-label': `${name} is visible` },
    });
    seen.addEventListener('change', () => {
      // It is as the service says; the next status tells.
      this.toggle(name, seen.checked);
    });
    const paint = element('input', {
      type: 'radio',
      name: 'layer',
      id: `layer-${id}-paint`,
      checked: name === this.chosen,
      disabled: !isPaintable(layer),
      attributes: { 'aria-label': `paint on ${name}` },
    });
    paint.addEventListener('change', () => {
      this.chosen = name;
    });
    return element(
      'li',
      {},
      element('label', { title: 'Whether it is seen' }, seen, 'seen'),
      element('label', { className: 'name', title: isPaintable(layer) ? 'Paint on this layer' : 'It cannot be painted on' }, paint, name),
      element('span', { className: 'note' }, noteOf(layer)),
    );
  }

  /** As it was: what was asked for was refused. */
  restore() {
    this.show(this.#layers);
  }
}
