// The browser page as tests use it: opened from its file, with what went wrong on it.

import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { built, launch } from "./browser.mjs";
import { photo } from "./made.mjs";

/** Milliseconds that a step may take: the device of these tests is a processor. */
const PATIENCE = 120_000;

/** A browser whose pages are the page. */
export class Pages {
  /** What went wrong on any page, and what any page asked the network for. */
  complaints = [];
  requests = [];

  /** @param {{hasDevice?: boolean}} options whether there is a graphics device */
  async start(options) {
    this.address = pathToFileURL(resolve(built("ISOPHOTE_PAGE"))).href;
    this.browser = await launch(options);
  }

  close() {
    return this.browser?.close();
  }

  /**
   * Opens the page and waits until its first picture is shown.
   * @param {{hasThumbnails?: boolean}} options whether looks get thumbnails, which take this device most of its time; and those of
   * a browser's page
   */
  async open(hash = "", { hasThumbnails = false, ...options } = {}) {
    const page = await this.browser.newPage({ viewport: { width: 800, height: 420 }, acceptDownloads: true, ...options });
    if (!hasThumbnails) {
      await page.addInitScript(() => {
        // Nothing comes in sight, where thumbnails are made.
        window.IntersectionObserver = class { observe() {} unobserve() {} disconnect() {} };
      });
    }
    page.setDefaultTimeout(PATIENCE);
    page.on("console", (message) => ["error", "warning"].includes(message.type()) && this.complaints.push(message.text()));
    page.on("pageerror", (error) => this.complaints.push(error.message));
    page.on("request", (request) => /^(https?|wss?|ftp):/.test(request.url()) && this.requests.push(request.url()));
    await page.goto(this.address + hash);
    await opened(page, "A fountain");
    return page;
  }
}

/** Waits until something is open and shown; fails at once with what the page tells instead. */
export async function opened(page, name) {
  await page.waitForFunction((start) => {
    const fault = document.querySelector(".note.error[data-key='start'], .note.error[data-key='computing'], .note.error[data-key='fault']");
    if (fault !== null) {
      throw new Error(`the page says: ${fault.textContent}`);
    }
    return document.querySelector("#info").textContent.startsWith(start);
  }, name);
  await settled(page);
}

/** Waits until the newest look is shown. */
export async function settled(page) {
  await page.waitForFunction(() => {
    const fault = document.querySelector(".note.error[data-key='computing'], .note.error[data-key='fault']");
    if (fault !== null) {
      throw new Error(`the page says: ${fault.textContent}`);
    }
    return document.querySelector("#stage").getAttribute("aria-busy") === "false";
  });
  // Browsers show a frame after they are given it.
  await page.evaluate(() => new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(done)); }));
}

/** Drops files on the picture. */
export function drop(page, files) {
  const entries = files.map(({ name, type = "", data }) => ({ name, type, data: Buffer.from(data).toString("base64") }));
  return page.evaluate((given) => {
    const transfer = new DataTransfer();
    for (const { name, type, data } of given) {
      transfer.items.add(new File([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], name, { type }));
    }
    for (const kind of ["dragenter", "dragover", "drop"]) {
      const event = new DragEvent(kind, { dataTransfer: transfer, bubbles: true, cancelable: true });
      document.querySelector("#canvas").dispatchEvent(event);
    }
  }, entries);
}

/** Drops a small photo and waits until it is shown. */
export async function dropPhoto(page) {
  await drop(page, [{ name: "hill.png", type: "image/png", data: photo() }]);
  await opened(page, "hill.png");
}

/** What the stage shows, as the bytes of a PNG, which are the same for the same pixels. */
export async function shot(page) {
  const clip = await page.locator("#canvas").boundingBox();
  return page.screenshot({ clip });
}

/** The message of a kind, once it is there. */
export async function message(page, key) {
  return page.locator(`.note[data-key="${key}"]`).innerText();
}

/** The look in the address. */
export const lookOf = (page) => page.evaluate(() => JSON.parse(decodeURIComponent(location.hash.slice("#look=".length))));

/** The look in the address, once it is as wanted. */
export async function lookOfSettled(page, isWanted) {
  for (let round = 0; round < 40; round += 1) {
    const look = await lookOf(page);
    if (isWanted(look)) {
      return look;
    }
    await new Promise((done) => { setTimeout(done, 100); });
  }
  throw new Error(`the address keeps ${JSON.stringify(await lookOf(page))}`);
}

/** Waits until the address says what it should. */
export const addressSays = (page, text) => page.waitForFunction((part) => decodeURIComponent(location.hash).includes(part), text);
