// A model to start with, made of a few shapes, so that the page need not carry one.

import {
  BoxGeometry, CylinderGeometry, Group, LatheGeometry, Mesh, MeshStandardMaterial, SphereGeometry, TorusGeometry, Vector2,
} from "three/webgpu";
import { TeapotGeometry } from "three/addons/geometries/TeapotGeometry.js";

/** A shape of one colour. */
function thing(geometry, color, [x, y, z], { roughness = 0.5, metalness = 0, turn = 0 } = {}) {
  const mesh = new Mesh(geometry, new MeshStandardMaterial({ color, roughness, metalness }));
  mesh.position.set(x, y, z);
  mesh.rotation.y = turn;
  return mesh;
}

/** An apple: a ball with a dent where its stalk is. */
function apple(color, [x, y, z], size) {
  const geometry = new SphereGeometry(size, 40, 28);
  const { position } = geometry.attributes;
  for (let index = 0; index < position.count; index += 1) {
    const [px, py, pz] = [position.getX(index), position.getY(index), position.getZ(index)];
    const dent = Math.exp(-((px * px + pz * pz) / (size * size)) * 9) * 0.34;
    position.setXYZ(index, px * 1.06, py * (0.92 - (py > 0 ? dent : dent * 0.6)), pz * 1.06);
  }
  geometry.computeVertexNormals();
  const fruit = new Group();
  const stalk = thing(new CylinderGeometry(size * 0.05, size * 0.03, size * 0.5, 8), "#4a3420", [0, size * 0.8, 0]);
  stalk.rotation.z = 0.25;
  fruit.add(thing(geometry, color, [0, 0, 0], { roughness: 0.38 }), stalk);
  fruit.position.set(x, y, z);
  return fruit;
}

/** A vessel turned about its axis, of the radii at its heights. */
function turned(outline, color, at, options) {
  const mesh = thing(new LatheGeometry(outline.map(([r, y]) => new Vector2(r, y)), 64), color, at, options);
  mesh.material.side = 2;
  return mesh;
}

/** A teapot, fruit, a bottle and a book on a table. */
export function stillLife() {
  const root = new Group();
  const bottle = [[0, 0], [0.4, 0], [0.44, 0.06], [0.44, 1.25], [0.36, 1.55], [0.16, 1.8], [0.13, 2.4], [0.17, 2.42], [0.17, 2.52], [0.12, 2.54]];
  const bowl = [[0, 0.06], [0.34, 0.06], [0.4, 0], [0.5, 0.1], [0.86, 0.34], [1.08, 0.7], [1.14, 0.72], [1.1, 0.78], [1.0, 0.72], [0.78, 0.42], [0.4, 0.18], [0, 0.14]];
  root.add(
    thing(new CylinderGeometry(3.5, 3.45, 0.22, 96), "#8d5d36", [0, -0.11, 0], { roughness: 0.65 }),
    thing(new TeapotGeometry(0.72, 12), "#2f7d86", [-1.05, 0.72, 0.15], { roughness: 0.28, turn: 0.5 }),
    turned(bowl, "#e9e1d0", [1.15, 0, -0.25], { roughness: 0.45 }),
    apple("#c33a2c", [0.85, 0.72, -0.05], 0.42),
    apple("#d9a531", [1.5, 0.72, -0.1], 0.4),
    apple("#7f9e3a", [1.16, 0.78, -0.66], 0.42),
    apple("#b5342e", [0.35, 0.36, 1.45], 0.4),
    turned(bottle, "#3d5c3a", [-0.1, 0, -1.45], { roughness: 0.22 }),
    thing(new BoxGeometry(1.5, 0.2, 1.05), "#a23a3f", [-1.6, 0.1, 1.75], { roughness: 0.8, turn: 0.35 }),
    thing(new BoxGeometry(1.2, 0.16, 0.9), "#e0c9a0", [-1.58, 0.28, 1.72], { roughness: 0.8, turn: 0.1 }),
    thing(new TorusGeometry(0.3, 0.1, 24, 64).rotateX(Math.PI / 2), "#c99a2e", [1.75, 0.1, 1.2], { roughness: 0.25, metalness: 0.6 }),
  );
  let faces = 0;
  root.traverse(({ geometry }) => { faces += (geometry?.index?.count ?? 0) / 3; });
  return { root, clips: [], name: "A still life", faces, warnings: [] };
}
