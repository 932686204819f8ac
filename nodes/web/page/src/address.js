// The look in the page's address: `#look=` and the preset.

import { bare, fromFile } from "./look.js";

/** Milliseconds between changes of the address: browsers refuse more than a hundred in thirty seconds. */
const PACE = 400;

/** The end of the address that opens a look. */
export function fragment(look) {
  const text = encodeURIComponent(JSON.stringify(bare(look)));
  // These need no escape after `#` and are read more easily.
  return `#look=${text.replaceAll("%3A", ":").replaceAll("%2C", ",")}`;
}

/**
 * The look that an address names; `null` where it names none.
 * @throws {Error} what is wrong with it
 */
export function read(hash) {
  const text = /^#look=(.*)$/s.exec(hash)?.[1];
  if (text === undefined || text === "") {
    return null;
  }
  let json;
  try {
    json = JSON.parse(decode(text));
  } catch {
    throw new Error("The link holds no look: it seems to be cut off or changed. Copy the whole link, up to its last character.");
  }
  try {
    return fromFile(json);
  } catch (error) {
    throw new Error(`The link holds no look: ${error.message}. Ask for the link again, or open the preset as a file.`);
  }
}

/** Text without its escapes; links that people write have none. */
function decode(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** The look that was chosen before it was changed, as the browser's history keeps it beside the address. */
export const chosen = () => history.state?.chosen;

/** What that look is called, if it is none of ours. */
export const title = () => history.state?.title ?? null;

/** Keeps the address up to date with the look. */
export class Address {
  #wanted = null;
  #state = {};
  #timer = null;
  #last = 0;

  /** @param {(hash: string) => void} onChange told when the person goes back or forward, or pastes a link */
  constructor(onChange) {
    // Both events come for some changes; the second finds nothing new.
    let known = location.hash;
    const changed = () => {
      if (location.hash !== known && location.hash !== this.#wanted) {
        known = location.hash;
        this.#cancel();
        onChange(location.hash);
      }
    };
    this.remember = (hash) => { known = hash; };
    addEventListener("hashchange", changed);
    addEventListener("popstate", changed);
  }

  /**
   * Shows a look in the address.
   * @param {{chosen: object, title: object|null}} state the look that it was made of, and what that is called
   * @param {boolean} isStep whether going back returns to what is shown now
   */
  show(look, state, isStep) {
    const hash = fragment(look);
    if (isStep) {
      this.flush();
      this.#state = state;
      if (hash !== location.hash) {
        this.#write(hash, "pushState");
      }
      return;
    }
    [this.#wanted, this.#state] = [hash, state];
    const wait = Math.max(0, this.#last + PACE - performance.now());
    this.#timer ??= setTimeout(() => this.flush(), wait);
  }

  /** Writes at once what waits. */
  flush() {
    const hash = this.#wanted;
    this.#cancel();
    if (hash !== null && hash !== location.hash) {
      this.#write(hash, "replaceState");
    }
  }

  #write(hash, how) {
    this.#last = performance.now();
    try {
      history[how](this.#state, "", hash);
    } catch {
      // Too many in a short time: the next change writes it.
    }
    this.remember(location.hash);
  }

  #cancel() {
    clearTimeout(this.#timer);
    [this.#timer, this.#wanted] = [null, null];
  }
}
