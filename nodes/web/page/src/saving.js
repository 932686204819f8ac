// The stylized picture as a file, at full resolution.

import { download } from "./dom.js";
import { note, progress, say } from "./notes.js";

/** Bytes of textures of a tile: small ones show how far it is, and may be cancelled between. */
const MEMORY = 256 * 2 ** 20;

/** A name for a file, of what people call something. */
export function fileName(text) {
  const plain = text.normalize("NFKD").replace(/\.[a-z0-9]{1,5}$/i, "").replace(/[^\p{L}\p{N}._-]+/gu, "-").replace(/^-+|-+$/g, "");
  return plain === "" ? "isophote" : plain;
}

/** Pixels as a PNG file. */
async function png(image) {
  const canvas = new OffscreenCanvas(image.width, image.height);
  const context = canvas.getContext("2d");
  if (context === null) {
    throw new Error(`The browser has no memory for a picture of ${image.width} × ${image.height} pixels. Open a smaller one.`);
  }
  context.putImageData(image, 0, 0);
  return canvas.convertToBlob({ type: "image/png" });
}

/**
 * Computes the look on all pixels and hands out the file.
 * @returns whether it was saved and not cancelled
 */
export async function savePicture(isophote, look, subject, lookName) {
  const inputs = await subject.full();
  const { width, height } = inputs.color;
  const abort = new AbortController();
  const bar = progress(`Computing ${width} × ${height} pixels…`, () => abort.abort());
  say(`Saving ${width} by ${height} pixels`);
  try {
    const options = { memory: MEMORY, frame: subject.number, signal: abort.signal, onProgress: (share) => bar.set(share) };
    const image = await isophote.apply(look, inputs, options);
    abort.signal.throwIfAborted();
    const blob = await png(image);
    const name = `${fileName(subject.name)}-${fileName(lookName).toLowerCase()}.png`;
    download(blob, name);
    note(`Saved as ${name}, ${width} × ${height} pixels.`, { key: "saved", seconds: 6 });
    return true;
  } catch (error) {
    if (abort.signal.aborted) {
      note("Nothing was saved.", { key: "saved", seconds: 4 });
      return false;
    }
    throw error;
  } finally {
    bar.close();
    subject.doneSaving?.(inputs);
  }
}

/** Hands out the look as a preset. */
export function savePreset(look, name) {
  const text = `${JSON.stringify({ name, ...look }, null, 2)}\n`;
  const file = `${fileName(name).toLowerCase().replaceAll("-", "_")}.json`;
  download(new Blob([text], { type: "application/json" }), file);
  note(`Saved as ${file}. Drop it here to open it again; the other programs of Isophote open it, too.`, { key: "saved", seconds: 6 });
}
