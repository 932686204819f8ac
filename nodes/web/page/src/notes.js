// What the page tells: messages on the stage, and the line that screen readers read.

import { byId, make } from "./dom.js";

/** Tells something without showing it: for those who hear the page. */
export function say(text) {
  byId("live").textContent = text;
}

/**
 * Shows a message until it is closed, or for a while.
 * @param {string} text
 * @param {object} options `kind`: `error` or `info`; `action`: `{label, run}`; `key`: takes the place of the message of that key;
 *   `seconds`: how long it is shown
 * @returns {() => void} closes it
 */
export function note(text, { kind = "info", action, key = text, seconds } = {}) {
  drop(key);
  const box = make("div", { class: `note ${kind}`, role: kind === "error" ? "alert" : "status", dataset: { key } });
  const close = () => box.remove();
  box.append(make("p", {}, text));
  if (action !== undefined) {
    box.append(make("button", { onclick: () => { close(); action.run(); } }, action.label));
  }
  box.append(make("button", { class: "icon", "aria-label": "Close this message", onclick: close }, "×"));
  byId("notes").append(box);
  if (seconds !== undefined) {
    setTimeout(close, seconds * 1000);
  }
  return close;
}

/** Shows what went wrong. */
export const fault = (text, options = {}) => note(text, { kind: "error", ...options });

/** Closes the message of a key. */
export function drop(key) {
  for (const box of byId("notes").children) {
    if (box.dataset.key === key) {
      box.remove();
    }
  }
}

/**
 * Shows how far something is, with a way to end it.
 * @returns {{set: (share: number) => void, close: () => void}}
 */
export function progress(text, onCancel) {
  const bar = make("progress", { max: 1, value: 0, "aria-label": text });
  const box = make("div", { class: "note info", role: "status" },
    make("p", {}, text), bar, make("button", { onclick: onCancel }, "Cancel"));
  byId("notes").append(box);
  return { set: (share) => { bar.value = share; }, close: () => box.remove() };
}
