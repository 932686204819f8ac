// A browser without a graphics device: the processor computes, on the page and in the package.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { promisify } from "node:util";
import { built, launch, open, serve } from "./browser.mjs";
import { photo, sizeOf } from "./made.mjs";
import { Pages, drop, dropPhoto, message, opened, settled, shot } from "./pages.mjs";

const run = promisify(execFile);

/** Whether the page complains, and not the browser of the device that is not there. */
const isOwn = (complaint) => !/No available adapters/.test(complaint);

const pages = new Pages();
let folder;

before(async () => {
  folder = await mkdtemp(join(tmpdir(), "isophote-"));
  await pages.start({ hasDevice: false });
});

after(async () => {
  await pages.close();
  await rm(folder, { recursive: true, force: true });
});

test("without a device the page computes on the processor, and says so", { timeout: 300_000 }, async () => {
  const page = await pages.open("", { hasThumbnails: true });
  assert.match(await message(page, "backend"), /Computed on the processor: slower\./);
  assert.ok(await page.locator("#backend").isVisible());
  await page.locator("#hint-close").click();
  await page.locator('.note[data-key="backend"]').getByLabel("Close this message").click();
  await dropPhoto(page);
  const first = await shot(page);
  await page.locator('[data-look="style-ink"]').click();
  await settled(page);
  assert.notDeepEqual(await shot(page), first, "another look shows the same pixels");
  await page.keyboard.down("o");
  const original = await shot(page);
  assert.notDeepEqual(original, first, "holding O shows no original");
  await page.keyboard.up("o");
  await page.waitForFunction(() => document.querySelectorAll(".card.made").length >= 3);
  const [download] = await Promise.all([page.waitForEvent("download"), page.locator("#save").click()]);
  assert.deepEqual(sizeOf(await readFile(await download.path())), [320, 240]);
  await page.locator("#samples").click();
  await page.getByRole("menuitem", { name: "A still life, in 3D" }).click();
  assert.match(await message(page, "file"), /Models are drawn by a graphics card/);
  assert.deepEqual([pages.complaints.filter(isOwn), pages.requests], [[], []]);
  await page.close();
});

test("the processor gives the pixels of apply, in parts, and refuses as a device does", { timeout: 600_000 }, async (step) => {
  const server = await serve({ "/package/": built("ISOPHOTE_PACKAGE") });
  const browser = await launch({ hasDevice: false });
  // Also where an assertion fails: what is open keeps the tests from ending.
  step.after(() => Promise.all([browser.close(), server.close()]));
  const { page, complaints } = await open(browser, server.address);
  const picture = join(folder, "hill.png");
  await writeFile(picture, photo());
  const state = await page.evaluate(async (bytes) => {
    const { Isophote } = await import("/package/src/index.js");
    window.iso = await Isophote.create();
    window.photo = await createImageBitmap(new Blob([Uint8Array.from(bytes)], { type: "image/png" }));
    const said = (work) => work().catch((error) => `${error.name}: ${error.message}`);
    return {
      backend: window.iso.backend,
      reason: window.iso.reason,
      forced: await said(() => Isophote.create({ backend: "gpu" })),
      stylizer: await said(() => window.iso.stylizer("ink", { width: 8, height: 8 })),
      refused: await said(() => window.iso.apply({ style: "cartoom" }, window.photo)),
    };
  }, [...photo()]);
  assert.equal(state.backend, "cpu");
  assert.match(state.reason, /WebGPU/);
  assert.match(state.forced, /WebGPU/);
  assert.match(state.stylizer, /no graphics device/);
  assert.match(state.refused, /^LookError: .*cartoon/);
  for (const style of ["cartoon", "oil_paint", "watercolor", "ink"]) {
    const [out, preset] = [join(folder, `${style}.png`), join(folder, `${style}.json`)];
    await writeFile(preset, JSON.stringify({ style, parameters: {} }));
    await run(built("ISOPHOTE_HOST"), ["apply", preset, picture, out, "--backend", "cpu"]);
    const [most, beyond, parts] = await page.evaluate(async ([name, bytes]) => {
      const bitmap = await createImageBitmap(new Blob([Uint8Array.from(bytes)], { type: "image/png" }), { colorSpaceConversion: "none" });
      const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
      context.drawImage(bitmap, 0, 0);
      const wanted = context.getImageData(0, 0, bitmap.width, bitmap.height).data;
      const shares = [];
      const { data } = await window.iso.apply({ style: name, parameters: {} }, window.photo, { onProgress: (share) => shares.push(share) });
      const differences = data.map((value, at) => Math.abs(value - wanted[at]));
      return [differences.reduce((most, value) => Math.max(most, value), 0), differences.filter((value) => value > 1).length / data.length, shares.length];
    }, [style, [...await readFile(out)]]);
    console.log(`${style}: worst ${most}/255, ${(beyond * 100).toFixed(3)} % beyond 1/255, ${parts} parts`);
    // A comparison that goes the other way on the last bit: WebAssembly multiplies and adds in two steps.
    assert.ok(beyond < 0.0001, `${style}: ${(beyond * 100).toFixed(3)} % of the values differ by more than 1/255`);
  }
  assert.deepEqual(complaints.filter(isOwn), []);
});

