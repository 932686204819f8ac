// The packed package with three.js, as users install both: the example, and guides that make lines.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdir, mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { built, launch, open, serve } from "./browser.mjs";

const run = promisify(execFile);
const three = join(dirname(fileURLToPath(import.meta.url)), "../node_modules/three");
let browser, server, folder;

/** A square in front of another of the same colour: without guides there is nothing to draw. */
const SQUARES = `
import * as THREE from "three/webgpu";
import { pass } from "three/tsl";
import { Isophote } from "isophote";
import { stylize } from "isophote/three";

const renderer = new THREE.WebGPURenderer({ antialias: false });
await renderer.init();
document.body.append(renderer.domElement);
renderer.setSize(160, 120);
const scene = new THREE.Scene();
const camera = new THREE.PerspectiveCamera(45, 160 / 120, 0.1, 100);
const material = new THREE.MeshBasicMaterial({ color: "#808080" });
const square = (side, z) => {
  const mesh = new THREE.Mesh(new THREE.PlaneGeometry(side, side), material);
  mesh.position.z = z;
  scene.add(mesh);
};
square(40, -12);
square(1.4, -4);
const isophote = await Isophote.create({ device: renderer.backend.device });
const look = { style: "blueprint", lengths: "pixels", parameters: { paper_color: "#ffffff", line_color: "#000000", grid: 0, paper_texture: 0, fill: 0 } };
window.dark = async (guides) => {
  const pipeline = new THREE.RenderPipeline(renderer);
  const stylized = stylize(isophote, look, pass(scene, camera), { guides });
  pipeline.outputNode = stylized;
  pipeline.outputColorTransform = false;
  pipeline.render();
  await stylized.ready;
  pipeline.render();
  const canvas = new OffscreenCanvas(160, 120);
  const context = canvas.getContext("2d");
  context.drawImage(renderer.domElement, 0, 0);
  const { data } = context.getImageData(0, 0, 160, 120);
  let count = 0;
  for (let at = 0; at < data.length; at += 4) {
    count += data[at] < 96 ? 1 : 0;
  }
  return count;
};
window.resized = async () => {
  const pipeline = new THREE.RenderPipeline(renderer);
  const stylized = stylize(isophote, look, pass(scene, camera));
  pipeline.outputNode = stylized;
  pipeline.outputColorTransform = false;
  pipeline.render();
  await stylized.ready;
  for (const width of [200, 96, 160]) {
    renderer.setSize(width, 120);
    for (let frame = 0; frame < 4; frame += 1) {
      pipeline.render();
      await new Promise((resolve) => { setTimeout(resolve, 50); });
    }
  }
  await stylized.setLook({ style: "ink" });
  pipeline.render();
  const refused = await stylized.setLook({ style: "inc" }).catch((error) => error.message);
  stylized.dispose();
  return refused;
};
`;

/** The programs of the package's README as one, on a page that has what they name. */
const AROUND = [
  `import * as scenes from "three/webgpu";
  const picture_ = new OffscreenCanvas(128, 96);
  const brush = picture_.getContext("2d");
  brush.fillStyle = "#e8d8b0";
  brush.fillRect(0, 0, 128, 96);
  brush.fillStyle = "#803020";
  brush.fillRect(36, 24, 48, 44);
  const image = document.createElement("img");
  image.src = URL.createObjectURL(await picture_.convertToBlob());
  const live = document.createElement("canvas");
  live.className = "live";
  document.body.append(image, document.createElement("canvas"), live);
  await image.decode();
  const scene = new scenes.Scene();
  scene.add(new scenes.Mesh(new scenes.BoxGeometry(), new scenes.MeshBasicMaterial()));
  const camera = new scenes.PerspectiveCamera(45, 2, 0.1, 9);
  camera.position.z = 3;
  `,
  `
  await pipeline.outputNode.ready;
  // More frames than two only wait for one another.
  await new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); });
  renderer.setAnimationLoop(null);
  await Promise.all([isophote, shared].map(({ device }) => device.queue.onSubmittedWorkDone()));
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  window.shades = new Set(data).size;
  `,
];

