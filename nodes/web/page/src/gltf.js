// glTF files as scenes of three.js. All that a file names is looked up among the files that came with it.

import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";

/** What a glb begins with, and the types of its chunks. */
const [MAGIC, JSON_CHUNK, BIN_CHUNK] = [0x46546c67, 0x4e4f534a, 0x004e4942];

/** Compression that needs more than the page brings. */
const UNREAD = {
  KHR_draco_mesh_compression: "Draco",
};

/** The document of a file, and the buffer within it. */
async function parts(file) {
  const bytes = await file.arrayBuffer();
  const view = new DataView(bytes);
  if (bytes.byteLength < 12 || view.getUint32(0, true) !== MAGIC) {
    return { json: parse(new TextDecoder().decode(bytes), file.name), bin: null };
  }
  let [json, bin] = [null, null];
  for (let at = 12; at + 8 <= bytes.byteLength;) {
    const [length, type] = [view.getUint32(at, true), view.getUint32(at + 4, true)];
    if (at + 8 + length > bytes.byteLength) {
      throw new Error(`${file.name} is cut off: it should be longer. Copy or download it again.`);
    }
    if (type === JSON_CHUNK) {
      json = parse(new TextDecoder().decode(new Uint8Array(bytes, at + 8, length)), file.name);
    } else if (type === BIN_CHUNK) {
      bin = new Blob([new Uint8Array(bytes, at + 8, length)]);
    }
    at += 8 + length;
  }
  if (json === null) {
    throw new Error(`${file.name} holds no scene. Save it again as glTF 2.0.`);
  }
  return { json, bin };
}

function parse(text, name) {
  let json;
  try {
    json = JSON.parse(text);
  } catch {
    throw new Error(`${name} is damaged: it is no glTF document. Save it again as glTF 2.0.`);
  }
  if (json?.asset?.version === undefined) {
    throw new Error(`${name} is no glTF document. Save it as glTF 2.0.`);
  }
  if (!String(json.asset.version).startsWith("2")) {
    throw new Error(`${name} is glTF ${json.asset.version}, and this page reads glTF 2.0. Save it again in that version.`);
  }
  return json;
}

/** Finds files by the paths that a document writes. */
function finder(entries, main) {
  const folder = main.path.slice(0, main.path.lastIndexOf("/") + 1);
  const plain = (path) => path.replace(/^(\.\/)+/, "").toLowerCase();
  const byPath = new Map(entries.map(({ path, file }) => [plain(path), file]));
  const byName = new Map(entries.map(({ path, file }) => [plain(path).split("/").pop(), file]));
  return (uri) => {
    let path = uri;
    try {
      path = decodeURIComponent(uri);
    } catch {
      // It is written without escapes.
    }
    return byPath.get(plain(folder + path.replace(/^(\.\/)+/, ""))) ?? byName.get(plain(path).split("/").pop());
  };
}

/** Takes textures out of materials that cannot be had. */
function forget(json, isLost) {
  const walk = (value) => {
    for (const [key, child] of Object.entries(value ?? {})) {
      if (child === null || typeof child !== "object") {
        continue;
      }
      if (/texture$/i.test(key) && isLost(child.index)) {
        delete value[key];
      } else {
        walk(child);
      }
    }
  };
  walk(json.materials ?? []);
}

/**
 * Puts addresses within the page where a document names files. No other address is left in it: loaders would follow it.
 * @returns {{urls: string[], warnings: string[]}} to be given back, and what is missing
 */
