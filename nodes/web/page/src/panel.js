// The sliders of a look, made of the catalogue.

import { control } from "./controls.js";
import { byId, make } from "./dom.js";
import { controls, isEqual, isKeyed, withValue } from "./look.js";

/** What groups are called, and whether they begin folded. */
const GROUPS = {
  look: ["Look", false],
  "": ["Settings", false],
  output: ["Output", false],
  advanced: ["Advanced", true],
  time: ["Time", true],
};

/** Parameters that count only where a scene gives guides. */
const GUIDED = new Set(["outline_width", "border_width", "crease_width", "line_colors", "outline_color", "border_color", "crease_color", "line_gap", "guide_weight", "cover"]);

export class Panel {
  #catalogue;
  #session;
  #rows = [];
  #key = null;
  #folds = new Map();

  /** Shows the look of a session and changes it. */
  constructor(catalogue, session) {
    [this.#catalogue, this.#session] = [catalogue, session];
  }

  /**
   * Shows the look.
   * @param {boolean} hasGuides whether what is open has normals and depth
   */
  show(look, hasGuides) {
    const key = `${JSON.stringify(look.style)} ${hasGuides}`;
    if (key !== this.#key) {
      this.#key = key;
      this.#build(look, hasGuides);
    }
    for (const { entry, set, element } of this.#rows) {
      const given = look.parameters[entry.name];
      const value = given === undefined ? entry.standard : given;
      element.classList.toggle("keyed", isKeyed(value));
      element.classList.toggle("changed", !isEqual(value, entry.standard));
      // What is dragged now shows what the person sets.
      if (!isKeyed(value) && !element.contains(document.activeElement) || this.#isForced) {
        set(isKeyed(value) ? entry.standard : value);
      }
    }
    this.#isForced = false;
  }

  #isForced = false;

  /** Shows values even where the person has just set others: after an undo. */
  force() {
    this.#isForced = true;
  }

  #build(look, hasGuides) {
    const entries = controls(this.#catalogue, look).filter(({ param }) => hasGuides || !GUIDED.has(param.id));
    const headings = [...new Set(entries.map(({ heading }) => heading))];
    const order = Object.keys(GROUPS);
    const rank = (heading) => (order.includes(heading) ? order.indexOf(heading) : -1);
    headings.sort((a, b) => rank(a) - rank(b));
    this.#rows = [];
    byId("controls").replaceChildren(...headings.filter((heading) => heading !== "time" || hasGuides).map((heading) => {
      const [name, isFolded] = GROUPS[heading] ?? [heading, false];
      const rows = entries.filter((entry) => entry.heading === heading).map((entry) => this.#row(entry));
      return this.#group(heading, name, isFolded, rows);
    }));
    byId("controls").scrollTop = 0;
  }

  #group(heading, name, isFolded, rows) {
    const open = this.#folds.get(heading) ?? !isFolded;
    return make("details", { open, ontoggle: (event) => this.#folds.set(heading, event.target.open) },
      make("summary", {}, name), ...rows);
  }

  #row(entry) {
    const session = this.#session;
    const made = control(
      entry,
      (value) => session.edit(withValue(session.look, entry, value), entry.name),
      { hold: () => session.hold(), settle: () => session.settle() },
    );
    this.#rows.push({ entry, ...made });
    return made.element;
  }
}
