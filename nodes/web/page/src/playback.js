// Plays the animations of models.

import { byId, isTyping, make } from "./dom.js";

export class Playback {
  #subject = null;

  constructor() {
    byId("play").addEventListener("click", () => this.#toggle());
    byId("clip").addEventListener("change", () => this.#play(true, byId("clip").selectedIndex));
    addEventListener("keydown", (event) => {
      const isFree = !isTyping() && !(document.activeElement instanceof HTMLButtonElement);
      if (event.key === " " && isFree && !byId("playback").hidden) {
        event.preventDefault();
        this.#toggle();
      }
    });
  }

  /** Takes what is shown, and plays it if it has animations. */
  show(subject) {
    this.#subject = subject;
    const clips = subject.clips ?? [];
    byId("playback").hidden = clips.length === 0;
    byId("clip").hidden = clips.length < 2;
    byId("clip").replaceChildren(...clips.map(({ name }, index) => make("option", { value: index }, name || `Animation ${index + 1}`)));
    if (clips.length > 0) {
      // Who asked for less motion starts it by hand.
      this.#play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
    }
  }

  #toggle() {
    this.#play(!this.#subject.isPlaying);
  }

  #play(isPlaying, clip) {
    this.#subject.play(isPlaying, clip);
    byId("play").setAttribute("aria-pressed", String(isPlaying));
    byId("play").textContent = isPlaying ? "Pause" : "Play";
  }
}
