// Zooming and panning of pictures, by pointer, wheel, fingers and keys. Models are turned instead (`model.js`).

import { byId, isTyping } from "./dom.js";

/** Zoom by one press of a key or button. */
const STEP = 1.25;

export class Navigation {
  #stage;
  #canvas;
  #pointers = new Map();

  constructor(stage, canvas) {
    [this.#stage, this.#canvas] = [stage, canvas];
    canvas.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    canvas.addEventListener("pointerdown", (event) => this.#down(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, (event) => this.#pointers.delete(event.pointerId));
    }
    canvas.addEventListener("dblclick", () => this.#isFree && this.toggle());
    byId("zoom-in").addEventListener("click", () => this.zoom(STEP));
    byId("zoom-out").addEventListener("click", () => this.zoom(1 / STEP));
    byId("zoom").addEventListener("click", () => this.toggle());
    addEventListener("keydown", (event) => this.#key(event));
    stage.addEventListener("view", () => this.#label());
  }

  /** Whether the picture itself is moved. */
  get #isFree() {
    return this.#stage.subject?.kind === "picture";
  }

  /** Zooms about the middle. */
  zoom(factor, at) {
    if (this.#isFree) {
      this.#stage.viewport.zoomAt(factor, at);
    } else {
      this.#stage.subject?.zoom(factor);
    }
    this.#stage.repaint();
  }

  /** Shows all of it. */
  fit() {
    this.#stage.viewport.fit();
    this.#stage.subject?.frame?.();
    this.#stage.repaint();
  }

  /** Shows one pixel for each, or all of it if that is shown. */
  toggle() {
    const { viewport } = this.#stage;
    if (viewport.isFit && this.#isFree) {
      this.zoom(1 / viewport.zoom);
    } else {
      this.fit();
    }
  }

  #at(event) {
    const box = this.#canvas.getBoundingClientRect();
    const ratio = this.#canvas.width / box.width;
    return [(event.clientX - box.left) * ratio, (event.clientY - box.top) * ratio];
  }

  #wheel(event) {
    if (this.#isFree) {
      event.preventDefault();
      const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? event.deltaY * 30 : event.deltaY;
      this.zoom(Math.exp(-Math.min(Math.max(lines, -300), 300) * (event.ctrlKey ? 0.01 : 0.002)), this.#at(event));
    }
  }

  #down(event) {
    if (this.#isFree && event.button <= 1) {
      this.#canvas.setPointerCapture(event.pointerId);
      this.#pointers.set(event.pointerId, this.#at(event));
    }
  }

  #move(event) {
    const before = this.#pointers.get(event.pointerId);
    if (before === undefined) {
      return;
    }
    const now = this.#at(event);
    const other = [...this.#pointers].find(([id]) => id !== event.pointerId)?.[1];
    this.#pointers.set(event.pointerId, now);
    if (other === undefined) {
      this.#stage.viewport.pan(now[0] - before[0], now[1] - before[1]);
    } else {
      const far = (a) => Math.hypot(a[0] - other[0], a[1] - other[1]);
      const middle = [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2];
      this.#stage.viewport.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
      this.#stage.viewport.zoomAt(far(now) / Math.max(far(before), 1), middle);
    }
    this.#stage.repaint();
  }

  #key(event) {
    if (isTyping() || event.ctrlKey || event.metaKey || event.altKey) {
      return;
    }
    const moves = { ArrowLeft: [60, 0], ArrowRight: [-60, 0], ArrowUp: [0, 60], ArrowDown: [0, -60] };
    const move = document.activeElement === this.#canvas ? moves[event.key] : undefined;
    if (event.key === "+" || event.key === "=") {
      this.zoom(STEP);
    } else if (event.key === "-") {
      this.zoom(1 / STEP);
    } else if (event.key === "0") {
      this.fit();
    } else if (event.key === "1" && this.#isFree) {
      this.zoom(1 / this.#stage.viewport.zoom);
    } else if (move !== undefined) {
      event.preventDefault();
      this.#step(move);
    }
  }

  /** Moves a picture, or turns a model. */
  #step([x, y]) {
    if (this.#isFree) {
      this.#stage.viewport.pan(x, y);
      this.#stage.repaint();
    } else {
      this.#stage.subject?.turn(-x / 6, y / 6);
    }
  }

  #label() {
    const { viewport, subject } = this.#stage;
    byId("zoom").textContent = viewport.isFit || subject?.kind !== "picture" ? "Fit" : `${Math.round(viewport.zoom * 100)} %`;
  }
}
