// Small helpers for elements.

/** The element with an id. */
export const byId = (id) => document.getElementById(id);

/**
 * Makes an element.
 * @param {string} name its tag
 * @param {Record<string, unknown>} properties `class`, `dataset` and `aria-…` are attributes, `on…` are listeners, others properties
 * @param {...(Node|string|null|undefined)} children nothing is left out
 */
export function make(name, properties = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (value === undefined || value === null) {
      continue;
    }
    if (key.startsWith("on")) {
      element.addEventListener(key.slice(2), value);
    } else if (key === "dataset") {
      Object.assign(element.dataset, value);
    } else if (key === "class" || key === "for" || key === "role" || key.startsWith("aria-")) {
      element.setAttribute(key, value);
    } else {
      element[key] = value;
    }
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

/** Whether keys that are pressed now belong to a field. */
export function isTyping() {
  const { activeElement: at } = document;
  return at instanceof HTMLSelectElement || at instanceof HTMLTextAreaElement || at?.isContentEditable
    || (at instanceof HTMLInputElement && ["text", "search", "number"].includes(at.type));
}

/** Resolves before the browser paints next, which it does not while the page is in the background. */
export const nextFrame = () => new Promise((resolve) => { requestAnimationFrame(resolve); });

/** Resolves after so many milliseconds. */
export const pause = (milliseconds) => new Promise((resolve) => { setTimeout(resolve, milliseconds); });

/** Hands a file to the person. */
export function download(blob, name) {
  const url = URL.createObjectURL(blob);
  make("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}
