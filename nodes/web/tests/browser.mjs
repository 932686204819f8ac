// A browser for tests, and a server of files on this machine.

import { createServer } from "node:http";
import { access, readFile } from "node:fs/promises";
import { delimiter, extname, join, normalize } from "node:path";
import { chromium } from "playwright-core";

const NAMES = ["chromium-headless-shell", "chromium", "chromium-browser", "google-chrome"];

/** Neither a graphics card nor a sandbox, and no calls to anywhere. */
const FLAGS = [
  "--no-sandbox",
  "--disable-gpu-sandbox",
  "--disable-dev-shm-usage",
  "--disable-quic",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--no-first-run",
];

const TYPES = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".mjs": "text/javascript",
  ".wasm": "application/wasm",
  ".json": "application/json",
  ".png": "image/png",
};

/** What the chore that runs the tests has built. */
export function built(name) {
  const value = process.env[name];
  if (value === undefined) {
    throw new Error(`${name} is not set: run the tests by \`cargo xtask test web\``);
  }
  return value;
}

async function program() {
  if (process.env.ISOPHOTE_CHROMIUM) {
    return process.env.ISOPHOTE_CHROMIUM;
  }
  for (const folder of (process.env.PATH ?? "").split(delimiter)) {
    for (const name of NAMES) {
      const file = join(folder, name);
      if (await access(file).then(() => true, () => false)) {
        return file;
      }
    }
  }
  throw new Error(`none of ${NAMES.join(", ")} is installed`);
}

/** What lets pages use a graphics device. */
const DEVICE = [
  "--enable-unsafe-webgpu",
  "--use-webgpu-adapter=swiftshader",
  // Canvases are shown by the same software driver.
  "--enable-features=Vulkan",
  "--use-vulkan=swiftshader",
  "--use-angle=vulkan",
];

/**
 * Starts a browser without a window.
 * @param {{hasDevice?: boolean}} options whether pages have a graphics device
 */
export async function launch({ hasDevice = true } = {}) {
  const args = [...FLAGS, ...(hasDevice ? DEVICE : ["--disable-gpu", "--disable-features=WebGPU"])];
  return chromium.launch({ executablePath: await program(), args });
}

/**
 * A page that fails the test by what it says on its console.
 * @returns {{page, complaints: string[]}}
 */
export async function open(browser, address, options = {}) {
  const page = await browser.newPage(options);
  const complaints = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) {
      complaints.push(message.text());
    }
  });
  page.on("pageerror", (error) => complaints.push(error.message));
  await page.goto(address);
  return { page, complaints };
}

/** Serves folders by the paths they are mounted at, until it is closed. */
export async function serve(folders) {
  const server = createServer(async (request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, "http://localhost").pathname));
    if (path === "/" || path === "/favicon.ico") {
      response.setHeader("content-type", "text/html");
      response.end("<!doctype html><title>test</title>");
      return;
    }
    const mounts = Object.keys(folders).filter((prefix) => path.startsWith(prefix));
    const mount = mounts.sort((a, b) => b.length - a.length)[0];
    try {
      const body = await readFile(join(folders[mount], path.slice(mount.length)));
      response.setHeader("content-type", TYPES[extname(path)] ?? "application/octet-stream");
      response.end(body);
    } catch {
      response.statusCode = 404;
      response.end();
    }
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const close = () => new Promise((resolve) => server.close(resolve));
  return { address: `http://127.0.0.1:${server.address().port}`, close };
}
