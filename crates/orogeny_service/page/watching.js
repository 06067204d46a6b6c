// What the service is asked to keep up to date: what is seen, as finely as it is seen.

import { choose, contains, fits, numPages, pagesOver, pagesToMetres, union } from './grid.js';

const WAIT_ms = 90;
/** So many pages may also be of what only the other view shows. */
const MAX_SHARED_PAGES = 32;

export class Watching {
  #timer = 0;
  /** The view that was used last: it tells what is subscribed to. @type {object | null} */
  leading = null;

  /**
   * @param {import('./pages.js').PageStore} store
   * @param {() => import('./connection.js').Connection | null} connection
   * @param {(level: number, num_pages: number, level_before?: number) => void} changed
   */
  constructor(store, connection, changed) {
    Object.assign(this, { store, connection, changed, views: [] });
  }

  /** Looks soon, when the view has come to rest. */
  soon() {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.now(), WAIT_ms);
  }

  /** Subscribes to what is seen, unless that is so already. */
  now() {
    const {
      store,
      store: { terrain },
      views,
    } = this;
    const connection = this.connection();
    const shown = views.filter((view) => view.isShown);
    if (!connection?.isOpen || terrain.name === '' || shown.length === 0) return;
    const lead = shown.includes(this.leading) ? this.leading : shown[0];
    const { rect_m, wanted_m } = lead.seen();
    const { level, pages: own } = choose(terrain, rect_m, wanted_m);
    const others = shown.filter((view) => view !== lead).map((view) => pagesOver(terrain, level, view.seen().rect_m));
    const all = others.reduce(union, own);
    const isShared = fits(all) && numPages(all) <= MAX_SHARED_PAGES;
    const needed = isShared ? others.reduce(union, pagesOver(terrain, level, rect_m)) : pagesOver(terrain, level, rect_m);
    if (store.live?.level === level && contains(store.live.pages, needed)) return;

    const pages = isShared ? all : own;
    const before = store.live;
    store.live = { level, pages };
    const { x0, z0, x1, z1 } = pagesToMetres(terrain, level, pages);
    const [far_x, far_z] = [Math.min(x1, terrain.width * terrain.spacing_m), Math.min(z1, terrain.depth * terrain.spacing_m)];
    connection.subscribe([x0, z0, far_x - x0, far_z - z0], level);
    this.changed(level, numPages(pages), before?.level);
  }
}
