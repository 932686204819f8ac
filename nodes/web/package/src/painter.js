// Textures of floats on canvases: a triangle that covers the target, and two pictures with an edge between them.

const CODE = `
struct Frame {
  scale: vec2f,
  offset: vec2f,
  // Where the second picture begins, from 0 to 1.
  edge: f32,
  straight: u32,
}
@group(0) @binding(0) var first: texture_2d<f32>;
@group(0) @binding(1) var second: texture_2d<f32>;
@group(0) @binding(2) var<uniform> frame: Frame;

struct Corner {
  @builtin(position) position: vec4f,
  @location(0) place: vec2f,
}

@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
  let place = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
  return Corner(vec4f(place * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0), 0.0, 1.0), place);
}

fn between(picture: texture_2d<f32>, place: vec2f) -> vec4f {
  let size = vec2f(textureDimensions(picture));
  // Between texels only where the picture is not shown pixel by pixel.
  let p = place * size - 0.5;
  let base = floor(p);
  let t = p - base;
  let last = vec2i(size) - 1;
  let at = vec2i(base);
  let a = textureLoad(picture, clamp(at, vec2i(0), last), 0);
  let b = textureLoad(picture, clamp(at + vec2i(1, 0), vec2i(0), last), 0);
  let c = textureLoad(picture, clamp(at + vec2i(0, 1), vec2i(0), last), 0);
  let d = textureLoad(picture, clamp(at + vec2i(1, 1), vec2i(0), last), 0);
  return mix(mix(a, b, t.x), mix(c, d, t.x), t.y);
}

// The mean over a pixel of the target, whose sides are span: thin lines would break where pictures are shown smaller.
fn pixel(picture: texture_2d<f32>, place: vec2f, span: vec2f) -> vec4f {
  let texels = span * vec2f(textureDimensions(picture));
  // Each tap is a mean of four texels itself.
  let taps = clamp(vec2i(ceil(texels * 0.75)), vec2i(1), vec2i(6));
  var sum = vec4f(0.0);
  for (var y = 0; y < taps.y; y++) {
    for (var x = 0; x < taps.x; x++) {
      let part = (vec2f(vec2i(x, y)) + 0.5) / vec2f(taps) - 0.5;
      sum += between(picture, place + part * span);
    }
  }
  return sum / f32(taps.x * taps.y);
}

@fragment
fn shade(corner: Corner) -> @location(0) vec4f {
  let place = corner.place * frame.scale + frame.offset;
  let span = abs(vec2f(dpdx(corner.place.x), dpdy(corner.place.y)) * frame.scale);
  if any(place < vec2f(0.0)) || any(place > vec2f(1.0)) {
    return vec4f(0.0);
  }
  var color = pixel(first, place, span);
  if place.x >= frame.edge {
    color = pixel(second, place, span);
  }
  color = clamp(color, vec4f(0.0), vec4f(1.0));
  if frame.straight == 1u && color.a > 0.0 {
    color = vec4f(clamp(color.rgb / color.a, vec3f(0.0), vec3f(1.0)), color.a);
  }
  return color;
}
`;

/** Pictures that one submission may draw, and the distance of their uniform blocks. */
const [SLOTS, STRIDE] = [64, 256];

/** Draws what stylizers compute. */
export class Painter {
  #device;
  #pipelines = new Map();
  #module;
  #layout;
  /** Uniform blocks, which take turns. */
  #blocks;
  #turn = 0;

  constructor(device) {
    this.#device = device;
  }

  #pipeline(format) {
    this.#module ??= this.#device.createShaderModule({ label: "painter", code: CODE });
    this.#layout ??= this.#device.createBindGroupLayout({
      label: "painter",
      entries: [
        { binding: 0, visibility: GPUShaderStage.FRAGMENT, texture: { sampleType: "unfilterable-float" } },
        { binding: 1, visibility: GPUShaderStage.FRAGMENT, texture: { sampleType: "unfilterable-float" } },
        { binding: 2, visibility: GPUShaderStage.FRAGMENT, buffer: { hasDynamicOffset: true, minBindingSize: 32 } },
      ],
    });
    if (!this.#pipelines.has(format)) {
      this.#pipelines.set(format, this.#device.createRenderPipeline({
        label: "painter",
        layout: this.#device.createPipelineLayout({ bindGroupLayouts: [this.#layout] }),
        vertex: { module: this.#module },
        fragment: { module: this.#module, targets: [{ format }] },
      }));
    }
    return this.#pipelines.get(format);
  }

  /**
   * Records a picture that fills a texture; a submission may have 64 of them.
   * @param {GPUCommandEncoder} encoder
   * @param {GPUTexture} picture gamma-encoded and premultiplied, as stylizers of space `srgb` compute it
   * @param {GPUTexture} target such as `context.getCurrentTexture()`
   * @param options `beside`: another picture, shown left of `edge` (0 to 1); `scale` and `offset`: the part that is shown, in
   *   sizes of the picture; `straight`: whether the target's colour is not premultiplied
   */
  paint(encoder, picture, target, options = {}) {
    const { beside = picture, edge = 0, scale = [1, 1], offset = [0, 0], straight = false } = options;
    const pipeline = this.#pipeline(target.format);
    const frame = new ArrayBuffer(32);
    new Float32Array(frame).set([...scale, ...offset, edge]);
    new Uint32Array(frame)[5] = straight ? 1 : 0;
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    this.#blocks ??= this.#device.createBuffer({ label: "painter", size: SLOTS * STRIDE, usage });
    this.#turn = (this.#turn + 1) % SLOTS;
    const at = this.#turn * STRIDE;
    this.#device.queue.writeBuffer(this.#blocks, at, frame);
    const group = this.#device.createBindGroup({
      layout: this.#layout,
      entries: [
        { binding: 0, resource: beside.createView() },
        { binding: 1, resource: picture.createView() },
        { binding: 2, resource: { buffer: this.#blocks, size: 32 } },
      ],
    });
    const pass = encoder.beginRenderPass({
      label: "painter",
      colorAttachments: [{ view: target.createView(), loadOp: "clear", storeOp: "store", clearValue: [0, 0, 0, 0] }],
    });
    pass.setPipeline(pipeline);
    pass.setBindGroup(0, group, [at]);
    pass.draw(3);
    pass.end();
  }
}
