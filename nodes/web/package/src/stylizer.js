// A look for pictures of one size, frame after frame.

import { Program } from "./program.js";

/** A look ready for pictures of one size. {@link Isophote.stylizer} makes it. */
export class Stylizer {
  #isophote;
  #look;
  #picture;
  #plan;
  #program;
  /** Whether the planner is ahead of the device, which refused what it should build. */
  #isBehind = false;
  /** Updates follow one another, however long shaders compile. */
  #last = Promise.resolve();

  constructor(isophote, look, picture) {
    this.#isophote = isophote;
    this.#look = look;
    this.#picture = picture;
  }

  async start() {
    const { planner, kernels } = this.#isophote;
    const { json, bytes } = planner.ask({ ask: "plan", look: this.#look, picture: this.#picture });
    this.#plan = json.plan;
    this.#program = new Program(kernels);
    await this.#build(json, bytes);
    return this;
  }

  async #build(json, bytes) {
    const { planner, kernels } = this.#isophote;
    const shader = (dispatch) => planner.ask({ ask: "shader", plan: this.#plan, dispatch }).json;
    const compiled = await kernels.prepare(json.dispatches, shader);
    await this.#isophote.checked(() => this.#program.build(json, bytes, compiled));
  }

  get look() {
    return this.#look;
  }

  get width() {
    return this.#picture.width;
  }

  get height() {
    return this.#picture.height;
  }

  /**
   * Takes over another look, or what changed from frame to frame.
   * @returns whether uniform bytes alone changed (`"uniforms"`), or what is computed (`"structure"`)
   */
  update(look, { frame = this.#picture.frame ?? 0, origin = this.#picture.origin ?? [0, 0] } = {}) {
    const update = this.#last.then(async () => {
      const picture = { ...this.#picture, frame, origin };
      const { json, bytes } = this.#isophote.planner.ask({ ask: "update", plan: this.#plan, look, picture });
      [this.#look, this.#picture] = [look, picture];
      if (json.change === "uniforms" && !this.#isBehind) {
        this.#program.repack(json, bytes);
      } else {
        this.#isBehind = true;
        await this.#build(json, bytes);
        this.#isBehind = false;
      }
      return json.change;
    });
    this.#last = update.catch(() => {});
    return update;
  }

  /**
   * Records the look on textures of the same device.
   * @param {GPUCommandEncoder} encoder
   * @param {Record<string, GPUTexture>} inputs `color`, and the guides that the stylizer was made for
   * @returns {GPUTexture} what is computed; it is the same one until the structure changes
   */
  encode(encoder, inputs) {
    this.#program.bind(inputs);
    this.#program.encode(encoder);
    return this.#program.output;
  }

  /** Gives textures and plan back. */
  destroy() {
    this.#last = this.#last.then(() => {
      this.#program.destroy();
      this.#isophote.planner.ask({ ask: "release", plan: this.#plan });
    });
  }
}
