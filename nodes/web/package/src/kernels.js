// Compiled shaders of one device, each compiled when a plan first names it.

/** Where shaders that interpolate by a sampler have it. */
export const SAMPLER = 15;

export class Kernels {
  #pipelines = new Map();
  #sharesWindows;
  #sampler;

  /**
   * @param {GPUDevice} device
   * @param {boolean} isSoftware whether the device computes on the CPU, where workgroup memory costs time instead of saving it
   */
  constructor(device, isSoftware) {
    this.device = device;
    this.#sharesWindows = !isSoftware;
  }

  get sampler() {
    this.#sampler ??= this.device.createSampler({ magFilter: "linear", minFilter: "linear" });
    return this.#sampler;
  }

  /** Compiles what is not compiled yet, all at once; `shader(i)` is asked for the shader of dispatch `i`. */
  async prepare(dispatches, shader) {
    await Promise.all(dispatches.map(({ shader: name }, index) => {
      if (!this.#pipelines.has(name)) {
        this.#pipelines.set(name, this.#compile(shader(index)));
      }
      return this.#pipelines.get(name);
    }));
    const found = new Map();
    for (const { shader: name } of dispatches) {
      found.set(name, await this.#pipelines.get(name));
    }
    return found;
  }

  async #compile(shader) {
    const layout = this.device.createBindGroupLayout({ label: shader.name, entries: entries(shader) });
    const module = this.device.createShaderModule({ label: shader.name, code: shader.code });
    // Kernels without windows do not declare the constant.
    const hasWindows = /\boverride shared_windows\b/.test(shader.code);
    const constants = hasWindows ? { shared_windows: this.#sharesWindows ? 1 : 0 } : {};
    try {
      const pipeline = await this.device.createComputePipelineAsync({
        label: shader.name,
        layout: this.device.createPipelineLayout({ bindGroupLayouts: [layout] }),
        compute: { module, entryPoint: "main", constants },
      });
      return { layout, pipeline, hasParams: shader.hasParams, isFiltered: shader.filtered.length > 0 };
    } catch (error) {
      this.#pipelines.delete(shader.name);
      throw new Error(`the device does not compile kernel '${shader.name}': ${error.message}`, { cause: error });
    }
  }
}

/** Everything is in group 0: the grid, the parameters, what is read, what is written, and the sampler. */
function entries(shader) {
  const visibility = GPUShaderStage.COMPUTE;
  const found = [{ binding: 0, visibility, buffer: {} }];
  if (shader.hasParams) {
    found.push({ binding: 1, visibility, buffer: {} });
  }
  for (let input = 0; input < shader.inputs; input += 1) {
    const sampleType = shader.filtered.includes(input) ? "float" : "unfilterable-float";
    found.push({ binding: 2 + input, visibility, texture: { sampleType } });
  }
  shader.outputs.forEach((format, output) => {
    const binding = 2 + shader.inputs + output;
    found.push({ binding, visibility, storageTexture: { access: "write-only", format } });
  });
  if (shader.filtered.length > 0) {
    found.push({ binding: SAMPLER, visibility, sampler: {} });
  }
  return found;
}
