// Page frames: 40 bytes of header, little-endian, then samples (docs/service.md, "Page frames").

const HEADER_BYTES = 40;
const MAGIC = 0x474f524f; // `OROG`
const VERSION = 1;
const PAGE_SAMPLES = 256;
const FORMATS = { r32: 0, r16: 1 };

/**
 * @typedef {object} Page
 * @property {number} level
 * @property {number} px page along x
 * @property {number} pz page along z
 * @property {number} width samples along x
 * @property {number} depth samples along z
 * @property {number} revision
 * @property {Float32Array} heights_m row by row from the north-west
 */

/** @param {ArrayBuffer} buffer @param {number} count */
function readR32(buffer, count) {
  const heights_m = new Float32Array(count);
  const view = new DataView(buffer, HEADER_BYTES);
  for (let i = 0; i < count; i += 1) heights_m[i] = view.getFloat32(4 * i, true);
  return heights_m;
}

/** @param {ArrayBuffer} buffer @param {number} count */
function readR16(buffer, count) {
  const heights_m = new Float32Array(count);
  const view = new DataView(buffer, HEADER_BYTES);
  const first_m = view.getFloat32(0, true);
  const step_m = view.getFloat32(4, true);
  for (let i = 0; i < count; i += 1) heights_m[i] = first_m + step_m * view.getUint16(8 + 2 * i, true);
  return heights_m;
}

/** @param {Float32Array} values */
function areFinite(values) {
  for (let i = 0; i < values.length; i += 1) if (!Number.isFinite(values[i])) return false;
  return true;
}

/**
 * Reads a frame. Never throws: whatever comes over the network is either a page, something to leave alone, or wrong.
 * @param {ArrayBuffer} buffer
 * @returns {{page: Page} | {skipped: string} | {wrong: string}}
 */
export function decodeFrame(buffer) {
  if (buffer.byteLength < HEADER_BYTES) return { wrong: `it has ${buffer.byteLength} bytes, fewer than a header` };
  const view = new DataView(buffer);
  if (view.getUint32(0, true) !== MAGIC) return { wrong: 'it does not begin with OROG' };
  const version = view.getUint16(4, true);
  if (version !== VERSION) return { wrong: `its header is of version ${version}, and this page reads version ${VERSION}` };
  // Later services may send more fields than heights; that is no error.
  if (view.getUint16(6, true) !== 0) return { skipped: 'another field' };

  const level = view.getUint8(8);
  const format = view.getUint8(9);
  const [width, depth] = [view.getUint16(10, true), view.getUint16(12, true)];
  const [px, pz] = [view.getUint32(16, true), view.getUint32(20, true)];
  const revision = Number(view.getBigUint64(24, true));
  const payload_bytes = view.getUint32(32, true);
  if (width < 1 || width > PAGE_SAMPLES || depth < 1 || depth > PAGE_SAMPLES) return { wrong: `it claims ${width} × ${depth} samples` };
  if (format !== FORMATS.r32 && format !== FORMATS.r16) return { wrong: `its format ${format} is unknown` };

  const count = width * depth;
  const needed_bytes = format === FORMATS.r32 ? 4 * count : 8 + 2 * count;
  if (payload_bytes !== needed_bytes || buffer.byteLength !== HEADER_BYTES + needed_bytes) {
    return { wrong: `it has ${buffer.byteLength - HEADER_BYTES} bytes of samples, announces ${payload_bytes} and needs ${needed_bytes}` };
  }
  const heights_m = format === FORMATS.r32 ? readR32(buffer, count) : readR16(buffer, count);
  if (!areFinite(heights_m)) return { wrong: 'it has heights that are no numbers' };
  return { page: { level, px, pz, width, depth, revision, heights_m } };
}
