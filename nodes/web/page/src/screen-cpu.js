// The picture in its look, computed by the processor: coarse at once, then as fine as the screen.

import { byId } from "./dom.js";

/** Computes and shows for the stage, where there is no graphics device; see `screen.js`. */
export class CpuScreen {
  #isophote;
  #canvas;
  #plain = byId("plain");
  #shown = null;
  #before = null;
  #abort = new AbortController();

  constructor(isophote, canvas) {
    [this.#isophote, this.#canvas] = [isophote, canvas];
    this.#plain.hidden = false;
  }

  get hasPicture() {
    return this.#shown !== null && this.#before !== null;
  }

  /** Another subject comes, which is not shown as what was before. */
  forget() {
    [this.#shown, this.#before] = [null, null];
    this.interrupt();
  }

  /** Takes back what is not computed yet: the look is another. */
  interrupt() {
    this.#abort.abort();
  }

  async compute(subject, look, { isCurrent, show }) {
    this.#abort = new AbortController();
    const { signal } = this.#abort;
    if (this.#before === null) {
      // The picture appears at once, plain, until there is something of the look.
      [this.#shown, this.#before] = [subject.worked, subject.worked];
      show();
    }
    try {
      for (const source of subject.steps) {
        const image = await this.#isophote.apply(look, source, { frame: subject.number, signal });
        const shown = await createImageBitmap(image);
        if (!isCurrent() || signal.aborted) {
          return;
        }
        this.#shown = shown;
        show();
      }
    } catch (error) {
      if (!signal.aborted) {
        throw error;
      }
    }
  }

  paint(viewport, edge) {
    const { width, height } = this.#canvas;
    if (this.#plain.width !== width || this.#plain.height !== height) {
      [this.#plain.width, this.#plain.height] = [width, height];
    }
    const context = this.#plain.getContext("2d");
    const [left, top] = viewport.toCanvas([0, 0]);
    const [across, down] = viewport.picture.map((length) => length * viewport.zoom);
    context.clearRect(0, 0, width, height);
    context.imageSmoothingQuality = "high";
    context.drawImage(this.#shown, left, top, across, down);
    if (edge > 0) {
      context.save();
      context.beginPath();
      context.rect(left, top, across * Math.min(edge, 1), down);
      context.clip();
      context.clearRect(left, top, across * Math.min(edge, 1), down);
      context.drawImage(this.#before, left, top, across, down);
      context.restore();
    }
  }

  close() {
    this.interrupt();
    this.#plain.hidden = true;
  }
}
