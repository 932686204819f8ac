// A scene around a model: light from a room, a lamp, and a plain backdrop.

import { Box3, DirectionalLight, HemisphereLight, PMREMGenerator, Scene, Sphere } from "three/webgpu";
import { color } from "three/tsl";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";

/** Behind models; light, so that drawings stand on paper. */
const BACKDROP = "#d6d7d6";

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

/** A lamp whose shadows fall on all of the model. */
function sun(root) {
  const lamp = new DirectionalLight("#fff4e2", 2.6);
  const { center, radius } = new Box3().setFromObject(root, true).getBoundingSphere(new Sphere());
  const size = Number.isFinite(radius) && radius > 0 ? radius : 1;
  lamp.position.set(-1.3, 2.1, 1.5).normalize().multiplyScalar(size * 3).add(center);
  lamp.target.position.copy(center);
  lamp.castShadow = true;
  lamp.shadow.mapSize.set(2048, 2048);
  lamp.shadow.normalBias = size * 0.008;
  lamp.shadow.radius = 3;
  const { camera } = lamp.shadow;
  Object.assign(camera, { left: -size, right: size, top: size, bottom: -size, near: size, far: size * 5 });
  camera.updateProjectionMatrix();
  return lamp;
}

/** A scene with a model and light; lamps of the model take the place of ours. */
export function furnish(renderer, root) {
  const scene = new Scene();
  // A node, so that it is treated like all other colours.
  scene.backgroundNode = color(BACKDROP);
  scene.environment = room(renderer);
  scene.environmentIntensity = 0.6;
  scene.add(root);
  let hasLamps = false;
  root.traverse((part) => {
    hasLamps ||= part.isLight === true;
    [part.castShadow, part.receiveShadow] = [part.isMesh === true, part.isMesh === true];
  });
  if (!hasLamps) {
    const lamp = sun(root);
    scene.add(lamp, lamp.target, new HemisphereLight("#dfe9f5", "#9a8f80", 0.7));
  }
  return scene;
}
