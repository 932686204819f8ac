// The planner, which the page holds, and what computes: a graphics device, or the processor.

import { Isophote } from "isophote";
import { byId } from "./dom.js";

/** Bytes that the page holds under an id. */
export function embedded(id) {
  const text = atob(byId(id).textContent);
  return Uint8Array.from(text, (character) => character.charCodeAt(0));
}

/** A module that the page holds. */
async function unpacked(id) {
  const stream = new Blob([embedded(id)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

/** Starts a thread of the processor, whose program the page holds. */
function thread() {
  const url = URL.createObjectURL(new Blob([embedded("isophote-cpu-worker")], { type: "text/javascript" }));
  return new Worker(url);
}

/**
 * Opens a device with all that it can, since renderers of models want more than looks do.
 * @throws {Error} a sentence that says what is missing and what helps
 */
async function device() {
  if (!navigator.gpu) {
    const why = isSecureContext
      ? "This browser has no WebGPU."
      : "Browsers offer WebGPU only to pages that come over https, or from a folder.";
    throw new Error(`${why} Faster are Chrome and Edge from 113, Safari from 26, and Firefox from 141 on Windows`
      + " (145 on macOS). In Chrome on Linux, switch on chrome://flags/#enable-unsafe-webgpu.");
  }
  const adapter = await navigator.gpu.requestAdapter({ powerPreference: "high-performance" });
  if (adapter === null) {
    throw new Error("The browser has WebGPU but finds no graphics card for it. Update the graphics driver,"
      + " and see that hardware acceleration is switched on in the browser's settings (chrome://gpu tells more).");
  }
  const { maxTextureDimension2D, maxBufferSize, maxStorageBufferBindingSize } = adapter.limits;
  const found = await adapter.requestDevice({
    label: "isophote",
    requiredFeatures: [...adapter.features],
    requiredLimits: { maxTextureDimension2D, maxBufferSize, maxStorageBufferBindingSize },
  });
  return { device: found, isSoftware: adapter.info?.isFallbackAdapter ?? false };
}

/**
 * Opens what computes: a graphics device, or the processor where there is none.
 * @param {(message: string) => void} onLost told when the device is lost
 * @param {boolean} isDeviceTried whether a device may compute
 * @returns {Promise<{isophote: Isophote, why: string|null}>} `why` says what is in the way of a device
 */
export async function openEngine(onLost, isDeviceTried = true) {
  const wasm = await unpacked("isophote-wasm");
  let opened;
  try {
    if (!isDeviceTried) {
      throw new Error("The graphics device was lost again and again.");
    }
    opened = await device();
  } catch (error) {
    const cpu = { wasm: () => unpacked("isophote-cpu-wasm"), worker: thread };
    return { isophote: await Isophote.create({ wasm, backend: "cpu", cpu }), why: sentence(error) };
  }
  const isophote = await Isophote.create({ wasm, device: opened.device });
  opened.device.lost.then(({ reason, message }) => {
    if (reason !== "destroyed") {
      onLost(message);
    }
  });
  return { isophote, why: null };
}

/** How precisely pictures are computed while they are worked on. */
export function precision(isophote) {
  return isophote.isSoftware ? "exact" : "half";
}

/** What went wrong, as a sentence with what helps. */
export function sentence(error) {
  const message = String(error?.message ?? error).trim();
  if (/has no memory for|out of memory|allocation/i.test(message)) {
    return "The graphics card has too little memory free. Close other programs and tabs that use it, or open a smaller picture.";
  }
  if (/does not start the thread/.test(message) && location.protocol === "file:") {
    return "The browser lets a page from a folder start no thread to compute in. Serve the folder instead: run python3 -m http.server in it,"
      + " and open http://localhost:8000/ in the browser.";
  }
  // Names of files stay as they are.
  const text = /^\S*\.\w/.test(message) ? message : message.charAt(0).toUpperCase() + message.slice(1);
  return /[.!?]$/.test(text) ? text : `${text}.`;
}
