// Models: drawn by three.js on the page's device, with normals and depths for the look.

import {
  AnimationMixer, FloatType, HalfFloatType, MeshBasicNodeMaterial, NearestFilter, NeutralToneMapping, PerspectiveCamera, QuadMesh,
  RedFormat, RenderTarget, Timer, UnsignedByteType, Vector3, WebGPURenderer,
} from "three/webgpu";
import { renderOutput, texture } from "three/tsl";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { NAMES, targets } from "isophote/three";
import { frame } from "./framing.js";
import { furnish } from "./light.js";
import { small } from "./picture.js";

/** Pixels of the longer side: of what is shown, at most, with a graphics card and without; of what is saved, at least. */
const [SHOWN, SHOWN_WITHOUT, SAVED] = [2560, 720, 2560];

/** Samples for each pixel of the colour; guides have one, since depths of different things have no mean. */
const SAMPLES = 4;

/** What the numbers of frames are counted by, in which marks last and values are given. */
const FRAMES_PER_SECOND = 24;

/** One renderer for each device. */
const renderers = new WeakMap();

async function rendererOf(isophote) {
  if (!renderers.has(isophote.device)) {
    const renderer = new WebGPURenderer({ device: isophote.device, antialias: false, canvas: new OffscreenCanvas(1, 1) });
    renderer.toneMapping = NeutralToneMapping;
    renderer.shadowMap.enabled = true;
    renderer.onDeviceLost = () => {};
    renderers.set(isophote.device, renderer.init().then(() => renderer));
  }
  return renderers.get(isophote.device);
}

/** Textures of one size that a scene is drawn to. */
class Targets {
  constructor(renderer, width, height, isSoftware) {
    this.renderer = renderer;
    this.guides = new RenderTarget(width, height, { count: 3, type: HalfFloatType, minFilter: NearestFilter, magFilter: NearestFilter });
    const [color, normal, depth] = this.guides.textures;
    [color.name, normal.name, depth.name] = ["output", NAMES.normal, NAMES.depth];
    [depth.format, depth.type] = [RedFormat, FloatType];
    // A device without hardware has no time for two passes.
    this.beauty = isSoftware ? null : new RenderTarget(width, height, { type: HalfFloatType, samples: SAMPLES });
    this.encoded = new RenderTarget(width, height, { type: UnsignedByteType, depthBuffer: false });
    const material = new MeshBasicNodeMaterial({ depthTest: false, depthWrite: false });
    material.fragmentNode = renderOutput(texture((this.beauty ?? this.guides).texture));
    this.quad = new QuadMesh(material);
    this.mrt = targets(["normal", "depth"]);
  }

  get width() {
    return this.guides.width;
  }

  /** Draws the scene, and says where it is. */
  draw(scene, camera) {
    const { renderer } = this;
    const native = (found) => renderer.backend.get(found).texture;
    renderer.setMRT(this.mrt);
    renderer.setRenderTarget(this.guides);
    renderer.render(scene, camera);
    renderer.setMRT(null);
    if (this.beauty !== null) {
      renderer.setRenderTarget(this.beauty);
      renderer.render(scene, camera);
    }
    renderer.setRenderTarget(this.encoded);
    this.quad.render(renderer);
    renderer.setRenderTarget(null);
    const [, normal, depth] = this.guides.textures;
    return { color: native(this.encoded.texture), normal: native(normal), depth: native(depth) };
  }

  dispose() {
    this.guides.dispose();
    this.beauty?.dispose();
    this.encoded.dispose();
    this.quad.material.dispose();
  }
}

/** A model as a subject of the stage. */
export class Model {
  kind = "model";
  guides = ["normal", "depth"];
  isPlaying = false;
  #targets = null;
  #timer = new Timer();
  #extra = [];

  /**
   * Makes one.
   * @param {{root: Object3D, clips: AnimationClip[]}} content what is shown
   * @param stage whose canvas it is turned on
   */
  static async open(isophote, { root, clips, name, faces }, stage) {
    if (isophote.backend === "cpu") {
      throw new Error("Models are drawn by a graphics card that the browser may use, and there is none. Pictures are stylized without one.");
    }
    const model = new Model();
    const renderer = await rendererOf(isophote);
    Object.assign(model, { isophote, renderer, root, clips, name, faces, stage });
    model.scene = furnish(renderer, root);
    model.camera = new PerspectiveCamera(35, 1, 0.01, 100);
    model.controls = new OrbitControls(model.camera, stage.canvas);
    model.controls.addEventListener("change", () => stage.renew());
    model.fill(...stage.size);
    model.frame();
    model.#animate(0);
    return model;
  }

