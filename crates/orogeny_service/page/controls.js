// Radio buttons, keys, and what this browser remembers.

const AUTHOR_KEY = 'orogeny.author';
const VIEW_KEY = 'orogeny.view';
const WIDE_px = 1100;

/** @param {string} name of radio buttons */
const chosen = (name) => document.querySelector(`input[name="${name}"]:checked`)?.value;

/** @param {string} name @param {string} value */
function choose(name, value) {
  const input = document.querySelector(`input[name="${name}"][value="${value}"]`);
  if (!input || input.checked) return;
  input.checked = true;
  input.dispatchEvent(new Event('change', { bubbles: true }));
}

export const chosenTool = () => chosen('tool') ?? 'brush';
export const chosenView = () => chosen('view') ?? 'map';

/** What others see this one as; undo goes by it, so two browsers do not begin with the same. */
export function author() {
  const kept = localStorage.getItem(AUTHOR_KEY);
  return kept || setAuthor(`Guest ${1000 + Math.floor(9000 * Math.random())}`);
}

/** @param {string} name @returns {string} as it is kept */
export function setAuthor(name) {
  const kept = name.trim().slice(0, 40);
  if (!kept) return author();
  localStorage.setItem(AUTHOR_KEY, kept);
  return kept;
}

/** @param {{map: import('./map.js').MapView, solid: import('./view3d.js').View3d}} views @param {() => void} changed */
export function setUpViews({ map, solid }, changed) {
  const stage = document.getElementById('stage');
  const show = () => {
    stage.dataset.view = chosenView();
    localStorage.setItem(VIEW_KEY, chosenView());
    changed();
  };
  document.getElementById('views').addEventListener('change', show);
  if (!solid.isAble) {
    const text = document.getElementById('no-webgl');
    text.textContent =
      'The 3D view needs WebGL 2, which this browser or its graphics driver does not offer. Allow hardware acceleration in its settings, or use the map.';
    text.hidden = false;
  }
  const wanted = localStorage.getItem(VIEW_KEY) ?? (window.innerWidth >= WIDE_px && solid.isAble ? 'both' : 'map');
  document.querySelector(`input[name="view"][value="${wanted}"]`)?.click();
  if (!chosen('view')) choose('view', 'map');
  const showTool = () => {
    for (const { canvas } of [map, solid]) canvas.dataset.tool = chosenTool();
  };
  document.getElementById('tools').addEventListener('change', showTool);
  showTool();
  for (const [id, view] of [
    ['map-view', map],
    ['solid-view', solid],
  ]) {
    document.getElementById(id).addEventListener('click', ({ target }) => {
      const acts = { in: () => view.zoom(1.5), out: () => view.zoom(1 / 1.5), fit: () => view.fit() };
      acts[target.dataset.act]?.();
    });
  }
  const exaggeration = document.getElementById('exaggeration');
  exaggeration.addEventListener('change', () => solid.exaggerate(Number(exaggeration.value)));
}

/** Whether plain keys are text there. @param {EventTarget | null} target */
const isTyping = (target) => target instanceof HTMLInputElement && ['text', 'number', 'password'].includes(target.type);

/** @param {{hand: import('./brush.js').Hand, panel: import('./brushpanel.js').BrushPanel, travel(type: 'undo' | 'redo'): void}} page */
export function onKeys({ hand, panel, travel }) {
  const plain = {
    '[': () => panel.scale('radius', 1 / 1.2),
    ']': () => panel.scale('radius', 1.2),
    '-': () => panel.scale('strength', 1 / 1.2),
    '=': () => panel.scale('strength', 1.2),
    b: () => choose('tool', 'brush'),
    v: () => choose('tool', 'move'),
    Escape: () => hand.cancel(),
  };
  const held = { z: () => travel('undo'), Z: () => travel('redo'), y: () => travel('redo') };
  window.addEventListener('keydown', (event) => {
    if (isTyping(event.target) || document.querySelector('dialog[open]')) return;
    const isHeld = event.ctrlKey || event.metaKey;
    // With Shift or Caps Lock a letter comes as a capital.
    const key = isHeld && event.shiftKey ? event.key.toUpperCase() : isHeld ? event.key.toLowerCase() : event.key;
    const act = (isHeld ? held : plain)[key];
    if (!act || event.altKey) return;
    event.preventDefault();
    act();
  });
}
