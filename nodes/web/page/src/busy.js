// Whether the page is at work: for those who see it, and for those who hear it.

import { byId } from "./dom.js";
import { say } from "./notes.js";

/** Milliseconds of work that are not worth a word. */
const SHORT = 1000;

const reasons = new Set(["start"]);
let timer = null;
let isTold = false;

/**
 * Tells that something begins or ends.
 * @param {"start"|"opening"|"computing"|"saving"} reason what it is; each ends by itself
 */
export function busy(reason, isBusy) {
  if (isBusy) {
    reasons.add(reason);
  } else {
    reasons.delete(reason);
  }
  const isAny = reasons.size > 0;
  byId("stage").setAttribute("aria-busy", String(isAny));
  if (isAny) {
    timer ??= setTimeout(() => {
      isTold = true;
      say("Working…");
    }, SHORT);
    return;
  }
  clearTimeout(timer);
  timer = null;
  if (isTold) {
    isTold = false;
    say("Ready");
  }
}
