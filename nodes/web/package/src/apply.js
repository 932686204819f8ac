// A look on one picture of any size, in tiles where the device has too little memory for the whole.

import { Program, memory, size } from "./program.js";

/** Bytes that the textures of a tile may take. */
const MEMORY = 512 * 2 ** 20;

/** Tiles are not cut below so many pixels a side: what they read around themselves would cost more than they. */
const LEAST = 256;

/**
 * The look on a picture, as pixels.
 * @returns {Promise<ImageData>}
 */
export async function apply(isophote, look, picture, sources, { memory: most = MEMORY, onProgress, signal } = {}) {
  const { planner, kernels, device } = isophote;
  const { json: first } = planner.ask({ ask: "plan", look, picture });
  const { plan } = first;
  const program = new Program(kernels);
  const owned = [];
  try {
    const shader = (dispatch) => planner.ask({ ask: "shader", plan, dispatch }).json;
    const image = new ImageData(picture.width, picture.height);
    const tiles = cut(planner, plan, first, picture, most, device.limits.maxTextureDimension2D);
    for (const [index, region] of tiles.entries()) {
      signal?.throwIfAborted();
      const { json, bytes } = planner.ask({ ask: "region", plan, region });
      const compiled = await kernels.prepare(json.dispatches, shader);
      await isophote.checked(() => {
        program.build(json, bytes, compiled);
        owned.splice(0).forEach((texture) => texture.destroy());
        program.bind(inputs(device, json, sources, owned));
      });
      await put(isophote, program, region, image);
      onProgress?.((index + 1) / tiles.length);
    }
    return image;
  } finally {
    owned.forEach((texture) => texture.destroy());
    program.destroy();
    planner.ask({ ask: "release", plan });
  }
}

/** Regions that together are the picture, each of which takes no more than so much memory. */
function cut(planner, plan, whole, { width, height }, most, side) {
  const fits = ({ textures }) => textures.every((texture) => Math.max(...size(texture)) <= side);
  let [columns, rows] = [1, 1];
  let program = whole;
  while (memory(program) > most || !fits(program)) {
    const [tileWidth, tileHeight] = [Math.ceil(width / columns), Math.ceil(height / rows)];
    if (Math.max(tileWidth, tileHeight) <= LEAST) {
      break;
    }
    if (tileWidth >= tileHeight) {
      columns *= 2;
    } else {
      rows *= 2;
    }
    // One in the middle reads most around itself.
    const region = tile(width, height, columns, rows, columns >> 1, rows >> 1);
    program = planner.ask({ ask: "region", plan, region }).json;
  }
  if (!fits(program)) {
    throw new Error(`the device has textures of at most ${side} pixels a side, and the look reads more of the picture at once`);
  }
  const all = [];
  for (let row = 0; row < rows; row += 1) {
    for (let column = 0; column < columns; column += 1) {
      all.push(tile(width, height, columns, rows, column, row));
    }
  }
  return all;
}

function tile(width, height, columns, rows, column, row) {
  const edge = (length, parts, part) => Math.floor((length * part) / parts);
  return [
    edge(width, columns, column),
    edge(height, rows, row),
    edge(width, columns, column + 1),
    edge(height, rows, row + 1),
  ];
}

/** The windows of the inputs as textures. */
function inputs(device, program, sources, owned) {
  const found = {};
  for (const texture of program.textures.filter(({ role }) => role === "input")) {
    const source = sources[texture.name];
    const [x, y] = texture.window;
    const made = device.createTexture({
      label: texture.name,
      size: size(texture),
      format: source instanceof GPUTexture ? source.format : "rgba8unorm",
      usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST | GPUTextureUsage.RENDER_ATTACHMENT,
    });
    owned.push(made);
    if (source instanceof GPUTexture) {
      const encoder = device.createCommandEncoder();
      encoder.copyTextureToTexture({ texture: source, origin: [x, y] }, { texture: made }, size(texture));
      device.queue.submit([encoder.finish()]);
    } else {
      // Only colours are multiplied by their alpha.
      const target = { texture: made, premultipliedAlpha: texture.name === "color" };
      device.queue.copyExternalImageToTexture({ source, origin: [x, y] }, target, size(texture));
    }
    found[texture.name] = made;
  }
  return found;
}

/** Runs a program and puts what it computes into the picture. */
async function put(isophote, program, [x0, y0, x1, y1], image) {
  const { device, painter } = isophote;
  const [width, height] = [x1 - x0, y1 - y0];
  const bytesPerRow = Math.ceil((width * 4) / 256) * 256;
  const bytes = device.createTexture({
    size: [width, height],
    format: "rgba8unorm",
    usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC,
  });
  const buffer = device.createBuffer({
    size: bytesPerRow * height,
    usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ,
  });
  try {
    await isophote.checked(() => {
      const encoder = device.createCommandEncoder();
      program.encode(encoder);
      painter.paint(encoder, program.output, bytes, { straight: true });
      encoder.copyTextureToBuffer({ texture: bytes }, { buffer, bytesPerRow }, [width, height]);
      device.queue.submit([encoder.finish()]);
    });
    await buffer.mapAsync(GPUMapMode.READ);
    const rows = new Uint8Array(buffer.getMappedRange());
    for (let y = 0; y < height; y += 1) {
      const row = rows.subarray(y * bytesPerRow, y * bytesPerRow + width * 4);
      image.data.set(row, ((y0 + y) * image.width + x0) * 4);
    }
  } finally {
    buffer.destroy();
    bytes.destroy();
  }
}
