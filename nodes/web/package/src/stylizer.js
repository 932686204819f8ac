// A look for pictures of one size, frame after frame.

import { History } from "./history.js";
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
  /** Textures of frames before; none for looks that take every frame by itself, or know no motion. */
  #history = null;
  /** Frames before that the plan reads. */
  #past = 0;
  #isFollowing = false;

  constructor(isophote, look, picture) {
    this.#isophote = isophote;
    this.#look = look;
    // Where points move is known from frame to frame.
    this.#picture = picture.guides?.includes("motion") ? { ...picture, past: 0 } : picture;
  }

  async start() {
    this.#program = new Program(this.#isophote.kernels);
    await this.#replan(0);
    return this;
  }

  /** Plans anew for so many frames before that are known; until its shaders are compiled the old plan runs on. */
  async #replan(past, isCut = false) {
    const { planner } = this.#isophote;
    const picture = "past" in this.#picture ? { ...this.#picture, past } : this.#picture;
    const { json, bytes } = planner.ask({ ask: "plan", look: this.#look, picture });
    const old = this.#plan;
    this.#plan = json.plan;
    if (old !== undefined) {
      planner.ask({ ask: "release", plan: old });
    }
    await this.#build(json, bytes, () => {
      this.#past = past;
      if (isCut || !this.#reads(json.history)) {
        this.#history?.destroy();
        this.#history = json.history === null ? null : new History(this.#isophote.device, json.history);
      }
    });
  }

  /** Compiles what a program needs and takes it over, together with what `adopt` does. */
  async #build(json, bytes, adopt = () => {}) {
    const { planner, kernels } = this.#isophote;
    const shader = (dispatch) => planner.ask({ ask: "shader", plan: this.#plan, dispatch }).json;
    this.#isBehind = true;
    const compiled = await kernels.prepare(json.dispatches, shader);
    await this.#isophote.checked(() => {
      this.#program.build(json, bytes, compiled);
      adopt();
    });
    this.#isBehind = false;
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
    return this.#after(async () => {
      const picture = { ...this.#picture, frame, origin };
      const { json, bytes } = this.#isophote.planner.ask({ ask: "update", plan: this.#plan, look, picture });
      [this.#look, this.#picture] = [look, picture];
      if (!this.#reads(json.history)) {
        await this.#replan(0);
        return "structure";
      }
      if (json.change === "uniforms" && !this.#isBehind) {
        this.#program.repack(json, bytes);
      } else {
        await this.#build(json, bytes);
      }
      return json.change;
    });
  }

  /** True where frames read of those before what they read now. */
  #reads(history) {
    return history === null ? this.#history === null : this.#history?.isLike(history) === true;
  }

  #after(work) {
    const done = this.#last.then(work);
    this.#last = done.catch(() => {});
    return done;
  }

  /** Takes the next frame for the first of a shot: what was before counts no longer. */
  cut() {
    return this.#after(() => this.#replan(0, true));
  }

  /**
   * Records the look on textures of the same device: the next frame, where looks are steady over time.
   * @param {GPUCommandEncoder} encoder
   * @param {Record<string, GPUTexture>} inputs `color`, and the guides that the stylizer was made for
   * @returns {GPUTexture} what is computed; it is the same one until the structure changes
   */
  encode(encoder, inputs) {
    const history = this.#history;
    if (history === null) {
      this.#program.bind(inputs);
      this.#program.encode(encoder);
      return this.#program.output;
    }
    const { textures } = this.#program;
    this.#program.bind({ ...inputs, ...history.read(textures), ...history.written(textures) });
    this.#program.encode(encoder);
    history.advance(encoder, inputs);
    this.#follow();
    return this.#program.output;
  }

  /** Plans for the frames that are known now, where those are more than the plan reads. */
  #follow() {
    if (this.#isFollowing || this.#history.known <= this.#past) {
      return;
    }
    this.#isFollowing = true;
    const follow = this.#after(async () => {
      const known = this.#history?.known ?? 0;
      if (known > this.#past) {
        await this.#replan(known);
      }
    });
    follow.catch(console.error).finally(() => { this.#isFollowing = false; });
  }

  /** Gives textures and plan back. */
  destroy() {
    this.#last = this.#last.then(() => {
      this.#program.destroy();
      this.#history?.destroy();
      this.#isophote.planner.ask({ ask: "release", plan: this.#plan });
    });
  }
}
