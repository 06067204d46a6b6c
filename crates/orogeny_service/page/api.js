// HTTP calls of the service. The token is never part of an address, since addresses end up in logs.

const TOKEN_KEY = 'orogeny.token';

/** An answer that was not what was asked for. */
export class ApiError extends Error {
  /** @param {number} status HTTP status; 0 where nothing answered @param {string} message */
  constructor(status, message) {
    super(message);
    this.status = status;
  }
}

/** @returns {string} the token; empty where there is none */
export const token = () => sessionStorage.getItem(TOKEN_KEY) ?? '';

/** @param {string} text */
export const setToken = (text) => sessionStorage.setItem(TOKEN_KEY, text);

/** @param {string} name a terrain's */
export const terrainPath = (name) => `/v1/terrains/${encodeURIComponent(name)}`;

/** @param {Response} response */
async function errorOf(response) {
  const body = await response.json().catch(() => null);
  const { message, limit } = body?.error ?? {};
  const about = limit === undefined ? '' : ` (limit: ${typeof limit === 'object' ? JSON.stringify(limit) : limit})`;
  return new ApiError(response.status, message ? message + about : `the service answered ${response.status} ${response.statusText}`);
}

/** @param {string} path @param {AbortSignal} [signal] @returns {Promise<Response>} */
export async function get(path, signal) {
  const headers = token() ? { Authorization: `Bearer ${token()}` } : {};
  let response;
  try {
    response = await fetch(path, { headers, signal, cache: 'no-store', credentials: 'omit' });
  } catch (error) {
    if (signal?.aborted) throw error;
    throw new ApiError(0, 'the service does not answer; is it still running?');
  }
  if (!response.ok) throw await errorOf(response);
  return response;
}

/** @param {string} path */
export const getJson = async (path) => (await get(path)).json();

/** Names of the terrains. @returns {Promise<string[]>} */
export async function terrainNames() {
  const { terrains } = await getJson('/v1/terrains');
  return terrains.map(({ name }) => name);
}

/** JSON Schemas of the brushes. @returns {Promise<object[]>} */
export async function brushSchemas() {
  const { brushes } = await getJson('/v1/brushes');
  return brushes.map(({ schema }) => schema);
}

/** Milliseconds there and back. */
export async function roundTrip_ms() {
  const begin_ms = performance.now();
  await get('/healthz');
  return performance.now() - begin_ms;
}
