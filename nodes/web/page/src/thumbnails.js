// Small pictures of looks on what is open, one after the other while nothing else is computed.

import { pause } from "./dom.js";

/** Milliseconds that pass after the stage has come to rest. */
const REST = 120;

export class Thumbnails {
  #stage;
  #isophote = null;
  #source = null;
  #waiting = new Map();
  #isRunning = false;
  #round = 0;
  #isHeld = false;

  /** @param stage those of its frames come first */
  constructor(stage) {
    this.#stage = stage;
    // While something is dragged, the frames of the stage have the device for themselves.
    addEventListener("pointerdown", () => { this.#isHeld = true; }, true);
    for (const end of ["pointerup", "pointercancel", "dragend"]) {
      addEventListener(end, () => { this.#isHeld = false; }, true);
    }
  }

  /** Takes another picture: thumbnails that were made are of the old one. */
  setSource(isophote, source) {
    [this.#isophote, this.#source] = [isophote, source];
    this.#round += 1;
    this.#waiting.clear();
  }

  /**
   * Asks for a thumbnail.
   * @param key what asks, which asks once
   * @param done given the pixels
   */
  want(key, look, done) {
    this.#waiting.set(key, { look, done });
    this.#run();
  }

  /** Takes the wish back: what asked is out of sight. */
  forget(key) {
    this.#waiting.delete(key);
  }

  async #run() {
    if (this.#isRunning) {
      return;
    }
    this.#isRunning = true;
    while (this.#waiting.size > 0) {
      await pause(this.#isHeld || this.#stage.isBusy || document.hidden ? REST : 0);
      if (this.#isHeld || (this.#stage.isBusy && !this.#stage.subject?.isMoving) || document.hidden || this.#source === null) {
        continue;
      }
      // It may have been forgotten meanwhile.
      for (const [key, { look, done }] of [...this.#waiting].slice(0, 1)) {
        this.#waiting.delete(key);
        await this.#make(look, done);
      }
    }
    this.#isRunning = false;
  }

  async #make(look, done) {
    const round = this.#round;
    try {
      const image = await this.#isophote.apply(look, this.#source, { precision: this.#isophote.isSoftware ? "exact" : "half" });
      if (round === this.#round) {
        done(image);
      }
    } catch (error) {
      if (round === this.#round) {
        done(null, error);
      }
    }
  }
}
