// A look on one picture of any size, computed on the processor in parts.

/** Bytes that a part may take. Browsers give a module four gigabytes at most, and phones less. */
const MEMORY = 512 * 2 ** 20;

/**
 * The look on a picture, as pixels.
 * @returns {Promise<ImageData>}
 */
export async function applyOnCpu(isophote, look, given, sources, { memory = MEMORY, onProgress, signal } = {}) {
  const { planner, processor } = isophote;
  // Canvases give straight pixels, and take them. Numbers are as exact as they come.
  const picture = { ...given, alpha: "straight", precision: "exact" };
  const { parts } = planner.ask({ ask: "parts", look, picture, memory }).json;
  const canvases = Object.fromEntries(Object.entries(sources).map(([name, source]) => [name, drawn(source)]));
  const image = new ImageData(picture.width, picture.height);
  let [isEnded, done] = [false, 0];
  const isOver = () => isEnded || (signal?.aborted ?? false);
  const part = async ({ region, inputs }) => {
    const request = { ask: "compute", look, picture, region, inputs };
    // In the order of their names, as the module reads them.
    const pixels = () => joined(Object.keys(inputs).sort().map((name) => cut(canvases[name], inputs[name])));
    const { json, bytes } = await processor.compute(request, pixels, isOver);
    put(image, region, json, bytes);
    done += 1;
    onProgress?.(done / parts.length);
  };
  try {
    signal?.throwIfAborted();
    await Promise.all(parts.map(part));
    return image;
  } catch (error) {
    signal?.throwIfAborted();
    throw error;
  } finally {
    isEnded = true;
  }
}

/** A picture where its pixels can be read. */
function drawn(source) {
  const width = source.videoWidth ?? source.naturalWidth ?? source.displayWidth ?? source.width;
  const height = source.videoHeight ?? source.naturalHeight ?? source.displayHeight ?? source.height;
  const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  if (context === null) {
    throw new Error(`the browser has no memory for a picture of ${width} × ${height} pixels`);
  }
  if (source instanceof ImageData) {
    context.putImageData(source, 0, 0);
  } else {
    context.drawImage(source, 0, 0, width, height);
  }
  return context;
}

function cut(context, [x0, y0, x1, y1]) {
  return context.getImageData(x0, y0, x1 - x0, y1 - y0).data;
}

function joined(pieces) {
  if (pieces.length === 1) {
    return new Uint8Array(pieces[0].buffer);
  }
  const all = new Uint8Array(pieces.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const piece of pieces) {
    all.set(piece, at);
    at += piece.length;
  }
  return all;
}

/** Puts what was computed where it stands in the picture. */
function put(image, [x0, y0], { width, height }, bytes) {
  for (let y = 0; y < height; y += 1) {
    image.data.set(bytes.subarray(y * width * 4, (y + 1) * width * 4), ((y0 + y) * image.width + x0) * 4);
  }
}
