// Pictures that the page brings along.

import { byId, make } from "./dom.js";
import { embedded } from "./engine.js";

/** All of them: what people call them, and their bytes. */
export function samples() {
  return [...document.querySelectorAll('script[id^="sample-"]')].map(({ id, dataset }) => ({
    name: dataset.label,
    blob: () => new Blob([embedded(id)], { type: "image/jpeg" }),
  }));
}

/**
 * The menu of samples under its button.
 * @param {{name: string, open: () => void}[]} entries
 */
export function menu(entries) {
  const button = byId("samples");
  const list = make("div", { class: "menu", role: "menu", "aria-label": "Samples", hidden: true });
  const close = (isBack) => {
    list.hidden = true;
    button.setAttribute("aria-expanded", "false");
    if (isBack) {
      button.focus();
    }
  };
  for (const { name, open } of entries) {
    list.append(make("button", { role: "menuitem", onclick: () => { close(true); open(); } }, name));
  }
  button.after(list);
  button.addEventListener("click", () => {
    const isOpen = !list.hidden;
    list.hidden = isOpen;
    list.style.left = `${button.offsetLeft}px`;
    button.setAttribute("aria-expanded", String(!isOpen));
    if (!isOpen) {
      list.firstChild.focus();
    }
  });
  list.addEventListener("keydown", (event) => {
    const items = [...list.children];
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step !== undefined) {
      event.preventDefault();
      items[(items.indexOf(document.activeElement) + step + items.length) % items.length].focus();
    } else if (event.key === "Escape") {
      close(true);
    }
  });
  addEventListener("pointerdown", (event) => {
    if (!list.hidden && !list.contains(event.target) && event.target !== button) {
      close(false);
    }
  });
}