export function connect(json, bin, find, name) {
  const urls = [];
  const warnings = [];
  const url = (blob) => {
    urls.push(URL.createObjectURL(blob));
    return urls.at(-1);
  };
  const missing = [];
  (json.buffers ?? []).forEach((buffer, index) => {
    if (buffer.uri === undefined) {
      if (index === 0 && bin !== null) {
        buffer.uri = url(bin);
      }
    } else if (!buffer.uri.startsWith("data:")) {
      const file = find(buffer.uri);
      if (file === undefined) {
        missing.push(buffer.uri);
      } else {
        buffer.uri = url(file);
      }
    }
  });
  if (missing.length > 0) {
    throw new Error(`${name} needs ${missing.join(" and ")}, which did not come with it.`
      + " Drop them together, or drop the whole folder.");
  }
  const lost = images(json, find, url);
  if (lost.length > 0) {
    warnings.push(`${name} is shown without ${lost.slice(0, 4).join(", ")}${lost.length > 4 ? ` and ${lost.length - 4} more textures` : ""}:`
      + " they did not come with it, or this page does not read them. It reads PNG, JPEG and WebP.");
  }
  return { urls, warnings };
}

/** Addresses of images; the names of those that cannot be had, whose textures are taken out. */
function images(json, find, url) {
  const lost = new Map();
  const lose = (index, label, image) => {
    lost.set(index, label);
    delete image.uri;
  };
  (json.images ?? []).forEach((image, index) => {
    const label = image.uri?.startsWith("data:") === false ? image.uri : image.name ?? `image ${index + 1}`;
    if (/\.ktx2$/i.test(image.uri ?? "") || image.mimeType === "image/ktx2") {
      lose(index, label, image);
    } else if (image.uri !== undefined && !image.uri.startsWith("data:")) {
      const file = find(image.uri);
      if (file === undefined) {
        lose(index, label, image);
      } else {
        image.uri = url(file);
      }
    }
  });
  // In the order in which the loader looks.
  const source = ({ source: plain, extensions = {} }) => extensions.EXT_texture_webp?.source ?? extensions.EXT_texture_avif?.source ?? plain;
  for (const texture of json.textures ?? []) {
    delete texture.extensions?.KHR_texture_basisu;
    if (source(texture) === undefined) {
      texture.isLost = true;
    }
  }
  const isLost = (index) => {
    const texture = json.textures?.[index];
    return texture === undefined || texture.isLost || lost.has(source(texture));
  };
  forget(json, isLost);
  json.extensionsRequired = json.extensionsRequired?.filter((extension) => extension !== "KHR_texture_basisu");
  return [...lost.values()];
}

/**
 * Reads a model.
 * @param {{path: string, file: File}[]} entries all files that came
 * @param {{path: string, file: File}} main the .glb or .gltf among them
 * @returns {Promise<{root: Object3D, clips: AnimationClip[], name: string, faces: number, warnings: string[]}>}
 * @throws {Error} a sentence that says what is missing or what the page does not read
 */
export async function readModel(entries, main) {
  const { name } = main.file;
  const { json, bin } = await parts(main.file);
  const unread = Object.keys(UNREAD).find((extension) => json.extensionsRequired?.includes(extension));
  if (unread !== undefined) {
    throw new Error(`${name} is compressed by ${UNREAD[unread]}, which this page does not read. Save it without compression.`);
  }
  const { urls, warnings } = connect(json, bin, finder(entries, main), name);
  try {
    const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
    const { scene, scenes, animations } = await loader.parseAsync(JSON.stringify(json), "");
    const root = scene ?? scenes[0];
    const faces = root === undefined ? 0 : count(root);
    if (faces === 0) {
      throw new Error("it holds nothing to see");
    }
    return { root, clips: animations, name, faces, warnings };
  } catch (error) {
    throw new Error(`${name} cannot be shown: ${String(error?.message ?? error).replace(/^THREE\.GLTFLoader: /, "").replace(/\.$/, "")}.`
      + " Save it again as glTF 2.0, or tell the project.");
  } finally {
    urls.forEach((url) => URL.revokeObjectURL(url));
  }
}

/** Triangles of all meshes. */
function count(root) {
  let faces = 0;
  root.traverse(({ geometry, isMesh, count: copies = 1 }) => {
    if (isMesh) {
      const corners = geometry.index?.count ?? geometry.attributes.position?.count ?? 0;
      faces += Math.floor(corners / 3) * copies;
    }
  });
  return faces;
}
