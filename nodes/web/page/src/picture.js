// Pictures: read from files, and small enough to be worked on.

/** Pixels of the longer side while a picture is worked on: with a graphics card, and with a driver without one. */
const [SIDE, SIDE_WITHOUT] = [2560, 640];

/** Pixels of the longer side on the processor: of what comes at once, and of what the screen shows at most. */
const [COARSE, FINE] = [400, 1280];

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

/** Pixels of the longer side that are worked on. */
function side(isophote, screen) {
  if (isophote.backend === "cpu") {
    return Math.min(FINE, Math.max(COARSE, ...screen));
  }
  return Math.min(isophote.isSoftware ? SIDE_WITHOUT : SIDE, isophote.device.limits.maxTextureDimension2D);
}

/** A picture as a subject of the stage. */
export class Picture {
  kind = "picture";
  guides = [];
  isMoving = false;
  number = 0;
  /** Pictures that the processor goes through, the smallest first. */
  steps = [];

  /** Makes one of a bitmap. */
  static async open(isophote, bitmap, name, stage) {
    const picture = new Picture();
    const worked = await shrunk(bitmap, side(isophote, stage.size));
    Object.assign(picture, { name, bitmap, worked, width: worked.width, height: worked.height });
    if (isophote.backend === "gpu") {
      picture.texture = isophote.texture(worked);
    } else {
      const coarse = await shrunk(worked, COARSE);
      picture.steps = coarse === worked ? [worked] : [coarse, worked];
    }
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
    this.texture?.destroy();
  }
}
