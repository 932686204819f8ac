// Pictures: read from files, and small enough to be worked on.

/** Pixels of the longer side while a picture is worked on: with a graphics card, and without one. */
const [SIDE, SIDE_WITHOUT] = [2560, 640];

/** Pixels of the longer side of thumbnails. */
export const small = (isophote) => (isophote.isSoftware ? 192 : 320);

/**
 * Reads a picture.
 * @param {Blob} blob
 * @param {string} name what people call it
 * @throws {Error} a sentence that says what helps
 */
export async function readPicture(blob, name) {
  try {
    return await createImageBitmap(blob, { imageOrientation: "from-image" });
  } catch {
    throw new Error(`${name} is no picture that this browser can read. Open a PNG, JPEG, WebP, AVIF or GIF, or a glTF model.`);
  }
}

/** A bitmap whose longer side has at most so many pixels. */
async function shrunk(bitmap, side) {
  const factor = side / Math.max(bitmap.width, bitmap.height);
  if (factor >= 1) {
    return bitmap;
  }
  const resizeWidth = Math.max(1, Math.round(bitmap.width * factor));
  const resizeHeight = Math.max(1, Math.round(bitmap.height * factor));
  return createImageBitmap(bitmap, { resizeWidth, resizeHeight, resizeQuality: "high" });
}

/** A picture as a subject of the stage. */
export class Picture {
  kind = "picture";
  guides = [];
  isMoving = false;
  number = 0;

  /** Makes one of a bitmap. */
  static async open(isophote, bitmap, name) {
    const picture = new Picture();
    const limit = Math.min(isophote.isSoftware ? SIDE_WITHOUT : SIDE, isophote.device.limits.maxTextureDimension2D);
    const worked = await shrunk(bitmap, limit);
    Object.assign(picture, { name, bitmap, width: worked.width, height: worked.height });
    picture.texture = isophote.texture(worked);
    picture.small = await shrunk(worked, small(isophote));
    return picture;
  }

  /** What it says of itself. */
  get info() {
    return `${this.name}, ${this.bitmap.width} × ${this.bitmap.height}`;
  }

  inputs() {
    return { color: this.texture };
  }

  /** What thumbnails are made of. */
  async thumbnail() {
    return { color: this.small };
  }

  /** What is saved. */
  async full() {
    return { color: this.bitmap };
  }

  /** Gives the textures back; the bitmap stays with who opened it. */
  close() {
    this.texture.destroy();
  }
}
