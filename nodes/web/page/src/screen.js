// The picture in its look, computed and shown by a graphics device.

import { precision } from "./engine.js";
import { isTimed } from "./look.js";

/**
 * Computes and shows for the stage. `screen-cpu.js` has one for the processor.
 */
export class Screen {
  #isophote;
  #context;
  #stylizer = null;
  /** Whether the look of the stylizer changes with the number of the frame, and the number that it has. */
  #isTimed = false;
  #number = 0;
  /** What is shown: 8 bits, so that painting is cheap and what is computed may change meanwhile. */
  #shown = null;
  #before = null;

  constructor(isophote, canvas) {
    this.#isophote = isophote;
    this.#context = canvas.getContext("webgpu");
    this.#context.configure({ device: isophote.device, format: navigator.gpu.getPreferredCanvasFormat(), alphaMode: "premultiplied" });
  }

  /** Whether there is something to show. */
  get hasPicture() {
    return this.#shown !== null && this.#before !== null;
  }

  /** Forgets what the original was: another subject comes. */
  forget() {
    this.#before = null;
  }

  /** Takes back what is computed now, where that can be: the look is another. A device is soon done. */
  interrupt() {}

  /**
   * Computes a look on a subject.
   * @param {{isNewLook: boolean, isCurrent: () => boolean, show: () => void}} round `show` paints, when there is something new
   */
  async compute(subject, look, { isNewLook, isCurrent, show }) {
    const { device } = this.#isophote;
    const { number } = subject;
    if (isNewLook || !this.#fits(subject)) {
      await this.#prepare(subject, look, number);
    } else if (this.#isTimed && number !== this.#number) {
      await this.#stylizer.update(look, { frame: number });
    }
    this.#number = number;
    const inputs = await subject.inputs();
    if (!isCurrent()) {
      return;
    }
    await this.#isophote.checked(() => {
      const encoder = device.createCommandEncoder();
      const picture = this.#stylizer.encode(encoder, inputs);
      this.#isophote.painter.paint(encoder, picture, this.#target(subject));
      device.queue.submit([encoder.finish()]);
    });
    if (!isCurrent()) {
      return;
    }
    this.#before = inputs.color;
    show();
    await device.queue.onSubmittedWorkDone();
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

  /** Shows a part of the picture, left of the edge the original. */
  paint(viewport, edge) {
    const { device, painter } = this.#isophote;
    const encoder = device.createCommandEncoder();
    const options = { beside: this.#before, edge, ...viewport.part };
    painter.paint(encoder, this.#shown, this.#context.getCurrentTexture(), options);
    device.queue.submit([encoder.finish()]);
  }

  /** Shows nothing any more. */
  close() {
    this.#context.unconfigure();
  }
}
