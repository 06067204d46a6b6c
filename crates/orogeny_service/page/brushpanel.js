// The form with the brush and its parameters.

import { SLIDER, fromRatio, rounded, toRatio, within } from './settings.js';

/** @typedef {import('./settings.js').Parameter} Parameter @typedef {import('./settings.js').Brush} Brush */

/** @param {string} tag @param {object} [properties] @param {...(Node | string)} children */
export function element(tag, properties = {}, ...children) {
  const { data = {}, attributes = {}, ...rest } = properties;
  const made = Object.assign(document.createElement(tag), rest);
  Object.assign(made.dataset, data);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

const words = (name) => name.replaceAll('_', ' ');

export class BrushPanel {
  /** @type {Map<string, Map<string, unknown>>} what was set, by brush; radius and strength under each too */
  #set = new Map();
  /** @type {Brush[]} */
  #brushes = [];
  /** @type {Brush | null} */
  #brush = null;
  /** @type {Map<string, (value: number) => void>} shows a number that was set by a key */
  #show = new Map();
  #size = { spacing_m: 1, extent_m: 1000, relief_m: 0 };

  /** @param {HTMLFormElement} form @param {() => void} changed */
  constructor(form, changed) {
    Object.assign(this, { form, changed });
    form.addEventListener('submit', (event) => event.preventDefault());
  }

  /** @param {Brush[]} brushes */
  offer(brushes) {
    this.#brushes = brushes;
    this.#brush = brushes.find(({ name }) => name === this.#brush?.name) ?? brushes[0] ?? null;
    this.#render();
  }

  /** The terrain's size tells what a handy brush is. @param {{spacing_m: number, extent_m: number, relief_m: number}} size */
  fit(size) {
    this.#size = size;
    this.#set.clear();
    this.#render();
  }

  /** @param {Parameter} about @returns {[number, number] | null} ends of a slider by ratios */
  #ratioEnds({ name }) {
    const { spacing_m, extent_m } = this.#size;
    if (name === 'radius') return [spacing_m, Math.max(extent_m / 3, 2 * spacing_m)];
    if (name === 'strength' && this.#brush.isInMetres) return [0.01, Math.max(this.#size.relief_m, 100)];
    return null;
  }

  /** @param {Parameter} about */
  #initial(about) {
    const { spacing_m, extent_m, relief_m } = this.#size;
    const two = (value) => Number(value.toPrecision(1));
    if (about.name === 'radius') return within(about, Math.max(two(extent_m / 30), 2 * spacing_m));
    if (about.name === 'strength' && this.#brush.isInMetres && relief_m > 0) return within(about, two(relief_m / 20));
    return about.initial;
  }

  get #values() {
    const { name } = this.#brush;
    if (!this.#set.has(name)) this.#set.set(name, new Map());
    return this.#set.get(name);
  }

  /** @param {Parameter} about */
  #value(about) {
    return this.#values.has(about.name) ? this.#values.get(about.name) : this.#initial(about);
  }

  /** @param {Parameter} about @param {unknown} value */
  #change(about, value) {
    this.#values.set(about.name, value);
    // The hand keeps its size from brush to brush.
    if (about.name === 'radius')
      for (const { name } of this.#brushes) this.#set.set(name, (this.#set.get(name) ?? new Map()).set('radius', value));
    this.changed();
  }

  /** What an operation gets: what differs from the brush's own defaults, and what everyone wants to see in the history. */
  brush() {
    if (!this.#brush) return null;
    const all = [...this.#brush.main, ...this.#brush.more];
    const isSent = (about, value) =>
      value !== null && (about.isNeeded || value !== about.initial || ['radius', 'strength'].includes(about.name));
    const entries = all.map((about) => [about, this.#value(about)]).filter(([about, value]) => isSent(about, value));
    return { type: this.#brush.name, ...Object.fromEntries(entries.map(([about, value]) => [about.name, value])) };
  }

  get radius_m() {
    return this.brush()?.radius ?? 1;
  }

  /** By a key. @param {'radius' | 'strength'} name @param {number} factor */
  scale(name, factor) {
    const about = this.#brush?.main.find((each) => each.name === name);
    if (!about) return;
    const value = within(about, rounded(this.#value(about) * factor || 0.01));
    this.#change(about, value);
    this.#show.get(name)?.(value);
  }

  #render() {
    const { form } = this;
    form.replaceChildren();
    this.#show.clear();
    if (!this.#brush) return;
    const select = element('select', { id: 'brush-type' }, ...this.#brushes.map(({ name }) => new Option(words(name), name)));
    select.value = this.#brush.name;
    select.addEventListener('change', () => {
      this.#brush = this.#brushes.find(({ name }) => name === select.value);
      const isOpen = form.querySelector('details')?.open ?? false;
      this.#render();
      form.querySelector('details').open = isOpen;
      form.querySelector('select').focus();
      this.changed();
    });
    form.append(
      element('label', { className: 'row' }, 'Kind', select),
      element('p', { className: 'about' }, this.#brush.about.replaceAll('`', '')),
      ...this.#brush.main.map((about) => this.#control(about)),
      element('details', {}, element('summary', {}, 'More'), ...this.#brush.more.map((about) => this.#control(about))),
    );
    this.changed();
  }

  /** @param {Parameter} about */
  #control(about) {
    const id = `parameter-${about.name}`;
    const title = about.about.replaceAll('`', '');
    const unit = about.unit ? element('span', { className: 'unit' }, ` (${about.unit})`) : '';
    const label = element('label', { htmlFor: id, title }, words(about.name), unit);
    const makers = { number: () => this.#number(about, id), choice: () => this.#choice(about, id), switch: () => this.#switch(about, id) };
    return element('div', { className: 'control' }, label, makers[about.kind]());
  }

  /** @param {Parameter} about @param {string} id */
  #number(about, id) {
    const value = this.#value(about);
    const number = element('input', {
      id,
      type: 'number',
      step: about.isWhole ? '1' : 'any',
      value: value ?? '',
      placeholder: 'auto',
      required: about.isNeeded,
    });
    const ends = this.#ratioEnds(about);
    const isShort = ends !== null || about.high - about.low <= 1000;
    if (!isShort) {
      number.addEventListener('change', () => {
        const isEmpty = number.value.trim() === '' || !Number.isFinite(number.valueAsNumber);
        const next = isEmpty ? about.initial : within(about, number.valueAsNumber);
        number.value = next ?? '';
        this.#change(about, next);
      });
      return number;
    }
    const toSlider = (v) => (ends ? toRatio(v, ...ends) : (SLIDER * (v - about.low)) / (about.high - about.low));
    const fromSlider = (at) => (ends ? fromRatio(at, ...ends) : rounded(about.low + (at / SLIDER) * (about.high - about.low)));
    const slider = element('input', {
      type: 'range',
      min: 0,
      max: SLIDER,
      step: 1,
      attributes: { 'aria-label': `${words(about.name)}, slider` },
    });
    const show = (v) => {
      number.value = v ?? '';
      slider.value = v === null ? 0 : toSlider(v);
      slider.setAttribute('aria-valuetext', `${v ?? 'auto'} ${about.unit}`);
    };
    show(value);
    this.#show.set(about.name, show);
    slider.addEventListener('input', () => {
      const next = within(about, fromSlider(slider.valueAsNumber));
      show(next);
      this.#change(about, next);
    });
    number.addEventListener('change', () => {
      const next = Number.isFinite(number.valueAsNumber) ? within(about, number.valueAsNumber) : this.#initial(about);
      show(next);
      this.#change(about, next);
    });
    return element('div', { className: 'pair' }, slider, number);
  }

  /** @param {Parameter} about @param {string} id */
  #choice(about, id) {
    const select = element('select', { id }, ...about.choices.map((choice) => new Option(words(choice), choice)));
    select.value = this.#value(about) ?? about.choices[0];
    select.addEventListener('change', () => this.#change(about, select.value));
    return select;
  }

  /** @param {Parameter} about @param {string} id */
  #switch(about, id) {
    const box = element('input', { id, type: 'checkbox', checked: Boolean(this.#value(about)) });
    box.addEventListener('change', () => this.#change(about, box.checked));
    return box;
  }
}
