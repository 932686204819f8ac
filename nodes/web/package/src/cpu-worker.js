// The CPU executor in a thread of its own: a worker that loads the module and computes parts of pictures.
//
// A message is `{wasm, number, request, pixels}`, of which `wasm` comes once; the answer has the same number, and `answer` or
// `error`.

import { Planner } from "./planner.js";

let loading = null;

addEventListener("message", async ({ data: { wasm, number, request, pixels } }) => {
  try {
    loading ??= Planner.load(wasm);
    const { json, bytes } = (await loading).ask(request, pixels);
    postMessage({ number, answer: { json, bytes } }, { transfer: [bytes.buffer] });
  } catch (error) {
    postMessage({ number, error: { name: error.name, message: error.message } });
  }
});
