// Asks for the token where the service wants one.

import { ApiError, setToken, token } from './api.js';

/** @returns {Promise<void>} when one was given */
function ask() {
  const dialog = document.getElementById('token-dialog');
  const form = document.getElementById('token-form');
  const input = document.getElementById('token');
  if (token()) {
    dialog.dataset.refused = '';
    document.getElementById('token-why').textContent =
      'The service did not take this token. Ask whoever runs it for the one it was started with.';
  }
  input.value = '';
  // Without a token there is nothing to go back to.
  dialog.oncancel = (event) => event.preventDefault();
  if (!dialog.open) dialog.showModal();
  input.focus();
  return new Promise((resolve) => {
    form.onsubmit = (event) => {
      event.preventDefault();
      setToken(input.value.trim());
      dialog.close();
      resolve();
    };
  });
}

/**
 * Calls, and asks for the token for as long as it is refused.
 * @template T @param {() => Promise<T>} call @returns {Promise<T>}
 */
export async function withToken(call) {
  for (;;) {
    try {
      return await call();
    } catch (error) {
      if (!(error instanceof ApiError) || error.status !== 401) throw error;
      await ask();
    }
  }
}
