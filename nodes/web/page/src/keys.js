// Keys of the whole page, and the tabs of narrow windows.

import { byId, isTyping } from "./dom.js";

/** Connects keys with what they do. */
export function keys(page) {
  addEventListener("keydown", (event) => {
    const key = event.key.toLowerCase();
    if (event.ctrlKey || event.metaKey) {
      // Fields undo what is typed into them.
      const run = isTyping() ? undefined : withControl(page, key, event.shiftKey);
      if (run !== undefined) {
        event.preventDefault();
        run();
      }
    } else if (!event.altKey && !isTyping()) {
      const plain = { w: () => page.wipe.toggle(), r: () => page.reset(), "/": () => byId("search").focus() }[key];
      if (plain !== undefined) {
        event.preventDefault();
        plain();
      }
    }
  });
}

function withControl(page, key, isShifted) {
  return {
    z: () => (isShifted ? page.session.redo() : page.session.undo()),
    y: () => page.session.redo(),
    s: () => page.save(),
    o: () => byId("open").click(),
  }[key];
}

/** Where the window is narrow, one panel is shown at a time. */
export function tabs() {
  const buttons = [...byId("tabs").children];
  const show = (name) => {
    document.body.dataset.tab = name;
    buttons.forEach((button) => button.setAttribute("aria-pressed", String(button.dataset.tab === name)));
  };
  buttons.forEach((button) => button.addEventListener("click", () => show(button.dataset.tab)));
  show("looks");
}
