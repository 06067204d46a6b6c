// Puts the page together.

import { roundTrip_ms, terrainNames } from './api.js';
import { Hand } from './brush.js';
import { BrushPanel } from './brushpanel.js';
import { Connection } from './connection.js';
import { Footer } from './footer.js';
import { extent, rectOf } from './grid.js';
import { Layers } from './layers.js';
import { MapView } from './map.js';
import { Notices, sentence } from './notices.js';
import { Overview } from './overview.js';
import { PageStore } from './pages.js';
import { People } from './people.js';
import { listen } from './pointer.js';
import { brushesOf } from './settings.js';
import { start } from './starting.js';
import { withToken } from './tokenform.js';
import { View3d } from './view3d.js';
import { Watching } from './watching.js';
import { author, chosenTool, chosenView, onKeys, setAuthor, setUpViews } from './controls.js';

const MEASURE_EVERY_ms = 10_000;
const RANGE_SLACK = 0.02;
const NOTHING = { name: '', width: 2, depth: 2, spacing_m: 1, pageSize: 256, levels: 0 };

/** @param {string} id */
const at = (id) => document.getElementById(id);

/** @type {Connection | null} */
let connection = null;
let terrain = NOTHING;
let revision = null;
let wasGreeted = false;
/** What was asked for, for what is said about it. @type {Map<number, string>} */
const asked = new Map();
/** What the progress is of. */
let inProgress = null;

const store = new PageStore(NOTHING);
const footer = new Footer();
const notices = new Notices(at('notices'));
const overview = new Overview(store, (why) => notices.error(why, { topic: 'overview' }));
const redraw = () => [map, solid].forEach((view) => view.redraw());
const people = new People(
  at('people'),
  at('lately'),
  (message) => connection?.send(message),
  () => redraw(),
);
const scene = { range: { low_m: 0, high_m: 1 }, cursors: () => people.cursors(), moved: () => watching.soon() };
const watching = new Watching(
  store,
  () => connection,
  (level, num_pages, level_before) => {
    footer.selection(level, num_pages);
    // These came by the live channel until now, perhaps in the middle of a stroke.
    if (level_before === store.overviewLevel && level !== level_before) overview.touch(null);
    solid.selected();
    map.redraw();
  },
);
const map = new MapView(at('map'), store, scene);
const solid = new View3d(at('solid'), store, scene);
watching.views = [map, solid];
const layers = new Layers(at('layers'), (layer, visible) => {
  if (!request('set a layer', { type: 'apply', operations: [{ op: 'set_layer', layer, visible }] })) layers.restore();
});
const panel = new BrushPanel(at('brush'), () => people.resize(panel.radius_m));
const hand = new Hand(
  () => connection,
  choice,
  (text, topic = 'hand') => notices.error(text, { topic }),
);
let hovered = null;

/** What the hand paints with. */
function choice() {
  if (layers.hidden) notices.show(`You paint on “${layers.hidden}”, which is hidden. Tick it under Layers to see it.`, { topic: 'hidden' });
  return { brush: panel.brush(), layer: layers.chosen };
}

/** @param {string} what for people @param {object} message @returns {boolean} whether it was sent */
function request(what, message) {
  const id = connection?.request(message) ?? 0;
  if (id) asked.set(id, what);
  else notices.error('There is no connection at the moment. It comes back by itself; then try again.', { topic: 'hand' });
  return id !== 0;
}

/** @param {'undo' | 'redo'} type */
function travel(type) {
  if (!hand.isDrawing) request(type, { type });
}

/** @param {number} low_m @param {number} high_m */
function setRange(low_m, high_m) {
  if (!Number.isFinite(low_m) || !Number.isFinite(high_m)) return;
  const { range } = scene;
  const slack_m = RANGE_SLACK * (range.high_m - range.low_m);
  // Colours stay unless they would be wrong.
  if (Math.abs(low_m - range.low_m) <= slack_m && Math.abs(high_m - range.high_m) <= slack_m) return;
  Object.assign(range, { low_m, high_m: Math.max(high_m, low_m + 1e-3) });
  map.tiles.recolour(range);
  solid.redraw();
}

/** @param {number} value */
function setRevision(value) {
  revision = value;
  footer.revision(value);
}

/** @param {object} hello */
function greet(hello) {
  const before = terrain;
  terrain = {
    name: hello.terrain,
    width: hello.width,
    depth: hello.depth,
    spacing_m: hello.spacing,
    pageSize: hello.page_size,
    levels: hello.levels,
  };
  const isSame = ['name', 'width', 'depth', 'spacing_m'].every((key) => before[key] === terrain[key]);
  wasGreeted = true;
  store.reset(terrain);
  setRange(hello.lowest, hello.highest);
  setRevision(hello.revision);
  people.begin(hello.client);
  if (!isSame) {
    const { width_m, depth_m } = extent(terrain);
    panel.fit({ spacing_m: terrain.spacing_m, extent_m: Math.max(width_m, depth_m), relief_m: hello.highest - hello.lowest });
    [map, solid].forEach((view) => view.fit());
  }
  overview.touch(null);
  watching.now();
  measure();
}

/** @param {object} event */
function finish({ id }) {
  asked.delete(id);
  if (id !== inProgress) return;
  inProgress = null;
  footer.progress(null);
}

