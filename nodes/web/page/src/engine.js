// The planner, which the page holds, and the graphics device.

import { Isophote } from "isophote";
import { byId } from "./dom.js";

/** Bytes that the page holds under an id. */
export function embedded(id) {
  const text = atob(byId(id).textContent);
  return Uint8Array.from(text, (character) => character.charCodeAt(0));
}

/** The planner's module. */
async function planner() {
  const stream = new Blob([embedded("isophote-wasm")]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
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
    throw new Error(`${why} Open the page in Chrome or Edge 113 or later, Safari 26 or later, or Firefox 141 or later on Windows`
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
 * Opens what computes.
 * @param {(message: string) => void} onLost told when the device is lost
 * @returns {Promise<Isophote>}
 */
export async function openEngine(onLost) {
  const [wasm, opened] = await Promise.all([planner(), device()]);
  const isophote = await Isophote.create({ wasm, device: opened.device });
  opened.device.lost.then(({ reason, message }) => {
    if (reason !== "destroyed") {
      onLost(message);
    }
  });
  return isophote;
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
  // Names of files stay as they are.
  const text = /^\S*\.\w/.test(message) ? message : message.charAt(0).toUpperCase() + message.slice(1);
  return /[.!?]$/.test(text) ? text : `${text}.`;
}
