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

/** Scenes whose pictures tell what guides are worth. */
const STAGES = `
import * as THREE from "three/webgpu";
import { mrt, output, pass, vec4 } from "three/tsl";
import { Isophote } from "isophote";
import { stylize } from "isophote/three";

const [WIDTH, HEIGHT] = [160, 120];
const LINES = { style: "blueprint", lengths: "pixels", parameters: { paper_color: "#ffffff", line_color: "#000000", grid: 0, paper_texture: 0, fill: 0 } };

/** A renderer with a look that is its own. */
async function stage(options, near, far) {
  const renderer = new THREE.WebGPURenderer(options);
  await renderer.init();
  document.body.append(renderer.domElement);
  renderer.setSize(WIDTH, HEIGHT);
  const isophote = await Isophote.create({ device: renderer.backend.device });
  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(45, WIDTH / HEIGHT, near, far);
  const square = (side, z, color = "#808080") => {
    const mesh = new THREE.Mesh(new THREE.PlaneGeometry(side, side), new THREE.MeshBasicMaterial({ color }));
    mesh.position.z = z;
    scene.add(mesh);
    return mesh;
  };
  return { renderer, isophote, scene, camera, square };
}

function read(canvas) {
  const copy = new OffscreenCanvas(WIDTH, HEIGHT);
  const context = copy.getContext("2d");
  context.drawImage(canvas, 0, 0);
  return context.getImageData(0, 0, WIDTH, HEIGHT).data;
}

function dark(data) {
  let count = 0;
  for (let at = 0; at < data.length; at += 4) {
    count += data[at] < 96 ? 1 : 0;
  }
  return count;
}

async function shown({ renderer, isophote, scene, camera }, look, options, own) {
  const pipeline = new THREE.RenderPipeline(renderer);
  const scenePass = pass(scene, camera);
  if (own !== undefined) {
    scenePass.setMRT(own);
  }
  const stylized = stylize(isophote, look, scenePass, options);
  pipeline.outputNode = stylized;
  pipeline.outputColorTransform = false;
  pipeline.render();
  await stylized.ready;
  pipeline.render();
  return { pipeline, scenePass, stylized };
}

/** Dark pixels of lines around a square that stands before another, in scenes of these units. */
window.step = async (unit, antialias) => {
  const made = await stage({ antialias }, 0.1 * unit, 200 * unit);
  made.square(400 * unit, -100 * unit);
  made.square(24 * unit, -70 * unit);
  const { pipeline } = await shown(made, LINES, { guides: ["depth"] });
  pipeline.render();
  return dark(read(made.renderer.domElement));
};

/** The target of the application is there, and lines are. */
window.own = async () => {
  const made = await stage({ antialias: false }, 0.1, 100);
  made.square(40, -12);
  made.square(1.4, -4);
  const marked = mrt({ output, marked: vec4(0.25, 0.5, 0.75, 1) });
  const { scenePass } = await shown(made, LINES, { guides: ["depth"] }, marked);
  const texture = scenePass.getTexture("marked");
  return { lines: dark(read(made.renderer.domElement)), names: scenePass.renderTarget.textures.map(({ name }) => name), hasMarked: texture.image.width };
};

/** Brightest and darkest red at the border of a white square over nothing, over red paper. */
window.border = async () => {
  const made = await stage({ antialias: true, alpha: true }, 0.1, 100);
  made.renderer.setClearColor("#000000", 0);
  const white = made.square(2, -4, "#ffffff");
  white.rotation.z = 0.3;
  await shown(made, { style: "gaussian", lengths: "pixels", parameters: { sigma: 0.1 } }, { guides: [] });
  const copy = new OffscreenCanvas(WIDTH, HEIGHT);
  const context = copy.getContext("2d");
  context.fillStyle = "#ff0000";
  context.fillRect(0, 0, WIDTH, HEIGHT);
  context.drawImage(made.renderer.domElement, 0, 0);
  const { data } = context.getImageData(0, 0, WIDTH, HEIGHT);
  let [least, pale] = [255, 0];
  for (let at = 0; at < data.length; at += 4) {
    least = Math.min(least, data[at]);
    pale += data[at + 1] > 40 && data[at + 1] < 215 ? 1 : 0;
  }
  return { least, pale };
};

/** Change from frame to frame of a slow turn, of what does not move by itself. */
window.turns = async (guides) => {
  const made = await stage({ antialias: false }, 0.1, 100);
  const dots = document.createElement("canvas");
  [dots.width, dots.height] = [256, 256];
  const brush = dots.getContext("2d");
  for (let spot = 0; spot < 4000; spot += 1) {
    const random = (n) => Math.abs(Math.sin(spot * 12.9898 + n * 78.233) * 43758.5453) % 1;
    brush.fillStyle = \`hsl(\${random(1) * 360} 50% \${30 + random(2) * 50}%)\`;
    brush.fillRect(random(3) * 256, random(4) * 256, 3, 3);
  }
  const wall = made.square(12, -6);
  wall.material.map = new THREE.CanvasTexture(dots);
  wall.material.color.set("#ffffff");
  const look = { style: "cartoon", lengths: "pixels", parameters: { steadiness: 1 } };
  const { pipeline, stylized } = await shown(made, look, { guides });
  const device = made.isophote.device;
  const frame = async (x) => {
    made.camera.position.x = x;
    pipeline.render();
    // At once, for a canvas is cleared after its frame.
    const data = read(made.renderer.domElement);
    await device.queue.onSubmittedWorkDone();
    // Time to plan for one more frame before.
    await new Promise((resolve) => { setTimeout(resolve, 400); });
    return data;
  };
  // A pixel of the wall at each step, so that the pictures lie on one another.
  const pixel = (2 * 6 * Math.tan((45 / 2) * (Math.PI / 180))) / HEIGHT;
  const pictures = [];
  for (let n = 0; n < 7; n += 1) {
    pictures.push(await frame(n * pixel * 1.5));
  }
  await stylized.cut();
  await frame(2);
  let [sum, count] = [0, 0];
  const [before, now] = pictures.slice(-3).filter((_, n) => n !== 1);
  for (let y = 10; y < HEIGHT - 10; y += 1) {
    for (let x = 10; x < WIDTH - 14; x += 1) {
      for (let c = 0; c < 3; c += 1) {
        // Two steps are three pixels.
        sum += Math.abs(now[(y * WIDTH + x) * 4 + c] - before[(y * WIDTH + x + 3) * 4 + c]);
        count += 1;
      }
    }
  }
  return sum / count;
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
  await writeFile(join(folder, "stages.js"), STAGES);
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
    "/stages.js": join(folder, "stages.js"),
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

test("three.js draws distances in any unit, with samples or without", { timeout: 240_000 }, async () => {
  const { page, complaints } = await open(browser, `${server.address}/blank.html`, { viewport: { width: 320, height: 240 } });
  await page.evaluate(() => import("/stages.js"));
  for (const antialias of [false, true]) {
    for (const unit of [0.001, 1, 1000]) {
      const count = await page.evaluate(([unit, antialias]) => window.step(unit, antialias), [unit, antialias]);
      assert.ok(count > 60 && count < 900, `${count} pixels of lines in units of ${unit}, antialias ${antialias}`);
    }
  }
  assert.deepEqual(complaints, []);
  await page.close();
});

test("three.js keeps what the application draws besides", { timeout: 240_000 }, async () => {
  const { page, complaints } = await open(browser, `${server.address}/blank.html`, { viewport: { width: 320, height: 240 } });
  await page.evaluate(() => import("/stages.js"));
  const { lines, names, hasMarked } = await page.evaluate(() => window.own());
  assert.ok(lines > 60, `${lines} pixels of lines`);
  assert.ok(names.includes("marked") && names.includes("isophoteDepth"), names.join());
  assert.equal(hasMarked, 160);
  assert.deepEqual(complaints, []);
  await page.close();
});

test("borders over a transparent canvas of three.js have no fringes", { timeout: 240_000 }, async () => {
  const { page, complaints } = await open(browser, `${server.address}/blank.html`, { viewport: { width: 320, height: 240 } });
  await page.evaluate(() => import("/stages.js"));
  const { least, pale } = await page.evaluate(() => window.border());
  // White and red have all of red: a darker border is a fringe.
  assert.ok(least > 245, `red falls to ${least}`);
  assert.ok(pale > 40, `${pale} pixels between`);
  assert.deepEqual(complaints, []);
  await page.close();
});

test("velocities of three.js hold a look steady", { timeout: 360_000 }, async () => {
  const { page, complaints } = await open(browser, `${server.address}/blank.html`, { viewport: { width: 320, height: 240 } });
  await page.evaluate(() => import("/stages.js"));
  const [alone, steady] = [await page.evaluate(() => window.turns(["depth"])), await page.evaluate(() => window.turns(["depth", "motion"]))];
  assert.ok(steady < alone * 0.9, `${steady.toFixed(2)} steady, ${alone.toFixed(2)} without motion`);
  assert.deepEqual(complaints, []);
  await page.close();
});
