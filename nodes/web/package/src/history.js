// Textures of frames before the one at hand, for looks that are steady over time.
//
// The same work in Rust is `host-example/src/history.rs`.

/** True for an output that is kept for later frames. */
export const isStage = (name) => /^stage\d+$/.test(name);

/** Textures that frames in order read of those before them: stages of the look, and guides. */
export class History {
  #device;
  /** By name: a texture for the frame at hand and for each before it that is read. */
  #rings = new Map();
  /** Frames that were recorded since it was made. */
  #turn = 0;
  /** By name: how many frames before are read. */
  #images;

  /**
   * @param {GPUDevice} device
   * @param {{frames: number, images: Record<string, number>}} history what the planner says is read
   */
  constructor(device, history) {
    this.#device = device;
    this.#images = history.images;
    this.frames = history.frames;
  }

  /** Frames that are known, at most those that are read. */
  get known() {
    return Math.min(this.#turn, this.frames);
  }

  /** True where the planner says the same of another look. */
  isLike(history) {
    const images = Object.entries(history.images);
    return images.length === Object.keys(this.#images).length
      && images.every(([name, depth]) => this.#images[name] === depth);
  }

  /** Textures of the stages that a program writes, by name. */
  written(textures) {
    const stages = textures.filter(({ role, name }) => role === "output" && isStage(name));
    return Object.fromEntries(stages.map(({ name, format, window: [x0, y0, x1, y1] }) => {
      const ring = this.#ring(name, { format, width: x1 - x0, height: y1 - y0 });
      return [name, ring[this.#turn % ring.length]];
    }));
  }

  /** Textures of frames before that a program reads, by the names of its inputs. */
  read(textures) {
    const found = textures.filter(({ role, name }) => role === "input" && name.includes("@")).map(({ name }) => {
      const [base, frame] = name.split("@");
      const ring = this.#rings.get(base);
      return [name, ring?.[(this.#turn + Number(frame)) % ring.length]];
    });
    return Object.fromEntries(found.filter(([, texture]) => texture !== undefined));
  }

  /** Ends a frame: guides that later frames read are copied, for their owner draws into them anew. */
  advance(encoder, inputs) {
    for (const name of Object.keys(this.#images).filter((name) => !isStage(name))) {
      const texture = inputs[name];
      const ring = this.#ring(name, texture);
      encoder.copyTextureToTexture({ texture }, { texture: ring[this.#turn % ring.length] }, [texture.width, texture.height]);
    }
    this.#turn += 1;
  }

  #ring(name, { format, width, height }) {
    const ring = this.#rings.get(name);
    const isLike = (texture) => texture.format === format && texture.width === width && texture.height === height;
    if (ring !== undefined && isLike(ring[0])) {
      return ring;
    }
    ring?.forEach((texture) => texture.destroy());
    const usage = GPUTextureUsage.TEXTURE_BINDING
      | (isStage(name) ? GPUTextureUsage.STORAGE_BINDING : GPUTextureUsage.COPY_DST);
    const made = Array.from({ length: (this.#images[name] ?? 0) + 1 }, () =>
      this.#device.createTexture({ label: name, size: [width, height], format, usage }));
    this.#rings.set(name, made);
    return made;
  }

  destroy() {
    this.#rings.forEach((ring) => ring.forEach((texture) => texture.destroy()));
    this.#rings.clear();
  }
}
