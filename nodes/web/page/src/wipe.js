// The edge between the original and the look, and the key that shows the original.

import { byId, isTyping } from "./dom.js";

/** Connects the edge with the stage. */
export class Wipe {
  #stage;
  #handle = byId("wipe");
  #tag = byId("before");
  #isOn = false;

  constructor(stage) {
    this.#stage = stage;
    stage.addEventListener("view", () => this.#place());
    this.#listen();
    byId("compare").addEventListener("click", () => this.toggle());
    holds(byId("original"), (isHeld) => this.#original(isHeld));
    addEventListener("keydown", (event) => {
      if (event.key.toLowerCase() === "o" && !isTyping() && !event.ctrlKey && !event.metaKey) {
        this.#original(true);
      }
    });
    addEventListener("keyup", (event) => event.key.toLowerCase() === "o" && this.#original(false));
    addEventListener("blur", () => this.#original(false));
  }

  /** Shows the edge in the middle of what is seen, or takes it away. */
  toggle(isOn = !this.#isOn) {
    this.#isOn = isOn;
    byId("compare").setAttribute("aria-pressed", String(isOn));
    const { canvas, picture } = this.#stage.viewport;
    this.#stage.edge = isOn ? this.#stage.viewport.toPicture([canvas[0] / 2, 0])[0] / picture[0] : 0;
    this.#stage.repaint();
  }

  #original(isShown) {
    if (this.#stage.isOriginal !== isShown) {
      this.#stage.isOriginal = isShown;
      byId("original").classList.toggle("held", isShown);
      this.#stage.repaint();
    }
  }

  #listen() {
    const handle = this.#handle;
    const move = (event) => {
      const box = byId("canvas").getBoundingClientRect();
      const { canvas, picture } = this.#stage.viewport;
      const x = ((event.clientX - box.left) / box.width) * canvas[0];
      this.#set(this.#stage.viewport.toPicture([x, 0])[0] / picture[0]);
    };
    handle.addEventListener("pointerdown", (event) => {
      handle.setPointerCapture(event.pointerId);
      handle.addEventListener("pointermove", move);
      event.preventDefault();
      handle.focus();
    });
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
      handle.addEventListener(end, () => handle.removeEventListener("pointermove", move));
    }
    handle.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -0.02, ArrowRight: 0.02, PageDown: -0.1, PageUp: 0.1, Home: -1, End: 1 }[event.key];
      if (step !== undefined) {
        event.preventDefault();
        event.stopPropagation();
        this.#set(this.#stage.edge + step);
      }
    });
  }

  #set(edge) {
    this.#stage.edge = Math.min(Math.max(edge, 0), 1);
    this.#stage.repaint();
  }

  #place() {
    const { viewport, edge, isOriginal, subject } = this.#stage;
    const [width, height] = viewport.canvas;
    const across = viewport.toCanvas([edge * viewport.picture[0], 0])[0] / width;
    const top = Math.max(0, viewport.toCanvas([0, 0])[1] / height);
    const bottom = Math.min(1, viewport.toCanvas([0, viewport.picture[1]])[1] / height);
    const isShown = this.#isOn && subject !== null && !isOriginal;
    this.#handle.hidden = !isShown || across < -0.001 || across > 1.001;
    this.#handle.style.left = `${across * 100}%`;
    this.#handle.style.top = `${top * 100}%`;
    this.#handle.style.height = `${(bottom - top) * 100}%`;
    this.#handle.setAttribute("aria-valuenow", String(Math.round(edge * 100)));
    this.#tag.hidden = !(isOriginal || (isShown && across > 0.12));
  }
}

/** Tells while a button is held, by pointer or key. */
function holds(button, tell) {
  button.addEventListener("pointerdown", (event) => {
    button.setPointerCapture(event.pointerId);
    tell(true);
  });
  button.addEventListener("contextmenu", (event) => event.preventDefault());
  for (const end of ["pointerup", "pointercancel", "lostpointercapture", "blur"]) {
    button.addEventListener(end, () => tell(false));
  }
  button.addEventListener("keydown", (event) => [" ", "Enter"].includes(event.key) && tell(true));
  button.addEventListener("keyup", () => tell(false));
}
