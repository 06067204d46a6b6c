// The line at the bottom and the state of the connection.

const number = new Intl.NumberFormat(undefined, { maximumFractionDigits: 0 });
const precise = new Intl.NumberFormat(undefined, { minimumFractionDigits: 2, maximumFractionDigits: 2 });

/** @param {string} id */
const at = (id) => document.getElementById(id);

export class Footer {
  #roundTrip_ms = null;
  #seen_ms = null;

  /** @param {number | null} revision */
  revision(revision) {
    at('revision').textContent = revision === null ? '–' : String(revision);
  }

  /** @param {{x_m: number, z_m: number} | null} place @param {number | undefined} height_m */
  here(place, height_m) {
    const height = height_m === undefined ? 'height unknown' : `height ${precise.format(height_m)} m`;
    at('here').textContent = place
      ? `${height} at ${number.format(place.x_m)}, ${number.format(place.z_m)} m`
      : 'no place under the pointer';
  }

  /** @param {{roundTrip_ms?: number | null, seen_ms?: number | null}} measured */
  latency({ roundTrip_ms = this.#roundTrip_ms, seen_ms = this.#seen_ms }) {
    [this.#roundTrip_ms, this.#seen_ms] = [roundTrip_ms, seen_ms];
    const text = (value_ms) => (value_ms < 10 ? value_ms.toFixed(1) : value_ms.toFixed(0));
    const parts = [
      roundTrip_ms === null ? '' : `round trip ${text(roundTrip_ms)} ms`,
      seen_ms === null ? '' : `stroke seen after ${text(seen_ms)} ms`,
    ];
    at('latency').textContent = parts.filter(Boolean).join(' · ');
  }

  /** @param {{stage?: string, done?: number, total?: number} | null} progress */
  progress(progress) {
    const bar = at('progress');
    bar.hidden = progress === null;
    at('stage-name').textContent = progress?.stage ?? '';
    if (!progress) return;
    if (progress.total > 0) Object.assign(bar, { max: progress.total, value: progress.done ?? 0 });
    else bar.removeAttribute('value');
  }

  /** @param {number} level @param {number} num_pages */
  selection(level, num_pages) {
    at('traffic').textContent = `level ${level}, ${num_pages} page${num_pages === 1 ? '' : 's'}`;
  }

  /** @param {'waiting' | 'open' | 'lost'} state @param {string} text */
  connection(state, text) {
    at('connection').dataset.state = state;
    at('connection').textContent = text;
  }
}