before(async () => {
  folder = await mkdtemp(join(tmpdir(), "isophote-"));
  const modules = join(folder, "node_modules/isophote");
  await mkdir(modules, { recursive: true });
  await run("tar", ["-xzf", built("ISOPHOTE_PACKED"), "-C", modules, "--strip-components=1"]);
  await writeFile(join(folder, "squares.js"), SQUARES);
  // The example's import map alone.
  const example = await readFile(join(modules, "examples/three/index.html"), "utf8");
  await writeFile(join(folder, "blank.html"), example.replace(/<script type="module".*?<\/script>/, ""));
  const readme = await readFile(join(modules, "README.md"), "utf8");
  const programs = [...readme.matchAll(/```js\n(.*?)```/gs)].map(([, program]) => program);
  assert.equal(programs.length, 3);
  await writeFile(join(folder, "readme.js"), AROUND.join(programs.join("\n")));
  server = await serve({
    "/": join(modules, "examples/three"),
    "/blank.html": join(folder, "blank.html"),
    "/squares.js": join(folder, "squares.js"),
    "/readme.js": join(folder, "readme.js"),
    "/node_modules/isophote": modules,
    "/node_modules/three": three,
  });
  browser = await launch();
});

after(async () => {
  await browser?.close();
  await server?.close();
  await rm(folder, { recursive: true, force: true });
});

test("the example draws lines around things", { timeout: 240_000 }, async () => {
  const { page, complaints } = await open(browser, `${server.address}/index.html`, { viewport: { width: 240, height: 160 } });
  await page.waitForFunction(() => document.querySelector("#look").length > 40, null, { timeout: 60_000 });
  await page.waitForFunction(() => document.querySelector("#message").textContent === "", null, { timeout: 120_000 });
  await page.waitForTimeout(1000);
  const shot = await page.screenshot({ timeout: 60_000 });
  const share = await page.evaluate(async (bytes) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(bytes)], { type: "image/png" }));
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
    const context = canvas.getContext("2d");
    context.drawImage(bitmap, 0, 0);
    // Below the form.
    const { data } = context.getImageData(0, 60, bitmap.width, bitmap.height - 60);
    let dark = 0;
    for (let at = 0; at < data.length; at += 4) {
      dark += Math.max(data[at], data[at + 1], data[at + 2]) < 48 ? 1 : 0;
    }
    return dark / (data.length / 4);
  }, [...shot]);
  assert.ok(share > 0.005 && share < 0.3, `${(share * 100).toFixed(2)} % of the picture is dark`);
  assert.deepEqual(complaints, []);
  await page.close();
});

test("the programs of the README run", { timeout: 240_000 }, async () => {
  const { page, complaints } = await open(browser, `${server.address}/blank.html`, { viewport: { width: 320, height: 240 } });
  await page.evaluate(() => import("/readme.js"));
  const shades = await page.evaluate(() => window.shades);
  assert.ok(shades > 4, `the picture has ${shades} shades`);
  assert.deepEqual(complaints, []);
  await page.close();
});

test("guides make lines where colours do not", { timeout: 240_000 }, async () => {
  const { page, complaints } = await open(browser, `${server.address}/blank.html`, { viewport: { width: 320, height: 240 } });
  await page.evaluate(() => import("/squares.js"));
  const [without, withDepth] = [await page.evaluate(() => window.dark([])), await page.evaluate(() => window.dark(["depth"]))];
  assert.equal(without, 0);
  assert.ok(withDepth > 60, `${withDepth} pixels of lines`);
  const refused = await page.evaluate(() => window.resized());
  assert.match(refused, /'inc'.*ink/);
  assert.deepEqual(complaints, []);
  await page.close();
});
