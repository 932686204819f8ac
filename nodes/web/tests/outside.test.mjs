// What comes from outside in files, and where it must not go: into the page's markup, and to the network.

import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { connect } from "../page/src/gltf.js";

const page = fileURLToPath(new URL("../page/src", import.meta.url));

test("models leave no address but those of files that came with them", () => {
  const away = "https://example.org/seen.png";
  const json = {
    buffers: [{ uri: "mesh.bin" }, { uri: "data:application/octet-stream;base64,AAAA" }],
    images: [
      { uri: "skin.png" },
      { uri: away },
      { uri: "//example.org/seen.webp", name: "two" },
      { uri: "file:///etc/hosts" },
      { uri: "DATA:image/png;base64,AAAA" },
      { uri: "https://example.org/seen.ktx2" },
      { uri: "data:image/png;base64,AAAA" },
    ],
    textures: [
      { source: 0, extensions: { EXT_texture_avif: { source: 1 } } },
      { source: 0, extensions: { EXT_texture_webp: { source: 2 } } },
      { extensions: { KHR_texture_basisu: { source: 5 } } },
      { source: 0 },
      { source: 6, extensions: { EXT_texture_avif: { source: 0 } } },
    ],
    materials: [
      { pbrMetallicRoughness: { baseColorTexture: { index: 0 }, metallicRoughnessTexture: { index: 3 } } },
      { normalTexture: { index: 1 }, emissiveTexture: { index: 4 }, occlusionTexture: { index: 2 } },
    ],
  };
  const files = new Map([["mesh.bin", new Blob(["m"])], ["skin.png", new Blob(["s"])]]);
  const { urls, warnings } = connect(json, null, (uri) => files.get(uri), "thing.gltf");
  const addresses = [...json.buffers, ...json.images].map(({ uri }) => uri).filter((uri) => uri !== undefined);
  for (const uri of addresses) {
    assert.match(uri, /^(blob|data):/);
  }
  assert.equal(addresses.length, 4);
  assert.equal(urls.length, 2);
  assert.ok(warnings[0].includes(away) && warnings[0].includes("1 more"), warnings[0]);
  // Textures that would be loaded from elsewhere are taken out, others stay.
  assert.deepEqual(json.materials, [
    { pbrMetallicRoughness: { metallicRoughnessTexture: { index: 3 } } },
    { emissiveTexture: { index: 4 } },
  ]);
  assert.throws(() => connect({ buffers: [{ uri: away }] }, null, () => undefined, "thing.gltf"), /needs https:\/\/example\.org/);
});

test("text becomes text nodes and properties, never markup or program", () => {
  const files = readdirSync(page).filter((name) => name.endsWith(".js"));
  assert.ok(files.length > 20);
  for (const name of files) {
    const markup = /innerHTML|outerHTML|insertAdjacentHTML|setHTML|document\.write|srcdoc|DOMParser|createContextualFragment|\beval\(|new Function/;
    assert.doesNotMatch(readFileSync(join(page, name), "utf8"), markup, name);
  }
});
