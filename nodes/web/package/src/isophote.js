// The door of the package.

import { apply } from "./apply.js";
import { applyOnCpu } from "./apply-cpu.js";
import { Kernels } from "./kernels.js";
import { Painter } from "./painter.js";
import { Planner, bytesOf } from "./planner.js";
import { Processor } from "./processor.js";
import { Stylizer } from "./stylizer.js";

/** Kinds of guides that may be pictures of a page; the others hold numbers beyond 0 to 1. */
const OF_EIGHT_BITS = ["scalar", "flow"];

/** The planner with a graphics device, or with the processor where there is none. */
export class Isophote {
  #catalogue;
  #device = null;
  #processor = null;
  #cpu;
  #reason = null;
  #lost = null;

  /** Takes the planner alone; see {@link Isophote.create}. */
  constructor(planner, cpu = {}) {
    this.planner = planner;
    this.#cpu = cpu;
  }

  /**
   * Loads the planner and opens a graphics device, or uses the page's. Where there is none the processor computes.
   * @param options `wasm`: the planner's bytes or where it is, beside this file without; `device`: the page's own device;
   *   `adapter`: where a device is opened; `backend`: `gpu` and `cpu` allow no other; `cpu`: the module and the worker of the
   *   processor, beside this file without
   */
  static async create({ wasm = new URL("../isophote.wasm", import.meta.url), device, adapter, backend = "auto", cpu } = {}) {
    const isophote = new Isophote(await Planner.load(wasm), backend === "gpu" ? null : { ...cpu });
    if (device !== undefined) {
      isophote.#use(device, device.adapterInfo?.isFallbackAdapter ?? false);
    } else if (backend === "cpu") {
      isophote.#compute(null);
    } else {
      await isophote.#open(adapter);
    }
    return isophote;
  }

  async #open(given) {
    try {
      const adapter = given ?? await openAdapter();
      const { maxTextureDimension2D, maxBufferSize } = adapter.limits;
      const device = await adapter.requestDevice({
        label: "isophote",
        requiredLimits: { maxTextureDimension2D, maxBufferSize },
      });
      this.#use(device, adapter.info?.isFallbackAdapter ?? false);
    } catch (error) {
      if (this.#cpu === null) {
        throw error;
      }
      this.#compute(error.message);
    }
  }

  #use(device, isSoftware) {
    this.#device = device;
    this.kernels = new Kernels(device, isSoftware);
    this.painter = new Painter(device);
    this.isSoftware = isSoftware;
    device.lost.then(({ reason, message }) => {
      if (reason !== "destroyed") {
        this.#lost = `the graphics device was lost: ${message || "the browser does not say why"}; load the page again`;
      }
    });
  }

  /** Lets the processor compute. */
  #compute(reason) {
    const {
      wasm = new URL("../isophote-cpu.wasm", import.meta.url),
      worker = () => new Worker(new URL("./cpu-worker.js", import.meta.url), { type: "module" }),
    } = this.#cpu;
    this.#processor = new Processor(() => bytesOf(typeof wasm === "function" ? wasm() : wasm), worker);
    [this.#device, this.#reason] = [null, reason];
    this.isSoftware = true;
  }

  /** What computes: `gpu` or `cpu`. */
  get backend() {
    return this.#processor === null ? "gpu" : "cpu";
  }

  /** Why the processor computes though it was not asked for; `null` where it does not. */
  get reason() {
    return this.#reason;
  }

  /** @throws {Error} where the processor computes */
  get device() {
    this.#needsDevice();
    return this.#device;
  }

  #needsDevice() {
    if (this.#device === null) {
      throw new Error(`there is no graphics device: ${this.#reason ?? "the processor was asked for"}. On the processor, pictures are stylized by 'apply'`);
    }
  }

  /** What computes where there is no device. */
  get processor() {
    return this.#processor;
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
    this.#needsDevice();
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
    const coarse = given.find(({ id, kind }) => !isTexture(sources[id]) && !OF_EIGHT_BITS.includes(kind));
    const guides = given.map(({ id }) => id);
    if (coarse !== undefined) {
      throw new Error(`the guide '${coarse.id}' holds numbers that a picture of a page cannot: give a texture of floats`);
    }
    const { precision, frame, origin, scale } = options;
    const wanted = picture({ width, height, guides, precision, frame, origin, scale });
    if (this.#processor === null) {
      try {
        return await apply(this, look, wanted, sources, options);
      } catch (error) {
        const isOnDevice = Object.values(sources).some(isTexture);
        if (this.#lost === null || this.#cpu === null || isOnDevice) {
          throw error;
        }
        // The device does not come back, and the picture is still here.
        this.#compute(this.#lost);
      }
    }
    return applyOnCpu(this, look, wanted, sources, options);
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

  /** Gives the device back, if the page does not use it for other work, or the threads. */
  destroy() {
    this.#device?.destroy();
    this.#processor?.destroy();
  }
}

/** Whether it lies on a device; browsers without WebGPU know no such thing. */
const isTexture = (source) => typeof GPUTexture !== "undefined" && source instanceof GPUTexture;

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
