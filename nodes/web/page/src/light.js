// A scene around a model: light from a room, a lamp, and a plain backdrop.

import { Color, DirectionalLight, HemisphereLight, PMREMGenerator, Scene } from "three/webgpu";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";

/** Behind models; light, so that drawings stand on paper. */
const BACKDROP = "#c9ccce";

/** The room of each renderer, which takes a moment to make. */
const rooms = new WeakMap();

function room(renderer) {
  if (!rooms.has(renderer)) {
    const generator = new PMREMGenerator(renderer);
    rooms.set(renderer, generator.fromScene(new RoomEnvironment(), 0.04).texture);
    generator.dispose();
  }
  return rooms.get(renderer);
}

/** A scene with a model and light; lamps of the model take the place of ours. */
export function furnish(renderer, root) {
  const scene = new Scene();
  scene.background = new Color(BACKDROP);
  scene.environment = room(renderer);
  scene.environmentIntensity = 0.55;
  scene.add(root);
  let hasLamps = false;
  root.traverse((part) => { hasLamps ||= part.isLight === true; });
  if (!hasLamps) {
    const sun = new DirectionalLight("#fff4e2", 2.1);
    sun.position.set(-1.4, 2.2, 1.6);
    scene.add(sun, new HemisphereLight("#dfe9f5", "#8a7f70", 0.5));
  }
  return scene;
}
