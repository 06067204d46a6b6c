// What pointer, wheel and keys do on a view; the same for the map and the 3D view.

const WHEEL_PER_STEP = 1.0015;
const KEY_px = 60;

/**
 * @typedef {object} Surface
 * @property {(at: {x: number, y: number}) => {x_m: number, z_m: number} | null} pick
 * @property {() => {x_m: number, z_m: number}} middle
 * @property {(dx_px: number, dy_px: number) => void} pan
 * @property {(dx_px: number, dy_px: number) => void} turn
 * @property {(factor: number, at?: {x: number, y: number}) => void} zoom
 * @property {() => void} fit
 */

/** @param {PointerEvent | WheelEvent} event */
const at = (event) => ({ x: event.offsetX, y: event.offsetY });

/** Only a pen knows; a mouse says ½ whenever a button is down. @param {PointerEvent} event */
const pressureOf = (event) => (event.pointerType === 'pen' && event.pressure > 0 ? { pressure: event.pressure } : {});

/**
 * @param {HTMLCanvasElement} canvas @param {Surface} view
 * @param {{hand: import('./brush.js').Hand, tool(): 'brush' | 'move', hover(place: object | null): void, used(): void}} page
 */
export function listen(canvas, view, page) {
  /** @type {{pointer: number, does: 'paint' | 'pan' | 'turn', last: {x: number, y: number}} | null} */
  let drag = null;
  /** Fingers on the view. @type {Map<number, {x: number, y: number}>} */
  const fingers = new Map();

  /** @param {PointerEvent} event */
  const whatFor = (event) => {
    if (event.button === 1) return 'pan';
    if (event.button === 2) return 'turn';
    if (event.altKey) return 'turn';
    if (page.tool() === 'move') return event.shiftKey ? 'pan' : 'turn';
    return 'paint';
  };

  canvas.addEventListener('pointerdown', (event) => {
    if (event.pointerType === 'touch') fingers.set(event.pointerId, at(event));
    if (drag) {
      // A second finger: the first was no stroke, but the beginning of a pinch.
      if (fingers.size === 2 && drag.does === 'paint') page.hand.cancel();
      if (fingers.size === 2) drag = { ...drag, does: 'pan' };
      return;
    }
    page.used();
    const does = whatFor(event);
    const place = does === 'paint' ? view.pick(at(event)) : null;
    if (does === 'paint' && !place) return;
    canvas.setPointerCapture(event.pointerId);
    drag = { pointer: event.pointerId, does, last: at(event) };
    if (place)
      page.hand.begin({ ...place, ...pressureOf(event) }, { isInverted: event.ctrlKey || event.metaKey, isSmoothing: event.shiftKey });
  });

  /** Two fingers: apart is closer. @param {PointerEvent} event */
  const pinch = (event) => {
    const ids = [...fingers.keys()];
    const other = fingers.get(ids.find((id) => id !== event.pointerId));
    const [before, now] = [fingers.get(event.pointerId), at(event)];
    const far = (a) => Math.max(Math.hypot(a.x - other.x, a.y - other.y), 1);
    view.zoom(far(now) / far(before), { x: (now.x + other.x) / 2, y: (now.y + other.y) / 2 });
    view.pan((now.x - before.x) / 2, (now.y - before.y) / 2);
    fingers.set(event.pointerId, now);
  };

  canvas.addEventListener('pointermove', (event) => {
    if (fingers.size === 2 && fingers.has(event.pointerId)) {
      pinch(event);
      return;
    }
    if (drag && event.pointerId !== drag.pointer) return;
    const place = view.pick(at(event));
    page.hover(place);
    if (!drag) return;
    const { x, y } = at(event);
    if (drag.does === 'paint') {
      // All places since the last event, so that a fast stroke is as round as a slow one.
      const events = event.getCoalescedEvents?.() ?? [];
      for (const each of events.length > 0 ? events : [event]) {
        const on = view.pick(at(each));
        if (on) page.hand.move({ ...on, ...pressureOf(each) });
      }
    } else {
      view[drag.does](x - drag.last.x, y - drag.last.y);
    }
    drag.last = { x, y };
  });

  /** @param {PointerEvent} event @param {boolean} isOver */
  const lift = (event, isOver) => {
    fingers.delete(event.pointerId);
    if (!drag || event.pointerId !== drag.pointer) return;
    if (drag.does === 'paint') isOver ? page.hand.end() : page.hand.cancel();
    drag = null;
  };
  canvas.addEventListener('pointerup', (event) => lift(event, true));
  canvas.addEventListener('pointercancel', (event) => lift(event, false));
  canvas.addEventListener('pointerleave', () => {
    if (!drag) page.hover(null);
  });
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  // The middle button would scroll the page by itself.
  canvas.addEventListener('mousedown', (event) => {
    if (event.button === 1) event.preventDefault();
  });

  canvas.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      page.used();
      const step_px = event.deltaMode === 1 ? 16 : event.deltaMode === 2 ? 400 : 1;
      view.zoom(WHEEL_PER_STEP ** (-event.deltaY * step_px), at(event));
    },
    { passive: false },
  );

  const dab = () => {
    if (page.hand.isDrawing) return;
    page.hand.begin(view.middle());
    page.hand.end();
  };
  const arrows = { ArrowLeft: [KEY_px, 0], ArrowRight: [-KEY_px, 0], ArrowUp: [0, KEY_px], ArrowDown: [0, -KEY_px] };
  const keys = { PageUp: () => view.zoom(1.3), PageDown: () => view.zoom(1 / 1.3), f: () => view.fit(), Enter: dab };
  canvas.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const arrow = arrows[event.key];
    const act = arrow ? () => view[event.shiftKey ? 'pan' : 'turn'](...arrow) : keys[event.key];
    if (!act) return;
    event.preventDefault();
    event.stopPropagation();
    page.used();
    act();
  });
}
