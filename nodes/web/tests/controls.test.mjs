// The page for those who use keys, and for those who change their mind: Tab stops, steps back, names, links, work that is told.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { after, before, test } from "node:test";
import { Pages, addressSays, drop, lookOfSettled, message, settled } from "./pages.mjs";

const pages = new Pages();

before(() => pages.start());

after(() => pages.close());

/** Where the focus is, as people name it. */
const focused = (page) => page.evaluate(() => {
  const at = document.activeElement;
  const area = at.closest("#cards, #styles, #controls, #top, #out, .bar")?.id ?? "";
  return at.id !== "" && !at.id.startsWith("control-") ? at.id : area;
});

/** What the Tab key comes to, one place after the other; several stops of one place in a row count once. */
async function stops(page) {
  const found = [];
  await page.evaluate(() => document.activeElement.blur());
  for (let press = 0; press < 150; press += 1) {
    await page.keyboard.press("Tab");
    const place = await focused(page);
    if (place === found[0] && found.length > 3) {
      break;
    }
    found.push(place);
    if (place === "zoom-in") {
      break;
    }
  }
  return found;
}

test("the Tab key comes to the controls first, and once to the cards, in their order", async () => {
  const page = await pages.open();
  const all = await stops(page);
  const once = all.filter((place, at) => place !== all[at - 1] && place !== "");
  const wanted = ["open", "samples", "search", "styles", "cards", "controls", "save", "preset", "link", "canvas", "compare", "original"];
  assert.deepEqual(once.filter((place) => wanted.includes(place)), wanted, `${once}`);
  assert.equal(all.filter((place) => place === "cards").length, 1, `${all}`);
  // The stop is the chosen look; arrows go on from there.
  await page.locator("#search").focus();
  await page.keyboard.press("Tab");
  await page.keyboard.press("Tab");
  const card = () => page.evaluate(() => document.activeElement.dataset.look);
  assert.equal(await card(), "saturday_comic");
  await page.keyboard.press("ArrowRight");
  assert.equal(await card(), "clear_line");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => document.querySelector("#look-name").textContent === "Clear line");
  await page.keyboard.press("Shift+Tab");
  await page.keyboard.press("Tab");
  assert.equal(await card(), "clear_line", "the cards forget where the focus was");

  const [, list] = (await readFile(new URL("../../library/looks/order.txt", import.meta.url), "utf8")).match(/\{([^}]*)\}/);
  const looks = list.trim().split(/\s+/);
  const cards = await page.locator(".card").evaluateAll((found) => found.map(({ dataset }) => dataset.look));
  assert.deepEqual(cards.slice(0, looks.length), looks);
  const styles = [...new Set(await Promise.all(looks.map(async (id) => {
    const file = await readFile(new URL(`../../library/looks/${id}.json`, import.meta.url), "utf8");
    return JSON.parse(file).style;
  })))].filter((style) => typeof style === "string");
  // What a style draws with has a card behind the style's, so that not all cards between are styles.
  const plain = styles.map((style) => `style-${style}`);
  assert.deepEqual(cards.slice(looks.length).filter((card) => plain.includes(card)), plain);
  await page.close();
});

/** How often one can go back. */
async function stepsBack(page) {
  let count = 0;
  while (await page.locator("#undo").isEnabled()) {
    await page.locator("#undo").click();
    count += 1;
  }
  return count;
}

test("a drag is one step, however slow, and so are presses of a key in a row", async () => {
  const page = await pages.open("#look=" + encodeURIComponent('{"style":"cartoon","parameters":{"line_width":3}}'));
  const slider = page.getByLabel("Line width", { exact: true });
  const box = await slider.boundingBox();
  await page.mouse.move(box.x + box.width * 0.2, box.y + box.height / 2);
  await page.mouse.down();
  for (const share of [0.3, 0.5, 0.6]) {
    await page.mouse.move(box.x + box.width * share, box.y + box.height / 2);
    // Longer than presses of a key belong together.
    await page.waitForTimeout(1400);
  }
  await page.mouse.up();
  assert.equal(await stepsBack(page), 1, "a drag");
  await lookOfSettled(page, ({ parameters }) => parameters.line_width === 3);

  await slider.focus();
  for (let press = 0; press < 5; press += 1) {
    await page.keyboard.press("ArrowRight");
  }
  assert.equal(await stepsBack(page), 1, "five presses of an arrow key");
  await slider.focus();
  await page.keyboard.press("ArrowRight");
  await page.waitForTimeout(1500);
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Control+z");
  assert.ok(await page.locator("#undo").isEnabled(), "two presses with a pause are one step");
  await page.keyboard.press("Control+z");
  assert.ok(await page.locator("#undo").isDisabled(), "two presses with a pause are more than two steps");
  await page.keyboard.press("Control+Shift+z");
  assert.ok(await page.locator("#undo").isEnabled(), "redo by keys");
  await page.close();
});

test("a dropped preset keeps its name, also after changes and when it is saved", async () => {
  const page = await pages.open();
  const preset = { name: "Grandma's Garden", about: "As she would have it.", style: "ink", parameters: { line_width: 3 } };
  await drop(page, [{ name: "g.json", data: JSON.stringify(preset) }]);
  await addressSays(page, '"style":"ink"');
  const name = page.locator("#look-name");
  assert.equal(await name.innerText(), "Grandma's Garden");
  assert.equal(await page.locator("#look-about").innerText(), "As she would have it.");
  await page.locator("#controls select").first().selectOption({ index: 1 });
  assert.equal(await name.innerText(), "Grandma's Garden");
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save preset" }).click()]);
  assert.equal(download.suggestedFilename(), "grandma_s_garden.json");
  const saved = JSON.parse(await readFile(await download.path(), "utf8"));
  assert.equal(saved.name, "Grandma's Garden");
  await page.locator('[data-look="clear_line"]').click();
  assert.equal(await name.innerText(), "Clear line");
  await page.locator("#undo").click();
  assert.equal(await name.innerText(), "Grandma's Garden");
  await drop(page, [{ name: "nameless look.json", data: JSON.stringify({ style: "watercolor" }) }]);
  await addressSays(page, '"style":"watercolor"');
  assert.equal(await name.innerText(), "nameless look");
  await page.close();
});

test("a link to a page from a folder is warned of", async () => {
  const page = await pages.open();
  await page.locator("#link").click();
  assert.match(await message(page, "link-copied"), /others cannot open it.*Save preset/);
  await page.close();
});

test("the page says that it is busy from the beginning of work to its end, also where it fails", async () => {
  const page = await pages.open();
  await page.evaluate(() => {
    window.told = [];
    const stage = document.querySelector("#stage");
    new MutationObserver(() => window.told.push(stage.getAttribute("aria-busy"))).observe(stage, { attributeFilter: ["aria-busy"] });
  });
  const busy = () => page.locator("#stage").getAttribute("aria-busy");
  const told = () => page.evaluate(() => window.told.splice(0));
  await drop(page, [{ name: "broken.png", type: "image/png", data: "no picture at all" }]);
  await page.getByText("broken.png is no picture").waitFor();
  await page.waitForFunction(() => document.querySelector("#stage").getAttribute("aria-busy") === "false");
  assert.deepEqual([(await told())[0], await busy()], ["true", "false"], "a file that fails");
  const [download] = await Promise.all([page.waitForEvent("download"), page.locator("#save").click()]);
  await download.path();
  await settled(page);
  assert.deepEqual([(await told())[0], await busy()], ["true", "false"], "saving");
  assert.equal(await page.locator("#live").getAttribute("aria-live"), "polite");
  await page.close();
});
