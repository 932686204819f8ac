// The picture in its look, on a canvas. Looks are computed when something changes, never more than one frame ahead; showing
// another part of what is computed costs little and waits for nothing.

import { nextFrame } from "./dom.js";
import { precision } from "./engine.js";
import { isTimed } from "./look.js";
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
  #isophote = null;
  #canvas;
  #context;
  #subject = null;
  #stylizer = null;
  #look = null;
  /** Whether the look of the stylizer changes with the number of the frame, and the number that it has. */
  #isTimed = false;
  #number = 0;
  /** What is shown: 8 bits, so that painting is cheap and what is computed may change meanwhile. */
  #shown = null;
  #before = null;
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

  /** Takes a device, for the first time or after another was lost. */
  connect(isophote) {
    this.#isophote = isophote;
    this.#context ??= this.#canvas.getContext("webgpu");
    this.#context.configure({ device: isophote.device, format: navigator.gpu.getPreferredCanvasFormat(), alphaMode: "premultiplied" });
    [this.#stylizer, this.#shown, this.#subject] = [null, null, null];
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
    [this.#subject, this.#before] = [subject, null];
    this.#dirty = { look: true, picture: true };
    this.dispatchEvent(new Event("busy"));
    this.#resize();
    this.#compute();
  }

  /** Shows another look; of many in a row the newest counts. */
  setLook(look) {
    this.#look = look;
    this.#dirty.look = true;
    this.dispatchEvent(new Event("busy"));
    this.#compute();
  }

  /** Computes again, because the subject looks different. */
  renew() {
    this.#dirty.picture = true;
    this.#compute();
  }

  /** Shows what is computed anew, because another part is shown. */
  repaint() {
    this.dispatchEvent(new Event("view"));
    if (this.#paintsWaiting || this.#shown === null) {
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
    const { device } = this.#isophote;
    const [subject, look, dirty] = [this.#subject, this.#look, this.#dirty];
    this.#dirty = { look: false, picture: false };
    const { number } = subject;
    if (dirty.look || !this.#fits(subject)) {
      await this.#prepare(subject, look, number);
    } else if (this.#isTimed && number !== this.#number) {
      await this.#stylizer.update(look, { frame: number });
    }
    this.#number = number;
    const inputs = await subject.inputs();
    if (subject !== this.#subject) {
      return;
    }
    await this.#isophote.checked(() => {
      const encoder = device.createCommandEncoder();
      const picture = this.#stylizer.encode(encoder, inputs);
      this.#isophote.painter.paint(encoder, picture, this.#target(subject));
      device.queue.submit([encoder.finish()]);
    });
    if (subject !== this.#subject) {
      return;
    }
    this.#before = inputs.color;
    this.viewport.resize(this.viewport.canvas, [subject.width, subject.height]);
    this.#paint();
    await device.queue.onSubmittedWorkDone();
    if (!this.#dirty.look && !this.#dirty.picture) {
      this.dispatchEvent(new Event("shown"));
    }
  }

  #fits({ width, height }) {
    return this.#stylizer?.width === width && this.#stylizer.height === height;
  }

  /** A stylizer for the look: the same one as long as pictures have the size and the guides. */
  async #prepare(subject, look, number) {
    const guides = subject.guides.join();
    if (this.#fits(subject) && this.#stylizer.guides === guides) {
      await this.#stylizer.update(look, { frame: number });
      this.#isTimed = isTimed(look, this.#isophote.graph(look));
      return;
    }
    const { width, height } = subject;
    const options = { width, height, guides: subject.guides, frame: number, precision: precision(this.#isophote) };
    const made = await this.#isophote.stylizer(look, options);
    made.guides = guides;
    this.#stylizer?.destroy();
    this.#stylizer = made;
    this.#isTimed = isTimed(look, this.#isophote.graph(look));
  }

  #target({ width, height }) {
    if (this.#shown?.width !== width || this.#shown.height !== height) {
      this.#shown?.destroy();
      this.#shown = this.#isophote.device.createTexture({
        label: "shown",
        size: [width, height],
        format: "rgba8unorm",
        usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.TEXTURE_BINDING,
      });
    }
    return this.#shown;
  }

  #paint() {
    if (this.#shown === null || this.#before === null) {
      return;
    }
    const { device, painter } = this.#isophote;
    const encoder = device.createCommandEncoder();
    const edge = this.isOriginal ? 2 : this.edge;
    const options = { beside: this.#before, edge, ...this.viewport.part };
    painter.paint(encoder, this.#shown, this.#context.getCurrentTexture(), options);
    device.queue.submit([encoder.finish()]);
    this.dispatchEvent(new Event("view"));
  }
}