test("where a folder's page may start no thread, it says how to serve the folder", async () => {
  const page = await pages.browser.newPage();
  await page.addInitScript(() => { window.Worker = class { constructor() { throw new Error("refused"); } }; });
  await page.goto(pages.address);
  await page.locator(".note.error[data-key='computing']").waitFor();
  assert.match(await message(page, "computing"), /Serve the folder instead: run python3 -m http\.server/);
  await page.waitForFunction(() => document.querySelector("#stage").getAttribute("aria-busy") === "false");
  await page.close();
});

/** Ends the process that drives the graphics devices. */
const crash = async (page) => (await page.context().newCDPSession(page)).send("Browser.crashGpuProcess");

test("a device that is lost and does not come back leaves the work to the processor", { timeout: 300_000 }, async (step) => {
  const own = new Pages();
  const server = await serve({ "/package/": built("ISOPHOTE_PACKAGE") });
  step.after(() => Promise.all([own.close(), server.close()]));
  await own.start();
  const page = await own.open();
  assert.ok(await page.locator("#backend").isHidden());
  await page.evaluate(() => { navigator.gpu.requestAdapter = async () => null; });
  const { page: bare } = await open(own.browser, server.address);
  await bare.evaluate(async () => {
    const { Isophote } = await import("/package/src/index.js");
    window.iso = await Isophote.create();
  });
  await crash(page);
  await page.getByRole("button", { name: "Go on" }).click();
  await page.locator("#backend").waitFor();
  await dropPhoto(page);
  assert.ok(await page.locator("#plain").isVisible());
  const [before, after] = await bare.evaluate(async () => {
    const { iso } = window;
    const found = [iso.backend];
    await iso.device.lost;
    const { width } = await iso.apply("gaussian", new OffscreenCanvas(64, 48).getContext("2d").canvas);
    return [...found, `${iso.backend} ${width} ${iso.reason}`];
  });
  assert.equal(before, "gpu");
  assert.match(after, /^cpu 64 the graphics device was lost/);
});

test("an adapter that gives no device leaves the work to the processor", async () => {
  const server = await serve({ "/package/": built("ISOPHOTE_PACKAGE") });
  const { page } = await open(pages.browser, server.address);
  const [backend, reason] = await page.evaluate(async () => {
    const { Isophote } = await import("/package/src/index.js");
    const adapter = { limits: {}, requestDevice: async () => { throw new Error("the driver is gone"); } };
    const { backend: found, reason: why } = await Isophote.create({ adapter });
    return [found, why];
  });
  assert.deepEqual([backend, reason], ["cpu", "the driver is gone"]);
  await page.close();
  await server.close();
});

/** A picture of 12 megapixels as JPEG, made by the page's own browser. */
const large = (page) => page.evaluate(async () => {
  const canvas = new OffscreenCanvas(4000, 3000);
  const context = canvas.getContext("2d");
  const slope = context.createLinearGradient(0, 0, 4000, 3000);
  slope.addColorStop(0, "#1d3557");
  slope.addColorStop(1, "#f1c27d");
  context.fillStyle = slope;
  context.fillRect(0, 0, 4000, 3000);
  context.fillStyle = "#803020";
  context.fillRect(1200, 900, 1500, 1100);
  const bytes = new Uint8Array(await (await canvas.convertToBlob({ type: "image/jpeg" })).arrayBuffer());
  let text = "";
  bytes.forEach((byte) => { text += String.fromCharCode(byte); });
  return btoa(text);
});

async function saveLarge(step, hasDevice) {
  const own = new Pages();
  step.after(() => own.close());
  await own.start({ hasDevice });
  const page = await own.open("#look=" + encodeURIComponent('{"style":"gaussian","lengths":"pixels"}'));
  const data = Buffer.from(await large(page), "base64");
  await drop(page, [{ name: "large.jpg", type: "image/jpeg", data }]);
  await opened(page, "large.jpg, 4000 × 3000");
  const [download] = await Promise.all([page.waitForEvent("download", { timeout: 500_000 }), page.locator("#save").click()]);
  assert.deepEqual(sizeOf(await readFile(await download.path())), [4000, 3000]);
  assert.equal(await page.locator(".note.error").count(), 0);
  assert.deepEqual(own.complaints.filter(isOwn), []);
}

test("12 megapixels are shown small at once and saved in full by a device", { timeout: 600_000 }, (step) => saveLarge(step, true));

test("12 megapixels are shown small at once and saved in full by the processor", { timeout: 600_000 }, (step) => saveLarge(step, false));
