// The browser page, from its file. ISOPHOTE_PAGE is the file; `browser.mjs` says which browser.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { animated, glb, photo, sizeOf, tetrahedron } from "./made.mjs";
import { Pages, addressSays, drop, dropPhoto, lookOf, lookOfSettled, message, opened, settled, shot } from "./pages.mjs";

const pages = new Pages();
const { complaints, requests } = pages;
const open = (hash, options) => pages.open(hash, options);

before(() => pages.start());

after(() => pages.close());

/** Sets a slider as a person does, and waits for the picture. */
async function slide(page, label, value) {
  await page.getByLabel(label, { exact: true }).evaluate((slider, to) => {
    slider.value = to;
    slider.dispatchEvent(new Event("input", { bubbles: true }));
    slider.dispatchEvent(new Event("change", { bubbles: true }));
  }, value);
  await settled(page);
}

test("a dropped photo, thumbnails, a look, a slider, undo, and the same pixels from the link", async () => {
  const page = await open("", { hasThumbnails: true });
  await dropPhoto(page);
  await page.waitForFunction(() => document.querySelectorAll(".card.made").length >= 4);
  const first = await shot(page);
  await page.locator('[data-look="clear_line"]').click();
  await settled(page);
  const chosen = await shot(page);
  assert.notDeepEqual(chosen, first, "another look shows the same pixels");
  assert.equal((await lookOf(page)).style, "cartoon");

  await slide(page, "Line width", 8);
  await addressSays(page, '"line_width":8');
  const wide = await shot(page);
  assert.notDeepEqual(wide, chosen, "a slider changes nothing");
  await page.keyboard.press("Control+z");
  await settled(page);
  assert.deepEqual(await shot(page), chosen, "undo does not bring the pixels back");
  await page.keyboard.press("Control+Shift+z");
  await settled(page);
  assert.deepEqual(await shot(page), wide, "redo does not bring the pixels back");

  await addressSays(page, '"line_width":8');
  await page.reload();
  await opened(page, "A fountain");
  assert.equal((await lookOf(page)).parameters.line_width, 8);
  await dropPhoto(page);
  assert.deepEqual(await shot(page), wide, "the link gives other pixels");
  await page.close();
});

test("the edge, the key for the original, defaults and going back", async () => {
  const page = await open();
  await dropPhoto(page);
  const look = await shot(page);
  await page.keyboard.down("o");
  await settled(page);
  const original = await shot(page);
  assert.notDeepEqual(original, look, "holding O shows no original");
  await page.keyboard.up("o");
  await settled(page);
  assert.deepEqual(await shot(page), look, "letting go of O does not end it");

  await page.keyboard.press("w");
  const edge = page.getByRole("slider", { name: "Edge between the original and the look" });
  const from = await edge.boundingBox();
  await page.mouse.move(from.x + from.width / 2, from.y + from.height / 2);
  await page.mouse.down();
  await page.mouse.move(from.x + from.width / 2 + 90, from.y + from.height / 2, { steps: 4 });
  await page.mouse.up();
  const to = await edge.boundingBox();
  assert.ok(Math.abs(to.x - from.x - 90) < 3, `the edge moved by ${to.x - from.x} pixels, not 90`);
  await page.keyboard.press("w");

  await slide(page, "Saturation", 0);
  await addressSays(page, '"saturation":0');
  await page.locator(".control", { has: page.getByLabel("Saturation", { exact: true }) }).locator("label").dblclick();
  await settled(page);
  assert.equal((await lookOfSettled(page, (given) => !("saturation" in given.parameters))).parameters.saturation, undefined);

  await page.locator('[data-look="style-painting"]').click();
  await addressSays(page, '"style":"painting"');
  await page.goBack();
  await addressSays(page, '"style":"cartoon"');
  await settled(page);
  assert.equal(await page.locator("#look-name").innerText(), "Saturday comic");
  await page.close();
});

test("presets are opened and saved; what is none is told", async () => {
  const page = await open();
  const preset = { name: "Mine", style: "ink", lengths: "relative", parameters: { style: "woodcut", line_width: 3 } };
  preset.objects = [{ match: "cryptomatte:hero", lines: false }];
  await drop(page, [{ name: "mine.json", type: "application/json", data: JSON.stringify(preset) }]);
  await addressSays(page, '"style":"ink"');
  await settled(page);
  assert.deepEqual((await lookOf(page)).parameters, preset.parameters);
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save preset" }).click()]);
  const saved = JSON.parse(readFileSync(await download.path(), "utf8"));
  assert.equal(await page.locator("#look-name").innerText(), "Mine");
  assert.equal(download.suggestedFilename(), "mine.json");
  assert.deepEqual(saved, preset);

  await drop(page, [{ name: "other.json", data: '{"style":"cartoon","parameters":{"line_widht":3}}' }]);
  assert.match(await message(page, "file"), /other\.json is no preset of Isophote: .*line_widht/);
  await drop(page, [{ name: "notes.png", type: "image/png", data: "no picture at all" }]);
  await page.getByText("notes.png is no picture that this browser can read").waitFor();
  assert.equal((await lookOf(page)).style, "ink", "what was refused changed the look");
  await page.close();
});

test("media stand beside the styles under the names of artists", async () => {
  const page = await open();
  const card = page.locator(".card", { hasText: /^Charcoal$/ });
  assert.match(await card.getAttribute("title"), /^Charcoal: \S.*\.$/);
  await card.click();
  await page.waitForFunction(() => document.querySelector("#look-name").textContent === "Charcoal");
  const look = await lookOf(page);
  assert.deepEqual([look.style, look.parameters], ["ink", { style: "charcoal" }]);
  await page.close();
});

