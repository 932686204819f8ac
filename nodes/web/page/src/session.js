// The look that is worked on, and the steps that led to it.

import { bare, isSame } from "./look.js";

/** Steps that can be undone. */
const MOST = 200;

/** Milliseconds within which changes of one control are one step: presses of a key, one after the other. */
const PAUSE = 1200;

/**
 * Fires `look` when the look changes; its detail says what led to it: `choose`, `edit`, `undo` or `address`.
 */
export class Session extends EventTarget {
  #steps = [];
  #at = -1;
  #lastKey = null;
  #lastTime = 0;
  #isHeld = false;

  /** The look now. */
  get look() {
    return this.#steps[this.#at].look;
  }

  /** The look that was chosen, to which a reset goes back. */
  get chosen() {
    return this.#steps[this.#at].chosen;
  }

  /** What the person called the look that was chosen, and says of it: `{name, about}`, or nothing. */
  get title() {
    return this.#steps[this.#at].title;
  }

  get canUndo() {
    return this.#at > 0;
  }

  get canRedo() {
    return this.#at + 1 < this.#steps.length;
  }

  /**
   * Takes a look of the browser, a file or a link.
   * @param {{why?: string, chosen?: object, title?: object}} more `chosen`: the look that it was made of, if it is another;
   *   `title`: what it is called, if it is none of ours
   */
  choose(look, { why = "choose", chosen = look, title = null } = {}) {
    this.#put({ look: bare(look), chosen: bare(chosen), title }, null, why);
  }

  /**
   * Changes the look.
   * @param {string} key what is changed: changes of the same thing in a row are one step
   */
  edit(look, key) {
    if (!isSame(look, this.look)) {
      this.#put({ look, chosen: this.chosen, title: this.title }, key, "edit");
    }
  }

  /** Begins a row of changes that lasts until it is ended, however slowly they come: something is dragged. */
  hold() {
    this.settle();
    this.#isHeld = true;
  }

  /** Ends a row of changes: the next one is a step of its own. */
  settle() {
    [this.#lastKey, this.#isHeld] = [null, false];
  }

  undo() {
    this.#go(-1);
  }

  redo() {
    this.#go(1);
  }

  #go(by) {
    if (this.#steps[this.#at + by] !== undefined) {
      this.#at += by;
      this.settle();
      this.#tell("undo");
    }
  }

  #put(step, key, why) {
    const now = performance.now();
    const isRow = key !== null && key === this.#lastKey && (this.#isHeld || now - this.#lastTime < PAUSE);
    this.#steps.length = isRow ? this.#at : this.#at + 1;
    this.#steps.push(step);
    this.#steps.splice(0, this.#steps.length - MOST);
    this.#at = this.#steps.length - 1;
    [this.#lastKey, this.#lastTime] = [key, now];
    this.#tell(why);
  }

  #tell(why) {
    this.dispatchEvent(new CustomEvent("look", { detail: why }));
  }
}
