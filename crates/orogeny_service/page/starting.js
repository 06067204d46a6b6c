// The beginning: which terrains and brushes there are, and which terrain the address names.

import { brushSchemas, terrainNames } from './api.js';
import { sentence } from './notices.js';
import { withToken } from './tokenform.js';

/** The name behind `#`; empty where it cannot be one. */
function wantedName() {
  try {
    return decodeURIComponent(location.hash.slice(1));
  } catch {
    return '';
  }
}

/**
 * @param {object} page
 * @param {(name: string) => void} page.open a terrain
 * @param {() => string | undefined} page.current the terrain that is open
 * @param {(schemas: object[]) => void} page.offer brushes
 * @param {() => void} page.failed
 * @param {import('./notices.js').Notices} page.notices
 */
async function begin({ open, current, offer }) {
  const names = await withToken(terrainNames);
  offer(await brushSchemas());
  if (names.length === 0) throw new Error('the service has no terrains; start it with some: orogeny serve NAME.orogeny');
  const select = document.getElementById('terrain');
  select.replaceChildren(...names.map((name) => new Option(name, name)));
  const show = () => {
    const name = names.includes(wantedName()) ? wantedName() : names[0];
    select.value = name;
    if (current() !== name) open(name);
  };
  select.onchange = () => {
    location.hash = encodeURIComponent(select.value);
  };
  window.onhashchange = show;
  show();
}

/** Begins, and again when that is asked for. @param {Parameters<typeof begin>[0]} page */
export async function start(page) {
  page.notices.clear('start');
  try {
    await begin(page);
  } catch (error) {
    page.failed();
    page.notices.error(sentence(error.message), { topic: 'start', act: ['Try again', () => start(page)] });
  }
}
