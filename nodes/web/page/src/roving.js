// One stop of the Tab key for many buttons, between which the arrow keys walk.

export class Roving {
  #box;
  #selector;
  #columns;
  #stop = null;

  /**
   * Takes the buttons of a box.
   * @param {string} selector which they are
   * @param {(button: HTMLElement) => number} columns how many stand beside each other where a button is
   */
  constructor(box, selector, columns) {
    [this.#box, this.#selector, this.#columns] = [box, selector, columns];
    box.addEventListener("keydown", (event) => this.#walk(event));
    box.addEventListener("focusin", ({ target }) => target.matches(selector) && this.stopAt(target));
    this.renew();
  }

  get #shown() {
    return [...this.#box.querySelectorAll(`${this.#selector}:not([hidden])`)];
  }

  /** Makes a button the one that the Tab key comes to. */
  stopAt(button) {
    this.#stop = button;
    this.renew();
  }

  /** Looks anew which are there: the first one is the stop where that of before is not. */
  renew() {
    const shown = this.#shown;
    const stop = shown.includes(this.#stop) ? this.#stop : shown[0];
    for (const button of this.#box.querySelectorAll(this.#selector)) {
      button.tabIndex = button === stop ? 0 : -1;
    }
  }

  #walk(event) {
    const shown = this.#shown;
    const at = shown.indexOf(document.activeElement);
    if (at < 0 || event.ctrlKey || event.metaKey || event.altKey) {
      return;
    }
    const columns = this.#columns(shown[at]);
    const step = {
      ArrowLeft: -1, ArrowRight: 1, ArrowUp: -columns, ArrowDown: columns, Home: -shown.length, End: shown.length,
    }[event.key];
    if (step !== undefined) {
      event.preventDefault();
      shown[Math.min(Math.max(at + step, 0), shown.length - 1)].focus();
    }
  }
}
