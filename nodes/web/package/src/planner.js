// The planner: a module of WebAssembly that says what a look comes to on a graphics device. It runs nothing; the second module,
// which `cpu-worker.js` loads, computes as well and is asked in the same way.
//
// A call is JSON. An answer is JSON and bytes: the length of the JSON in four bytes, the JSON, the bytes.

const encoder = new TextEncoder();
const decoder = new TextDecoder();

/** A request that the planner refuses: an unknown name, a value out of range, an open input. */
export class LookError extends Error {
  name = "LookError";
}

/** The bytes of a module that is a response or an address; others are what they are. */
export async function bytesOf(source) {
  let wasm = await source;
  if (typeof wasm === "string" || wasm instanceof URL) {
    wasm = await fetch(wasm);
  }
  if (typeof Response !== "undefined" && wasm instanceof Response) {
    if (!wasm.ok) {
      throw new Error(`the module of WebAssembly is not at ${wasm.url}: ${wasm.status} ${wasm.statusText}`);
    }
    // Not streamed, since many servers do not know the type of the file.
    wasm = await wasm.arrayBuffer();
  }
  return wasm;
}

export class Planner {
  #exports;

  /** Takes an instance of the module; see {@link Planner.load}. */
  constructor(instance) {
    this.#exports = instance.exports;
  }

  /**
   * Loads the module.
   * @param source its bytes, a compiled module, a response, or where it is
   */
  static async load(source) {
    const wasm = await bytesOf(source);
    if (wasm instanceof WebAssembly.Module) {
      return new Planner(await WebAssembly.instantiate(wasm));
    }
    return new Planner((await WebAssembly.instantiate(wasm)).instance);
  }

  /**
   * Asks, and throws a {@link LookError} where the answer is one.
   * @param {Uint8Array} [pixels] what the request is about
   * @returns {{json: object, bytes: Uint8Array}}
   */
  ask(request, pixels) {
    const wasm = this.#exports;
    if (pixels !== undefined) {
      const place = wasm.isophote_pixels(pixels.length);
      new Uint8Array(wasm.memory.buffer, place, pixels.length).set(pixels);
    }
    const text = encoder.encode(JSON.stringify(request));
    const at = wasm.isophote_request(text.length);
    new Uint8Array(wasm.memory.buffer, at, text.length).set(text);
    const length = wasm.isophote_answer();
    // The memory may have grown, and then is another buffer.
    const answer = new Uint8Array(wasm.memory.buffer, wasm.isophote_answer_at(), length);
    const end = 4 + new DataView(answer.buffer, answer.byteOffset).getUint32(0, true);
    const json = JSON.parse(decoder.decode(answer.subarray(4, end)));
    if (json.error !== undefined) {
      throw new LookError(json.error);
    }
    return { json, bytes: answer.slice(end) };
  }
}
