// Which part of the picture the stage shows.

/** Canvas pixels for one pixel of the picture, at most and at least. */
const [LEAST, MOST] = [0.02, 16];

export class Viewport {
  /** Pixels of the canvas. */
  canvas = [1, 1];
  /** Pixels of the picture. */
  picture = [1, 1];
  /** Point of the picture in the middle of the canvas, in its pixels. */
  middle = [0.5, 0.5];
  /** Canvas pixels for one of the picture. */
  zoom = 1;
  /** Whether all of the picture is shown, however the canvas changes. */
  isFit = true;

  /** Takes over the size of the canvas or of the picture. */
  resize(canvas, picture) {
    if (picture[0] !== this.picture[0] || picture[1] !== this.picture[1]) {
      this.isFit = true;
    }
    [this.canvas, this.picture] = [canvas, picture];
    if (this.isFit) {
      this.fit();
    } else {
      this.#clamp();
    }
  }

  /** Shows all of it; small pictures are not enlarged more than four times. */
  fit() {
    const [cw, ch] = this.canvas;
    const [pw, ph] = this.picture;
    this.zoom = Math.min(cw / pw, ch / ph, 4);
    this.middle = [pw / 2, ph / 2];
    this.isFit = true;
  }

  /** Zooms so that the point under a place of the canvas stays there. */
  zoomAt(factor, [x, y] = [this.canvas[0] / 2, this.canvas[1] / 2]) {
    const before = this.toPicture([x, y]);
    this.zoom = Math.min(Math.max(this.zoom * factor, LEAST), MOST);
    const after = this.toPicture([x, y]);
    this.middle = this.middle.map((at, axis) => at + before[axis] - after[axis]);
    this.isFit = false;
    this.#clamp();
  }

  /** Moves the picture by so many pixels of the canvas. */
  pan(dx, dy) {
    this.middle = [this.middle[0] - dx / this.zoom, this.middle[1] - dy / this.zoom];
    this.isFit = false;
    this.#clamp();
  }

  /** The point of the picture at a place of the canvas, in pixels. */
  toPicture([x, y]) {
    return [
      (x - this.canvas[0] / 2) / this.zoom + this.middle[0],
      (y - this.canvas[1] / 2) / this.zoom + this.middle[1],
    ];
  }

  /** The place on the canvas of a point of the picture. */
  toCanvas([x, y]) {
    return [
      (x - this.middle[0]) * this.zoom + this.canvas[0] / 2,
      (y - this.middle[1]) * this.zoom + this.canvas[1] / 2,
    ];
  }

  /** What the painter is told. */
  get part() {
    const scale = [0, 1].map((axis) => this.canvas[axis] / (this.zoom * this.picture[axis]));
    const offset = [0, 1].map((axis) => this.middle[axis] / this.picture[axis] - scale[axis] / 2);
    return { scale, offset };
  }

  /** Keeps the picture in view: its middle when all of it fits, its edges otherwise. */
  #clamp() {
    this.middle = this.middle.map((at, axis) => {
      const half = this.canvas[axis] / this.zoom / 2;
      const size = this.picture[axis];
      return half * 2 >= size ? size / 2 : Math.min(Math.max(at, half), size - half);
    });
  }
}
