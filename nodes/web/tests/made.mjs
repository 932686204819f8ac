// Files for tests, made of numbers: pictures and models.

import { deflateSync } from "node:zlib";

/** The checksum of chunks of PNG files. */
function crc32(bytes) {
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit += 1) {
      crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
    }
  }
  return ~crc >>> 0;
}

/** A picture as PNG; `color(x, y)` gives red, green and blue. */
export function png(width, height, color) {
  const rows = Buffer.alloc((width * 3 + 1) * height);
  for (let y = 0; y < height; y += 1) {
    for (let x = 0; x < width; x += 1) {
      rows.set(color(x, y), y * (width * 3 + 1) + 1 + x * 3);
    }
  }
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, 2, 0, 0, 0], 8);
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type, "latin1"), data]);
    const [length, sum] = [Buffer.alloc(4), Buffer.alloc(4)];
    length.writeUInt32BE(data.length);
    sum.writeUInt32BE(crc32(body));
    return Buffer.concat([length, body, sum]);
  };
  const signature = Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]);
  return Buffer.concat([signature, chunk("IHDR", head), chunk("IDAT", deflateSync(rows)), chunk("IEND", Buffer.alloc(0))]);
}

/** A landscape: a sky, a hill, and a sun. */
export function photo(width = 320, height = 240) {
  return png(width, height, (x, y) => {
    const [u, v] = [x / width, y / height];
    if (Math.hypot(u - 0.7, (v - 0.3) * 0.75) < 0.12) {
      return [250, 220, 90];
    }
    const hill = 0.6 + 0.12 * Math.sin(u * 7);
    return v > hill ? [60 + 60 * u, 120 - 40 * v, 40] : [90 + 100 * v, 150 + 60 * v, 230];
  });
}

/** Width and height of a PNG. */
export function sizeOf(bytes) {
  return [bytes.readUInt32BE(16), bytes.readUInt32BE(20)];
}

/** A red tetrahedron: its document, and its buffer. */
export function tetrahedron() {
  const [a, b, c, d] = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]];
  const faces = [[a, c, b], [a, b, d], [a, d, c], [b, c, d]].map((face) => {
    const [p, q, r] = face;
    const [u, v] = [q.map((value, axis) => value - p[axis]), r.map((value, axis) => value - p[axis])];
    const cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    // Corners go round so that the normal points outwards.
    const isInward = cross.reduce((sum, value, axis) => sum + value * (p[axis] + q[axis] + r[axis]), 0) < 0;
    return isInward ? [p, r, q] : face;
  });
  const normal = (face) => [0, 1, 2].map((axis) => face.reduce((sum, corner) => sum + corner[axis], 0) / Math.sqrt(3));
  const positions = faces.flat(2);
  const normals = faces.flatMap((face) => face.flatMap(() => normal(face)));
  const bin = Buffer.from(Float32Array.from([...positions, ...normals]).buffer);
  const view = (byteOffset) => ({ buffer: 0, byteOffset, byteLength: 144 });
  const accessor = (bufferView) => ({ bufferView, componentType: 5126, count: 12, type: "VEC3", min: [-1, -1, -1], max: [1, 1, 1] });
  const json = {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, NORMAL: 1 }, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorFactor: [0.8, 0.05, 0.03, 1], metallicFactor: 0 } }],
    accessors: [accessor(0), accessor(1)],
    bufferViews: [view(0), view(144)],
    buffers: [{ byteLength: 288 }],
  };
  return { json, bin };
}

/** The same with an animation of five seconds, in which it stays where it is. */
export function animated() {
  const { json, bin } = tetrahedron();
  const times = Buffer.from(Float32Array.from([0, 5, 0, 0, 0, 0, 0, 0]).buffer);
  const at = json.accessors.length;
  json.bufferViews.push({ buffer: 0, byteOffset: bin.length, byteLength: 8 }, { buffer: 0, byteOffset: bin.length + 8, byteLength: 24 });
  json.accessors.push(
    { bufferView: at, componentType: 5126, count: 2, type: "SCALAR", min: [0], max: [5] },
    { bufferView: at + 1, componentType: 5126, count: 2, type: "VEC3" },
  );
  json.animations = [{ samplers: [{ input: at, output: at + 1 }], channels: [{ sampler: 0, target: { node: 0, path: "translation" } }] }];
  json.buffers[0].byteLength = bin.length + times.length;
  return { json, bin: Buffer.concat([bin, times]) };
}

/** A model in one file. */
export function glb({ json, bin } = tetrahedron()) {
  const text = Buffer.from(JSON.stringify(json));
  const padded = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, 0x20)]);
  const head = (length, type) => {
    const bytes = Buffer.alloc(8);
    bytes.writeUInt32LE(length, 0);
    bytes.writeUInt32LE(type, 4);
    return bytes;
  };
  const body = Buffer.concat([head(padded.length, 0x4e4f534a), padded, head(bin.length, 0x004e4942), bin]);
  const start = Buffer.alloc(12);
  start.writeUInt32LE(0x46546c67, 0);
  start.writeUInt32LE(2, 4);
  start.writeUInt32LE(12 + body.length, 8);
  return Buffer.concat([start, body]);
}