test("broken links are told and leave the page usable", async () => {
  const page = await open("#look=%7B%22style%22:%22carto");
  assert.match(await message(page, "link"), /The link holds no look: .*Copy the whole link/);
  await page.evaluate(() => { location.hash = '#look={"style":"cartoonish"}'; });
  await page.getByText("The link's look cannot be shown").waitFor();
  await page.evaluate(() => { location.hash = '#look={"style":"watercolor","parameters":{"wobble":4}}'; });
  await page.waitForFunction(() => document.querySelector("#look-name").textContent === "Watercolour");
  await settled(page);
  assert.equal(await page.locator(".note.error").count(), 0, "the message stays after a good link");
  await page.close();
});

test("models are stylized and turned; a missing buffer is named", async () => {
  const page = await open();
  await drop(page, [{ name: "thing.glb", data: glb() }]);
  await opened(page, "thing.glb");
  const front = await shot(page);
  assert.ok(await hasColor(page, front), "the red model is not seen");
  const box = await page.locator("#canvas").boundingBox();
  await page.mouse.move(box.x + 150, box.y + 150);
  await page.mouse.down();
  await page.mouse.move(box.x + 230, box.y + 150, { steps: 3 });
  await page.mouse.up();
  await settled(page);
  await page.waitForTimeout(500);
  await settled(page);
  assert.notDeepEqual(await shot(page), front, "dragging does not turn the model");
  assert.ok(await page.getByLabel("Outline width", { exact: true }).isVisible(), "sliders of guides are hidden");

  const { json, bin } = tetrahedron();
  json.buffers[0].uri = "thing%20data.bin";
  const document = { name: "thing.gltf", data: JSON.stringify(json) };
  await drop(page, [document]);
  assert.match(await message(page, "file"), /thing\.gltf needs thing%20data\.bin.*Drop them together/);
  await drop(page, [document, { name: "thing data.bin", data: bin }]);
  await opened(page, "thing.gltf");
  assert.equal(await page.locator(".note.error").count(), 0);
  await page.close();
});

test("looks that go by frames do so while a model plays", async () => {
  const page = await open();
  await drop(page, [{ name: "still.glb", data: glb(animated()) }]);
  await page.waitForFunction(() => document.querySelector("#info").textContent.startsWith("still.glb"));
  const button = page.locator("#play");
  // Pictures of the look at two times of the animation, which moves nothing.
  const pictures = async (parameters) => {
    const look = JSON.stringify({ style: "ink", parameters });
    await page.evaluate((text) => { location.hash = `#look=${text}`; }, look);
    await page.waitForFunction(() => document.querySelector("#look-name").textContent === "Ink");
    const found = [];
    for (let at = 0; at < 2; at += 1) {
      if (await button.getAttribute("aria-pressed") === "false") {
        await button.click();
      }
      await page.waitForTimeout(1500);
      await button.click();
      await page.waitForTimeout(500);
      await settled(page);
      found.push(await shot(page));
    }
    return found;
  };
  const [first, second] = await pictures({});
  assert.deepEqual(first, second, "marks change that should last");
  const [before, after] = await pictures({ hold: 1 });
  assert.notDeepEqual(before, after, "marks last that should change");
  const [thin, thick] = await pictures({ line_width: { 0: 1, 400: 20 } });
  assert.notDeepEqual(thin, thick, "a value by frames stays");
  assert.equal(await page.locator(".note.error").count(), 0);
  await page.close();
});

/** Whether a picture has red pixels, as the browser decodes it. */
function hasColor(page, bytes) {
  return page.evaluate(async (text) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))]));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    let red = 0;
    for (let at = 0; at < data.length; at += 4) {
      red += data[at] > 90 && data[at + 1] < 60 && data[at + 2] < 60 ? 1 : 0;
    }
    return red > 500;
  }, bytes.toString("base64"));
}

test("saving gives all pixels", async () => {
  const page = await open("#look=" + encodeURIComponent('{"style":"gaussian"}'));
  await drop(page, [{ name: "wide.png", type: "image/png", data: photo(2700, 20) }]);
  await opened(page, "wide.png, 2700 × 20");
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save PNG" }).click()]);
  assert.equal(download.suggestedFilename(), "wide-gaussian-blur.png");
  assert.deepEqual(sizeOf(readFileSync(await download.path())), [2700, 20]);
  await page.close();
});

test("a lost device is told, and the page goes on with another", async () => {
  const page = await open();
  await dropPhoto(page);
  const look = await shot(page);
  const known = complaints.length;
  const session = await page.context().newCDPSession(page);
  await session.send("Browser.crashGpuProcess");
  assert.match(await message(page, "lost"), /The graphics device was lost/);
  await page.getByRole("button", { name: "Go on" }).click();
  await page.waitForFunction(() => document.querySelector("#stage").getAttribute("aria-busy") === "true");
  await settled(page);
  assert.deepEqual(await shot(page), look, "the new device shows other pixels");
  // The browser itself warns of the device that is gone.
  complaints.splice(known, complaints.length, ...complaints.slice(known).filter((text) => !/external Instance/.test(text)));
  await page.close();
});

test("nothing is asked of the network, and nothing is complained of", () => {
  assert.deepEqual(requests, []);
  assert.deepEqual(complaints, []);
});
