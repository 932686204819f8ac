// three.js: a look on what a pass of WebGPURenderer draws, every frame, with its normals and depths.
//
//   await renderer.init();
//   const isophote = await Isophote.create({ device: renderer.backend.device });
//   const scenePass = pass(scene, camera);
//   const pipeline = new RenderPipeline(renderer);
//   pipeline.outputNode = stylize(isophote, { style: "cartoon" }, scenePass);
//   pipeline.outputColorTransform = false;
//
// Nothing is copied: the look reads the textures of the pass, and writes the texture that the node shows.

import { ExternalTexture, FloatType, Node, RedFormat, RTTNode } from "three/webgpu";
import {
  cameraFar, convertToTexture, Fn, mrt, normalView, output, positionView, reference, renderOutput, screenSize, texture, uv, vec2, vec4, velocity,
} from "three/tsl";

/** What the textures of a pass are called that hold guides. */
export const NAMES = { normal: "isophoteNormal", depth: "isophoteDepth", motion: "isophoteMotion" };

/** Steps of the coarse part of a depth, as many as a 16-bit float tells apart. */
const STEPS = 2048;

/** Only things have normals and depths; the sky has none. */
const ofThings = (value) => Fn((builder) => (builder.object?.name === "Background.mesh" ? vec4(0) : value))();

/** Samples are averaged by the device in 16 bits at most: a coarse and a fine part of a share of the camera's far distance have 22. */
const splitDepth = Fn(() => {
  const share = positionView.z.negate().div(cameraFar).clamp(0, 1).mul(STEPS).toVar();
  const coarse = share.floor();
  return vec4(coarse.div(STEPS), share.sub(coarse), 0, 1);
});

const VALUES = {
  normal: () => ofThings(vec4(normalView, 1)),
  depth: () => ofThings(vec4(positionView.z.negate(), 0, 0, 1)),
  // From where points were, in halves of the picture and upwards, to where they are; looks ask for the way back, in pixels.
  motion: () => vec4(velocity.mul(vec2(-0.5, 0.5)).mul(screenSize), 0, 1),
};

/** Distances again, from what {@link splitDepth} has drawn with a camera. */
function distances(node, camera) {
  const far = reference("far", "float", camera);
  const distance = node.x.add(node.y.div(STEPS)).mul(far);
  return new RTTNode(vec4(distance, 0, 0, 1), null, null, { type: FloatType, format: RedFormat, depthBuffer: false });
}

/**
 * What a renderer is told to draw beside colours: `pass.setMRT(targets(guides))`, or `renderer.setMRT(…)` for a target whose
 * textures have the names in {@link NAMES}. Distances are those of the scene: their texture must hold them, in 32 bits if it can.
 */
export function targets(guides = ["normal", "depth"]) {
  return drawn(guides, VALUES);
}

function drawn(guides, values) {
  const unknown = guides.find((guide) => NAMES[guide] === undefined);
  if (unknown !== undefined) {
    throw new Error(`'${unknown}' is no guide that a pass of three.js draws; it draws ${Object.keys(NAMES).join(" and ")}`);
  }
  const outputs = { output };
  for (const guide of guides) {
    outputs[NAMES[guide]] = values[guide]();
  }
  const made = mrt(outputs);
  guides.forEach((guide) => made.setClearColor(NAMES[guide], 0, 0));
  return made;
}

/**
 * A look on what a pass draws, as a node that gives gamma-encoded colours.
 * @param {Isophote} isophote on the device of the renderer
 * @param look a preset or a graph
 * @param scenePass what `pass(scene, camera)` of `three/tsl` makes
 * @param options `guides`: which of `normal`, `depth` and `motion` the look is given, the first two without; with `motion`, looks with
 *   `steadiness` are steady over time; `precision`: `fast` without
 * @returns {StylizeNode} the last node of a pipeline, whose `outputColorTransform` is false
 */
export function stylize(isophote, look, scenePass, { guides = ["normal", "depth"], ...options } = {}) {
  // What the application draws besides stays.
  const own = scenePass.getMRT();
  const added = drawn(guides, { ...VALUES, depth: () => ofThings(splitDepth()) });
  scenePass.setMRT(own === null ? added : added.merge(own));
  const nodes = {};
  for (const guide of guides) {
    const node = scenePass.getTextureNode(NAMES[guide]);
    nodes[guide] = guide === "depth" ? distances(node, scenePass.camera) : node;
  }
  // The look sees what is shown: tone-mapped and gamma-encoded.
  const color = convertToTexture(renderOutput(scenePass.getTextureNode()));
  return new StylizeNode(isophote, look, { color, ...nodes }, { scenePass, ...options });
}

