// Where a camera stands so that all of a model is seen.

import { Box3, Sphere, Vector3 } from "three/webgpu";

/** From where models are first seen. */
const VIEW = new Vector3(0.55, 0.42, 0.95).normalize();

/** How much of the view models take. */
const SHARE = 0.9;

/** Points that are looked at, about. */
const POINTS = 6000;

/** Points of all meshes, as they stand now. */
function points(root) {
  root.updateMatrixWorld(true);
  const meshes = [];
  root.traverse((part) => part.geometry?.attributes.position && part.isMesh && meshes.push(part));
  const total = meshes.reduce((sum, { geometry }) => sum + geometry.attributes.position.count, 0);
  const step = Math.max(1, Math.floor(total / POINTS));
  const found = [];
  for (const mesh of meshes) {
    if (mesh.isInstancedMesh) {
      const box = new Box3().setFromObject(mesh);
      found.push(box.min, box.max);
    } else {
      for (let index = 0; index < mesh.geometry.attributes.position.count; index += step) {
        // Where bones and morph targets put it.
        found.push(mesh.getVertexPosition(index, new Vector3()).applyMatrix4(mesh.matrixWorld));
      }
    }
  }
  return found.filter(({ x, y, z }) => Number.isFinite(x + y + z));
}

/** What of the view the points take, from -1 to 1. */
function extent(all, camera) {
  const box = new Box3();
  all.forEach((point) => box.expandByPoint(point.clone().project(camera)));
  return box;
}

/**
 * Places a camera.
 * @returns {{target: Vector3, size: number, far: number}} what it looks at, how large that is, and how far away
 */
export function frame(root, camera) {
  const all = points(root);
  const { center, radius } = new Box3().setFromPoints(all.length > 0 ? all : [new Vector3()]).getBoundingSphere(new Sphere());
  const size = Math.max(radius, 1e-6);
  const target = center.clone();
  let far = size * 4;
  const place = () => {
    camera.position.copy(VIEW).multiplyScalar(far).add(target);
    Object.assign(camera, { near: far / 200, far: far * 20 });
    camera.lookAt(target);
    camera.updateMatrixWorld();
    camera.updateProjectionMatrix();
  };
  place();
  for (let round = 0; round < 5 && all.length > 1; round += 1) {
    const { min, max } = extent(all, camera);
    // The middle of what is seen goes to the middle of the view.
    const half = far * Math.tan((camera.fov * Math.PI) / 360);
    target.addScaledVector(new Vector3().setFromMatrixColumn(camera.matrixWorld, 0), ((min.x + max.x) / 2) * half * camera.aspect);
    target.addScaledVector(new Vector3().setFromMatrixColumn(camera.matrixWorld, 1), ((min.y + max.y) / 2) * half);
    far = Math.max(far * (Math.max(max.x - min.x, max.y - min.y) / 2 / SHARE), size * 1.02);
    place();
  }
  return { target, size, far };
}
