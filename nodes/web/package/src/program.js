// A program of the planner on a device: textures, one buffer for all uniform blocks, bind groups and dispatches.
//
// The same work in Rust is `host-example/src/plan_runner.rs`.

import { isStage } from "./history.js";
import { SAMPLER } from "./kernels.js";

const BYTES = { r32float: 4, rg32float: 8, rgba32float: 16, rgba16float: 8 };

/** Pixels of a texture of a program. */
export function size({ window: [x0, y0, x1, y1] }) {
  return [x1 - x0, y1 - y0];
}

/** Bytes of all textures of a program that are not its inputs. */
export function memory(program) {
  const own = program.textures.filter(({ role }) => role !== "input");
  return own.reduce((sum, texture) => sum + size(texture)[0] * size(texture)[1] * BYTES[texture.format], 0);
}

/** True for a texture that is handed in: an input, or a stage that later frames read. */
const isBound = ({ role, name }) => role === "input" || (role === "output" && isStage(name));

/** A program, ready to be recorded again and again. */
export class Program {
  #kernels;
  #textures = [];
  #dispatches = [];
  #uniforms;
  #bytes;
  #inputs = new Map();

  constructor(kernels) {
    this.#kernels = kernels;
  }

  /**
   * Takes over a program, whose shaders are compiled; textures of the same format and size are used again.
   * @param program what the planner answered
   * @param bytes the bytes beside it
   * @param compiled what {@link Kernels.prepare} found
   */
  build(program, bytes, compiled) {
    const { device } = this.#kernels;
    const old = this.#textures.filter((texture) => !isBound(texture));
    this.#textures = program.textures.map((texture) => ({ ...texture, ...this.#place(texture, old) }));
    old.forEach(({ texture }) => texture.destroy());
    const alignment = device.limits.minUniformBufferOffsetAlignment;
    let end = 0;
    const place = (block) => {
      if (block === null) {
        return null;
      }
      const [from, length] = block;
      const placed = { from, length, at: end, bound: Math.ceil(length / 16) * 16 };
      end += Math.ceil(placed.bound / alignment) * alignment;
      return placed;
    };
    this.#dispatches = program.dispatches.map((dispatch) => ({
      ...dispatch,
      kernel: compiled.get(dispatch.shader),
      grid: place(dispatch.grid),
      params: place(dispatch.params),
      group: null,
    }));
    this.#uniforms?.destroy();
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    this.#uniforms = device.createBuffer({ label: "uniforms of a plan", size: end, usage });
    this.#bytes = new Uint8Array(end);
    this.#inputs.clear();
    this.#upload(bytes);
  }

  #place(wanted, old) {
    if (isBound(wanted)) {
      return { texture: null, view: null };
    }
    const [width, height] = size(wanted);
    const isLike = ({ texture, format, role }) =>
      format === wanted.format && role === wanted.role && texture.width === width && texture.height === height;
    const found = old.findIndex(isLike);
    if (found >= 0) {
      const [{ texture, view }] = old.splice(found, 1);
      return { texture, view };
    }
    const texture = this.#kernels.device.createTexture({
      label: wanted.name ?? "transient",
      size: [width, height],
      format: wanted.format,
      usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.STORAGE_BINDING | GPUTextureUsage.COPY_SRC,
    });
    return { texture, view: texture.createView() };
  }

  /** Takes over the uniform bytes of a program that is otherwise the same. */
  repack(program, bytes) {
    this.#dispatches.forEach((dispatch, index) => {
      const { grid, params } = program.dispatches[index];
      [dispatch.grid.from] = grid;
      if (params !== null) {
        [dispatch.params.from] = params;
      }
    });
    this.#upload(bytes);
  }

  #upload(bytes) {
    for (const { grid, params } of this.#dispatches) {
      for (const block of params === null ? [grid] : [grid, params]) {
        this.#bytes.set(bytes.subarray(block.from, block.from + block.length), block.at);
      }
    }
    this.#kernels.device.queue.writeBuffer(this.#uniforms, 0, this.#bytes);
  }

  /**
   * Connects textures with the inputs of their names. Their first texel is the first of the input's window; those that the
   * program does not read are ignored, and the same ones again cost nothing.
   * @param {Record<string, GPUTexture>} inputs, and stages that are written
   */
  bind(inputs) {
    this.#textures.forEach((slot, index) => {
      if (!isBound(slot)) {
        return;
      }
      const given = inputs[slot.name];
      const [width, height] = size(slot);
      if (given === undefined) {
        throw new Error(`no texture is given for '${slot.name}'`);
      }
      if (given.width < width || given.height < height) {
        throw new Error(
          `the texture for '${slot.name}' has ${given.width}x${given.height} pixels, and ${width}x${height} are read`,
        );
      }
      if (this.#inputs.get(index) !== given) {
        this.#inputs.set(index, given);
        const aspect = given.format.startsWith("depth") ? "depth-only" : "all";
        slot.view = given.createView({ aspect });
        const uses = (dispatch) => dispatch.inputs.includes(index) || dispatch.outputs.includes(index);
        this.#dispatches.filter(uses).forEach((dispatch) => { dispatch.group = null; });
      }
    });
    this.#dispatches.forEach((dispatch) => { dispatch.group ??= this.#group(dispatch); });
  }

  #group({ shader, kernel, grid, params, inputs, outputs }) {
    const block = ({ at, bound }) => ({ buffer: this.#uniforms, offset: at, size: bound });
    const entries = [{ binding: 0, resource: block(grid) }];
    if (params !== null) {
      entries.push({ binding: 1, resource: block(params) });
    }
    [...inputs, ...outputs].forEach((texture, index) => {
      entries.push({ binding: 2 + index, resource: this.#textures[texture].view });
    });
    if (kernel.isFiltered) {
      entries.push({ binding: SAMPLER, resource: this.#kernels.sampler });
    }
    return this.#kernels.device.createBindGroup({ label: shader, layout: kernel.layout, entries });
  }

  /** Records all dispatches; inputs must be bound. */
  encode(encoder) {
    const pass = encoder.beginComputePass({ label: "isophote" });
    for (const { kernel, group, workgroups } of this.#dispatches) {
      pass.setPipeline(kernel.pipeline);
      pass.setBindGroup(0, group);
      pass.dispatchWorkgroups(...workgroups);
    }
    pass.end();
  }

  /** What it computes, until it is built anew. */
  get output() {
    return this.#textures.find((texture) => texture.role === "output" && !isBound(texture)).texture;
  }

  /** Textures as the planner named them. */
  get textures() {
    return this.#textures;
  }

  /** Gives all textures back. */
  destroy() {
    this.#textures.filter((texture) => !isBound(texture)).forEach(({ texture }) => texture.destroy());
    this.#uniforms?.destroy();
    this.#textures = [];
    this.#dispatches = [];
  }
}