/** A look on textures of nodes. While its shaders compile it shows the plain colour. */
export class StylizeNode extends Node {
  static get type() {
    return "StylizeNode";
  }

  #isophote;
  #look;
  #graph;
  #inputs;
  #options;
  #stylizer = null;
  #making = null;
  #failure = null;
  #told;
  /** What is shown: the plain colour, or a texture of ours. */
  #shown;
  #node;
  #frame = 0;

  constructor(isophote, look, inputs, options) {
    super("vec4");
    this.#isophote = isophote;
    this.#look = look;
    this.#graph = isophote.graph(look);
    this.#inputs = inputs;
    this.#options = options;
    /** Resolves when the look is shown for the first time; rejects with what keeps it from being so. */
    this.ready = new Promise((resolve, reject) => { this.#told = { resolve, reject }; });
    // Who does not wait reads it on the console.
    this.ready.catch(() => {});
    // Once for each frame, after the passes that it reads.
    this.updateBeforeType = "frame";
    this.#shown = inputs.color.value;
    this.#node = texture(this.#shown, uv());
  }

  get look() {
    return this.#look;
  }

  /** Takes over another look from the next frame on; rejects with a {@link LookError} where it is refused. */
  async setLook(look) {
    this.#graph = this.#isophote.graph(look);
    this.#look = look;
    this.#failure = null;
    await this.#stylizer?.update(look, { frame: this.#frame });
  }

  setup(builder) {
    // What a node holds here is updated before it.
    Object.assign(builder.getNodeProperties(this), this.#inputs);
    return this.#node;
  }

  updateBefore({ renderer }) {
    const inputs = {};
    for (const [name, node] of Object.entries(this.#inputs)) {
      inputs[name] = renderer.backend.get(node.value).texture;
    }
    if (Object.values(inputs).some((found) => found === undefined)) {
      return;
    }
    const { width, height } = inputs.color;
    this.#prepare(width, height);
    if (this.#fits(width, height)) {
      this.#renew();
      const encoder = this.#isophote.device.createCommandEncoder({ label: "isophote" });
      const shown = this.#stylizer.encode(encoder, inputs);
      this.#isophote.device.queue.submit([encoder.finish()]);
      this.#show(shown);
    } else {
      this.#release();
      this.#shown = this.#inputs.color.value;
      this.#node.value = this.#shown;
    }
    this.#frame += 1;
  }

  #fits(width, height) {
    return this.#stylizer?.width === width && this.#stylizer.height === height;
  }

  /** Tells the number of the frame where the look renews its marks by it. */
  #renew() {
    const { nodes } = this.#graph;
    if (nodes.some(({ params }) => params?.hold > 0)) {
      this.#stylizer.update(this.#look, { frame: this.#frame }).catch(console.error);
    }
  }

  /** Makes a stylizer for another size; the old one is kept until then. */
  #prepare(width, height) {
    if (this.#fits(width, height) || this.#making !== null || this.#failure !== null) {
      return;
    }
    const { precision = "fast" } = this.#options;
    const guides = Object.keys(this.#inputs).filter((name) => name !== "color");
    const options = { width, height, precision, guides, frame: this.#frame };
    this.#making = this.#isophote.stylizer(this.#look, options).then(async (stylizer) => {
      await stylizer.update(this.#look);
      this.#stylizer?.destroy();
      this.#stylizer = stylizer;
      this.#making = null;
      this.#told.resolve();
    }).catch((error) => {
      this.#making = null;
      this.#failure = error;
      this.#told.reject(error);
      console.error(error);
    });
  }

  #show(shown) {
    if (this.#shown.sourceTexture === shown) {
      return;
    }
    // The renderer keeps what it knows of a texture by the object that stands for it.
    this.#release();
    this.#shown = new ExternalTexture(shown);
    this.#shown.image = { width: shown.width, height: shown.height };
    this.#node.value = this.#shown;
  }

  /** Takes the next frame for the first of a shot, as after a cut: what was before counts no longer. */
  async cut() {
    await this.#stylizer?.cut();
  }

  #release() {
    if (this.#shown.isExternalTexture) {
      this.#shown.dispose();
    }
  }

  dispose() {
    this.#stylizer?.destroy();
    this.#release();
    super.dispose();
  }
}
