// The CPU executor: a few workers, and what waits for them. Pages need no leave for it, for nothing is shared.

import { LookError } from "./planner.js";

/** Threads, at most: each holds a module and a part of a picture. */
const MOST = 2;

/** Milliseconds without work after which threads end: the memory of a module only grows. */
const IDLE = 20_000;

const noThread = (why) => new Error(`the browser does not start the thread that computes: ${why}`);

/** Computes parts of pictures on the processor while the page goes on. */
export class Processor {
  #wasm;
  #start;
  #workers = [];
  #waiting = [];
  #last = 0;
  #loaded = null;
  #timer = null;

  /**
   * Starts nothing yet.
   * @param {() => Promise<ArrayBuffer>} wasm gives the bytes of the module, and is asked once
   * @param {() => Worker} start starts `cpu-worker.js`
   */
  constructor(wasm, start) {
    this.#wasm = wasm;
    this.#start = start;
    const count = Math.min(MOST, globalThis.navigator?.hardwareConcurrency ?? 1);
    this.#workers = Array.from({ length: count }, () => ({ worker: null, job: null }));
  }

  /**
   * The answer to a request, in the order in which they come.
   * @param {() => Uint8Array} pixels gives the pixels that it is about when its turn comes, so that few are there at once
   * @param {() => boolean} isOver whether nobody waits for it any more, asked before it begins
   * @returns {Promise<{json: object, bytes: Uint8Array}>}
   */
  compute(request, pixels, isOver) {
    return new Promise((resolve, reject) => {
      this.#last += 1;
      this.#waiting.push({ number: this.#last, request, pixels, isOver, resolve, reject });
      this.#next();
    });
  }

  #next() {
    for (const slot of this.#workers.filter(({ job }) => job === null)) {
      this.#waiting.filter(({ isOver }) => isOver()).forEach(({ reject }) => reject(new Error("nobody waits for it")));
      this.#waiting = this.#waiting.filter(({ isOver }) => !isOver());
      const job = this.#waiting.shift();
      if (job === undefined) {
        break;
      }
      slot.job = job;
      this.#give(slot, job).catch((error) => this.#failed(slot, error));
    }
    clearTimeout(this.#timer);
    if (this.#workers.every(({ job }) => job === null)) {
      this.#timer = setTimeout(() => this.#rest(), IDLE);
    }
  }

  /** Ends the threads until there is work again. */
  #rest() {
    for (const slot of this.#workers) {
      slot.worker?.terminate();
      slot.worker = null;
    }
  }

  async #give(slot, { number, request, pixels }) {
    const message = { number, request, pixels: pixels() };
    if (slot.worker === null) {
      slot.worker = this.#started();
      slot.worker.onmessage = ({ data }) => this.#done(slot, data);
      slot.worker.onerror = (event) => {
        event.preventDefault();
        this.#failed(slot, noThread(event.message || "it does not say why"));
      };
      this.#loaded ??= this.#wasm();
      message.wasm = await this.#loaded;
    }
    slot.worker.postMessage(message, [message.pixels.buffer]);
  }

  #started() {
    try {
      return this.#start();
    } catch (error) {
      throw noThread(error.message);
    }
  }

  #done(slot, { number, answer, error }) {
    if (slot.job?.number !== number) {
      return;
    }
    if (answer !== undefined) {
      slot.job.resolve(answer);
    } else if (error.name === "LookError") {
      slot.job.reject(new LookError(error.message));
    } else {
      // A module that was stopped half-way is not asked again.
      this.#failed(slot, new Error(`the processor did not compute the look; there may be too little memory (${error.message})`));
      return;
    }
    slot.job = null;
    this.#next();
  }

  #failed(slot, error) {
    slot.worker?.terminate();
    slot.job?.reject(error);
    [slot.worker, slot.job] = [null, null];
    this.#next();
  }

  /** Ends all threads. */
  destroy() {
    clearTimeout(this.#timer);
    for (const slot of this.#workers) {
      slot.worker?.terminate();
      slot.job?.reject(new Error("the processor was given back"));
      [slot.worker, slot.job] = [null, null];
    }
    this.#waiting.splice(0).forEach(({ reject }) => reject(new Error("the processor was given back")));
  }
}
