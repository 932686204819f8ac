// The picture in its look, on a canvas. Looks are computed when something changes, never more than one frame ahead; showing
// another part of what is computed costs little and waits for nothing.

import { nextFrame } from "./dom.js";
import { Screen } from "./screen.js";
import { CpuScreen } from "./screen-cpu.js";
import { Viewport } from "./viewport.js";

/**
 * Fires `busy` when something is to be computed, `shown` when a frame of the newest look is on the canvas, `rest` when nothing
 * is left to do, and `view` when another part is shown.
 *
 * A subject is what is stylized: `{width, height, guides, isMoving, number, inputs()}`, where `inputs` are textures of the size
 * and `number` is that of the frame; see `picture.js` and `model.js`.
 */
export class Stage extends EventTarget {
  viewport = new Viewport();
  /** Where the look begins, in sizes of the picture. */
  edge = 0;
  /** Whether the original is shown alone. */
  isOriginal = false;
  #canvas;
  /** What computes and shows: a device, or the processor. */
  #screen = null;
  #subject = null;
  #look = null;
  #dirty = { look: false, picture: false };
  #isComputing = false;
  #paintsWaiting = false;
  #onFault;

  /** @param {(error: Error) => void} onFault told what failed */
  constructor(canvas, onFault) {
    super();
    this.#canvas = canvas;
    this.#onFault = onFault;
    new ResizeObserver(() => this.#resize()).observe(canvas.parentElement);
  }

  /** Takes what computes, for the first time or after a device was lost. */
  connect(isophote) {
    this.#screen?.close();
    this.#screen = isophote.backend === "gpu" ? new Screen(isophote, this.#canvas) : new CpuScreen(isophote, this.#canvas);
    this.#subject = null;
  }

  get subject() {
    return this.#subject;
  }

  /** Whether something is computed or waits for it. */
  get isBusy() {
    return this.#isComputing || this.#dirty.look || this.#dirty.picture;
  }

  /** Where models are turned. */
  get canvas() {
    return this.#canvas;
  }

  /** Pixels of the canvas. */
  get size() {
    return [this.#canvas.width, this.#canvas.height];
  }

  /** Shows another picture or model. */
  show(subject) {
    this.#subject?.close();
    this.#subject = subject;
    this.#screen.forget();
    this.#dirty = { look: true, picture: true };
    this.dispatchEvent(new Event("busy"));
    this.#resize();
    this.#compute();
  }

  /** Shows another look; of many in a row the newest counts. */
  setLook(look) {
    this.#look = look;
    this.#dirty.look = true;
    this.#screen.interrupt();
    this.dispatchEvent(new Event("busy"));
    this.#compute();
  }

  /** Computes again, because the subject looks different. */
  renew() {
    this.#dirty.picture = true;
    this.dispatchEvent(new Event("busy"));
    this.#compute();
  }

  /** Shows what is computed anew, because another part is shown. */
  repaint() {
    this.dispatchEvent(new Event("view"));
    if (this.#paintsWaiting || !this.#screen?.hasPicture) {
      return;
    }
    this.#paintsWaiting = true;
    nextFrame().then(() => {
      this.#paintsWaiting = false;
      this.#paint();
    });
  }

  #resize() {
    const { clientWidth, clientHeight } = this.#canvas.parentElement;
    const ratio = Math.min(devicePixelRatio, 2);
    const [width, height] = [clientWidth, clientHeight].map((side) => Math.max(1, Math.round(side * ratio)));
    if (width !== this.#canvas.width || height !== this.#canvas.height) {
      [this.#canvas.width, this.#canvas.height] = [width, height];
    }
    if (this.#subject !== null) {
      if (this.#subject.fill?.(width, height)) {
        this.renew();
      }
      this.viewport.resize([width, height], [this.#subject.width, this.#subject.height]);
    }
    this.repaint();
  }

  /** Computes until nothing is left to do. One run at a time; what comes meanwhile makes another round. */
  async #compute() {
    if (this.#isComputing || this.#subject === null || this.#look === null) {
      return;
    }
    this.#isComputing = true;
    try {
      while (this.#dirty.look || this.#dirty.picture || this.#subject.isMoving) {
        await nextFrame();
        await this.#round();
      }
    } catch (error) {
      this.#dirty = { look: false, picture: false };
      this.#onFault(error);
    } finally {
      this.#isComputing = false;
      this.dispatchEvent(new Event("rest"));
    }
  }

  async #round() {
    const [subject, look, dirty] = [this.#subject, this.#look, this.#dirty];
    this.#dirty = { look: false, picture: false };
    const isCurrent = () => subject === this.#subject;
    const show = () => {
      this.viewport.resize(this.viewport.canvas, [subject.width, subject.height]);
      this.#paint();
    };
    await this.#screen.compute(subject, look, { isNewLook: dirty.look, isCurrent, show });
    if (isCurrent() && !this.#dirty.look && !this.#dirty.picture) {
      this.dispatchEvent(new Event("shown"));
    }
  }

  #paint() {
    if (this.#screen.hasPicture) {
      this.#screen.paint(this.viewport, this.isOriginal ? 2 : this.edge);
      this.dispatchEvent(new Event("view"));
    }
  }
}