  get info() {
    return `${this.name}, ${this.faces.toLocaleString("en")} triangles`;
  }

  /** The number of the frame that is shown, as films count them. */
  get number() {
    return Math.floor((this.mixer?.time ?? 0) * FRAMES_PER_SECOND);
  }

  /** Whether it looks different in the next frame. */
  get isMoving() {
    return this.isPlaying;
  }

  /** Plays an animation, or the one that plays. */
  play(isPlaying, clip) {
    this.isPlaying = isPlaying && this.clips.length > 0;
    this.#timer.update();
    if (clip !== undefined) {
      this.#animate(clip);
    }
    this.stage.renew();
  }

  #animate(index) {
    const clip = this.clips[index];
    this.mixer?.stopAllAction();
    if (clip !== undefined) {
      this.mixer ??= new AnimationMixer(this.root);
      this.mixer.clipAction(clip).play();
      this.mixer.update(0);
    }
  }

  /** Takes the size of the canvas, and says whether that is another. */
  fill(width, height) {
    const factor = Math.min(1, (this.isophote.isSoftware ? SHOWN_WITHOUT : SHOWN) / Math.max(width, height));
    const [across, down] = [width, height].map((side) => Math.max(8, Math.round(side * factor)));
    if (across === this.width && down === this.height) {
      return false;
    }
    [this.width, this.height] = [across, down];
    this.camera.aspect = across / down;
    this.camera.updateProjectionMatrix();
    return true;
  }

  /** Shows all of it, from where it was first seen. */
  frame() {
    const { target, size, far } = frame(this.root, this.camera);
    this.controls.target.copy(target);
    Object.assign(this.controls, { minDistance: size * 0.1, maxDistance: far * 6 });
    this.controls.update();
  }

  /** Goes nearer or farther. */
  zoom(factor) {
    const { target } = this.controls;
    this.camera.position.sub(target).divideScalar(factor).add(target);
    this.controls.update();
    this.stage.renew();
  }

  /** Turns it by so many degrees, for keys. */
  turn(across, up) {
    const { position } = this.camera;
    const { target } = this.controls;
    const offset = position.clone().sub(target);
    offset.applyAxisAngle(new Vector3(0, 1, 0), (across * Math.PI) / 180);
    const side = new Vector3(0, 1, 0).cross(offset).normalize();
    offset.applyAxisAngle(side, (up * Math.PI) / 180);
    position.copy(target).add(offset);
    this.controls.update();
    this.stage.renew();
  }

  inputs() {
    if (this.isPlaying) {
      this.#timer.update();
      this.mixer.update(Math.min(this.#timer.getDelta(), 0.1));
    }
    if (this.#targets?.width !== this.width || this.#targets.guides.height !== this.height) {
      this.#targets?.dispose();
      this.#targets = new Targets(this.renderer, this.width, this.height, this.isophote.isSoftware);
    }
    return this.#targets.draw(this.scene, this.camera);
  }

  /** Draws it in another size. */
  #at(side) {
    const factor = side / Math.max(this.width, this.height);
    const [width, height] = [this.width, this.height].map((length) => Math.max(8, Math.round(length * factor)));
    const made = new Targets(this.renderer, width, height, this.isophote.isSoftware);
    this.#extra.push(made);
    return { made, inputs: made.draw(this.scene, this.camera) };
  }

  /** What thumbnails are made of; it lasts until the model is closed. */
  async thumbnail() {
    return this.#at(small(this.isophote)).inputs;
  }

  /** What is saved. */
  async full() {
    const { made, inputs } = this.#at(Math.max(SAVED, this.width, this.height));
    this.doneSaving = () => {
      this.#extra.splice(this.#extra.indexOf(made), 1);
      made.dispose();
    };
    return inputs;
  }

  close() {
    this.isPlaying = false;
    this.controls.dispose();
    this.#targets?.dispose();
    this.#extra.forEach((made) => made.dispose());
    this.scene.traverse((part) => {
      part.geometry?.dispose();
      for (const material of [part.material ?? []].flat()) {
        Object.values(material).forEach((value) => value?.isTexture && value.dispose());
        material.dispose();
      }
    });
  }
}