/** @param {object} event of the service */
function hear(event) {
  const { id } = event;
  hand.hear(event);
  people.hear(event);
  const means = {
    hello: () => greet(event),
    status: () => {
      layers.show(event.layers);
      at('undo').disabled = event.can_undo === false;
      at('redo').disabled = event.can_redo === false;
      setRange(event.lowest, event.highest);
    },
    done: () => {
      setRevision(event.revision);
      finish(event);
    },
    operation: () => {
      setRevision(event.revision);
      const rect_m = Array.isArray(event.rect) ? rectOf(event.rect) : null;
      store.forget(rect_m);
      overview.touch(rect_m);
    },
    progress: () => {
      // A stroke at hand is seen by itself.
      if (hand.isDrawing) return;
      inProgress = id;
      footer.progress(event);
    },
    error: () => {
      const what = asked.get(id);
      if (!hand.wasCancelled(id))
        notices.error(sentence(`${what ? `could not ${what}: ` : ''}${event.message ?? event.code}`), { topic: `error ${event.code}` });
      if (what === 'set a layer') layers.restore();
      finish(event);
    },
    cut: () => notices.show('Others had waited, so your stroke was ended; it goes on as another one.', { topic: 'cut' }),
    closing: () =>
      notices.show('The service stops. What was painted is on disk; this page connects again when it is back.', {
        topic: 'connection',
        stays: true,
      }),
  };
  means[event.event]?.();
}

/** @param {'waiting' | 'open' | 'lost'} state @param {number} [wait_ms] */
function showState(state, wait_ms = 0) {
  const texts = { waiting: 'connecting', open: 'connected', lost: `not connected; tries again in ${Math.ceil(wait_ms / 1000)} s` };
  footer.connection(state, texts[state]);
  if (state === 'open') ['connection', 'hand'].forEach((topic) => notices.clear(topic));
  if (state !== 'lost') return;
  hand.lost();
  asked.clear();
  inProgress = null;
  footer.progress(null);
  people.begin(null);
  if (!wasGreeted) diagnose();
  wasGreeted = false;
}

/** A WebSocket does not say why it was refused; HTTP does. */
async function diagnose() {
  const name = connection?.terrain;
  try {
    const names = await withToken(terrainNames);
    if (!names.includes(name)) notices.error(`The service has no terrain “${name}” now. Choose another one.`, { topic: 'connection' });
    connection?.retry();
  } catch (error) {
    notices.error(`${sentence(error.message)} This page goes on trying.`, {
      topic: 'connection',
      act: ['Try now', () => connection?.retry()],
    });
  }
}

async function measure() {
  try {
    footer.latency({ roundTrip_ms: await roundTrip_ms() });
  } catch {
    footer.latency({ roundTrip_ms: null });
  }
}

/** @param {import('./frames.js').Page} page */
function receive(page) {
  if (!store.put(page)) {
    notices.error('A page frame was left out: it is of no place of this terrain.', { topic: 'frame' });
    return;
  }
  if (hand.sent_ms > 0) footer.latency({ seen_ms: performance.now() - hand.sent_ms });
  hand.sent_ms = 0;
  if (hovered) footer.here(hovered, store.height_m(hovered.x_m, hovered.z_m));
}

/** @param {string} name of a terrain */
function open(name) {
  hand.cancel();
  connection?.close();
  overview.stop();
  if (terrain.name !== name) {
    terrain = NOTHING;
    at('lately').replaceChildren();
  }
  layers.clear();
  document.title = `${name} – Orogeny`;
  connection = new Connection(name, author(), {
    event: hear,
    page: receive,
    state: showState,
    malformed: (why) => notices.error(`The service sent something that this page cannot read: ${why}.`, { topic: 'frame' }),
  });
}

/** @param {object | null} place */
function hover(place) {
  hovered = place;
  people.hover(place, panel.radius_m);
  footer.here(place, place ? store.height_m(place.x_m, place.z_m) : undefined);
}

function setUp() {
  for (const view of [map, solid]) {
    listen(view.canvas, view, {
      hand,
      hover,
      tool: chosenTool,
      used: () => {
        watching.leading = view;
        // Where painted is, nothing else is asked for until the hand is lifted.
        if (!hand.isDrawing) watching.soon();
      },
    });
  }
  setUpViews({ map, solid }, () => {
    watching.leading = chosenView() === '3d' ? solid : map;
    redraw();
    watching.soon();
  });
  onKeys({ hand, panel, travel });
  at('undo').addEventListener('click', () => travel('undo'));
  at('redo').addEventListener('click', () => travel('redo'));
  at('author').value = author();
  at('author').addEventListener('change', () => {
    at('author').value = setAuthor(at('author').value);
    if (connection) open(connection.terrain);
  });
  // The colours behind the ground are the page's.
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
  setInterval(() => connection?.isOpen && !document.hidden && measure(), MEASURE_EVERY_ms);
}

// For scripts and tests: to look, not to touch.
window.orogeny = Object.freeze({
  get revision() {
    return revision;
  },
  get connected() {
    return connection?.isOpen ?? false;
  },
  get terrain() {
    return terrain === NOTHING ? null : { ...terrain };
  },
  /** @param {number} x_m @param {number} z_m */
  height_m: (x_m, z_m) => store.height_m(x_m, z_m),
});

setUp();
start({
  open,
  notices,
  current: () => connection?.terrain,
  offer: (schemas) => panel.offer(brushesOf(schemas)),
  failed: () => footer.connection('lost', 'not connected'),
});
