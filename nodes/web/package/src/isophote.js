// The door of the package.

import { apply } from "./apply.js";
import { Kernels } from "./kernels.js";
import { Painter } from "./painter.js";
import { Planner } from "./planner.js";
import { Stylizer } from "./stylizer.js";

/** Kinds of guides that may be pictures of a page; the others hold numbers beyond 0 to 1. */
const OF_EIGHT_BITS = ["scalar", "flow"];

/** The planner with a graphics device. */
export class Isophote {
  #catalogue;
  #lost = null;

  constructor(planner, device, { isSoftware = false } = {}) {
    this.planner = planner;
    this.device = device;
    this.kernels = new Kernels(device, isSoftware);
    this.painter = new Painter(device);
    this.isSoftware = isSoftware;
    device.lost.then(({ reason, message }) => {
      if (reason !== "destroyed") {
        this.#lost = `the graphics device was lost: ${message || "the browser does not say why"}; load the page again`;
      }
    });
  }

  /**
   * Loads the planner and opens a graphics device, or uses the page's.
   * @param options `wasm`: the planner's bytes or where it is, beside this file without; `device`: the page's own device;
   *   `adapter`: where a device is opened
   */
  static async create({ wasm = new URL("../isophote.wasm", import.meta.url), device, adapter } = {}) {
    const planner = await Planner.load(wasm);
    if (device !== undefined) {
      return new Isophote(planner, device, { isSoftware: device.adapterInfo?.isFallbackAdapter ?? false });
    }
    const found = adapter ?? await openAdapter();
    const { maxTextureDimension2D, maxBufferSize } = found.limits;
    const opened = await found.requestDevice({
      label: "isophote",
      requiredLimits: { maxTextureDimension2D, maxBufferSize },
    });
    return new Isophote(planner, opened, { isSoftware: found.info?.isFallbackAdapter ?? false });
  }

  /** All nodes with their inputs and parameters, and the guides. */
  get catalogue() {
    this.#catalogue ??= this.planner.ask({ ask: "catalogue" }).json;
    return this.#catalogue;
  }

  /**
   * The graph that a look comes to, with the parameters that differ from their defaults.
   * @throws {LookError} what is wrong with it
   */
  graph(look, frame = 0) {
    return this.planner.ask({ ask: "graph", look, frame }).json.graph;
  }

  /** Makes a look ready for pictures of one size; see `index.d.ts` for the options. */
  async stylizer(look, options) {
    return new Stylizer(this, look, picture(options)).start();
  }

  /**
   * The look on one picture of any size.
   * @param inputs the picture, or `{color, normal, depth, …}`: images, canvases, or textures of the same device
   * @returns {Promise<ImageData>}
   */
  async apply(look, inputs, options = {}) {
    const sources = "color" in inputs ? inputs : { color: inputs };
    const { width, height } = extent(sources.color);
    const given = this.catalogue.guides.filter(({ id }) => sources[id] !== undefined);
    const coarse = given.find(({ id, kind }) => !(sources[id] instanceof GPUTexture) && !OF_EIGHT_BITS.includes(kind));
    const guides = given.map(({ id }) => id);
    if (coarse !== undefined) {
      throw new Error(`the guide '${coarse.id}' holds numbers that a picture of a page cannot: give a texture of floats`);
    }
    const { precision, frame, origin, scale } = options;
    return apply(this, look, picture({ width, height, guides, precision, frame, origin, scale }), sources, options);
  }

  /** A picture as a texture that stylizers read: gamma-encoded, premultiplied, 8 bits. */
  texture(source) {
    const { width, height } = extent(source);
    const texture = this.device.createTexture({
      label: "picture",
      size: [width, height],
      format: "rgba8unorm",
      usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST | GPUTextureUsage.COPY_SRC
        | GPUTextureUsage.RENDER_ATTACHMENT,
    });
    this.device.queue.copyExternalImageToTexture({ source }, { texture, premultipliedAlpha: true }, [width, height]);
    return texture;
  }

  /** Runs what makes or uses objects of the device, and throws what the device says against it. */
  async checked(work) {
    if (this.#lost !== null) {
      throw new Error(this.#lost);
    }
    this.device.pushErrorScope("out-of-memory");
    this.device.pushErrorScope("validation");
    let failure = null;
    try {
      work();
    } catch (error) {
      failure = error;
    }
    // Both at once, so that scopes of the page do not come between.
    const [validation, memory] = await Promise.all([this.device.popErrorScope(), this.device.popErrorScope()]);
    if (this.#lost !== null) {
      throw new Error(this.#lost);
    }
    if (validation !== null) {
      throw new Error(`the graphics device refuses this: ${validation.message}`);
    }
    if (memory !== null) {
      throw new Error(`the graphics device has no memory for this: ${memory.message}`);
    }
    if (failure !== null) {
      throw failure;
    }
  }

  /** Gives the device back, if the page does not use it for other work. */
  destroy() {
    this.device.destroy();
  }
}

async function openAdapter() {
  if (!globalThis.navigator?.gpu) {
    throw new Error(
      "this browser has no WebGPU; Chrome and Edge have it from version 113, Safari from 26, Firefox from 141 (Windows) and 145 (macOS)",
    );
  }
  const adapter = await navigator.gpu.requestAdapter({ powerPreference: "high-performance" });
  if (adapter === null) {
    throw new Error("WebGPU finds no graphics adapter; see what about:gpu says of it, or update the graphics driver");
  }
  return adapter;
}

function picture({ width, height, space, alpha, precision, guides, frame, origin, scale }) {
  return { width, height, space, alpha, precision, guides, frame, origin, scale };
}

function extent(source) {
  const width = source.videoWidth ?? source.naturalWidth ?? source.displayWidth ?? source.width;
  const height = source.videoHeight ?? source.naturalHeight ?? source.displayHeight ?? source.height;
  return { width, height };
}
