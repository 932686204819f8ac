// The looks to choose from, each with a thumbnail of what is open.

import { looks } from "isophote";
import { byId, make } from "./dom.js";
import { isSame } from "./look.js";
import { Roving } from "./roving.js";

/** The styles in the order in which looks are made of them, which is that of the list of looks. */
function styles(catalogue) {
  const order = [...new Set(Object.values(looks).map(({ style }) => style))];
  const rank = ({ id }) => (order.includes(id) ? order.indexOf(id) : order.length);
  return catalogue.nodes.filter(({ group }) => group === "styles").sort((a, b) => rank(a) - rank(b));
}

/** Looks, styles and filters as cards; `{id, name, about, style, look, words}`. */
function entries(catalogue) {
  const shipped = Object.entries(looks).map(([id, look]) => ({
    id,
    section: "Looks",
    name: look.name ?? id,
    about: look.about ?? "",
    style: look.style,
    look,
    words: [look.name, look.about, look.style, ...(look.tags ?? [])].join(" ").toLowerCase(),
  }));
  const plain = ({ id, label, hint, doc }, section) => ({
    id: `style-${id}`,
    section,
    name: label,
    about: hint,
    style: id,
    look: { style: id, lengths: "relative", parameters: {} },
    words: `${label} ${doc} ${section}`.toLowerCase(),
  });
  // What a style draws with is chosen like a style.
  const media = (node) => {
    const param = node.params.find(({ id }) => id === node.medium);
    return (param?.options ?? []).filter(({ id }) => id !== param.default).map(({ id, label, doc }) => ({
      id: `style-${node.id}-${id}`,
      section: "Styles",
      name: label,
      about: doc,
      style: node.id,
      look: { style: node.id, lengths: "relative", parameters: { [param.id]: id } },
      words: `${label} ${doc} ${node.label} styles`.toLowerCase(),
    }));
  };
  const needsColor = ({ inputs, output }) => output.kind === "color" && inputs.every((port) => port.optional || port.id === "color");
  const filters = catalogue.nodes.filter((node) => node.group !== "styles" && node.group !== "time" && needsColor(node));
  return [
    ...shipped,
    ...styles(catalogue).flatMap((node) => [plain(node, "Styles"), ...media(node)]),
    ...filters.map((node) => plain(node, "Filters")),
  ];
}

/** What stands under the headings. */
const ABOUT = {
  Looks: "",
  Styles: "Plain, to begin a look of your own",
  Filters: "What styles are made of",
};

export class Browser {
  #entries;
  #cards = new Map();
  #thumbnails;
  #seen;
  #style = "";
  #visible = new Set();
  #roving;

  /** @param {(entry: object) => void} onChoose told which card is chosen */
  constructor(catalogue, thumbnails, onChoose) {
    this.#thumbnails = thumbnails;
    this.#entries = entries(catalogue);
    this.#seen = new IntersectionObserver((changes) => changes.forEach((change) => this.#see(change)), {
      root: byId("cards"),
      rootMargin: "120px",
    });
    for (const section of Object.keys(ABOUT)) {
      byId("cards").append(this.#section(section, onChoose));
    }
    this.#chips(catalogue);
    byId("search").addEventListener("input", () => this.#filter());
    this.#roving = new Roving(byId("cards"), ".card", (card) => getComputedStyle(card.parentElement).gridTemplateColumns.split(" ").length);
    new Roving(byId("styles"), "button", () => 1);
  }

  #section(section, onChoose) {
    const grid = make("div", { class: "grid" });
    for (const entry of this.#entries.filter((other) => other.section === section)) {
      const canvas = make("canvas", { width: 3, height: 2, "aria-hidden": "true" });
      const card = make("button", {
        class: "card", title: `${entry.name}: ${entry.about}`, "aria-pressed": "false", dataset: { look: entry.id }, onclick: () => onChoose(entry),
      }, canvas, make("span", {}, entry.name));
      this.#cards.set(entry, { card, canvas, state: "none" });
      grid.append(card);
      this.#seen.observe(card);
      card.entry = entry;
    }
    return make("section", { dataset: { section } },
      make("h3", {}, section, make("small", {}, ABOUT[section])), grid);
  }

  #chips(catalogue) {
    for (const { id, label } of [{ id: "", label: "All" }, ...styles(catalogue)]) {
      byId("styles").append(make("button", {
        "aria-pressed": String(id === ""),
        dataset: { style: id },
        onclick: () => {
          this.#style = id;
          for (const chip of byId("styles").children) {
            chip.setAttribute("aria-pressed", String(chip.dataset.style === id));
          }
          this.#filter();
        },
      }, label));
    }
  }

  #filter() {
    const words = byId("search").value.toLowerCase().split(/\s+/).filter(Boolean);
    let found = 0;
    for (const [entry, { card }] of this.#cards) {
      const isShown = (this.#style === "" || entry.style === this.#style) && words.every((word) => entry.words.includes(word));
      card.hidden = !isShown;
      found += isShown ? 1 : 0;
    }
    for (const section of byId("cards").querySelectorAll("section")) {
      section.hidden = section.querySelector(".card:not([hidden])") === null;
    }
    byId("cards").querySelector(".none")?.remove();
    byId("cards").scrollTop = 0;
    if (found === 0) {
      byId("cards").append(make("p", { class: "none faint" }, "No look has these words. Try fewer, or another style."));
    }
    this.#roving.renew();
  }

  #see({ target, isIntersecting }) {
    const { entry } = target;
    if (isIntersecting) {
      this.#visible.add(entry);
      this.#ask(entry);
    } else {
      this.#visible.delete(entry);
      this.#thumbnails.forget(entry);
      const card = this.#cards.get(entry);
      card.state = card.state === "waiting" ? "none" : card.state;
    }
  }

  #ask(entry) {
    const slot = this.#cards.get(entry);
    if (slot.state !== "none") {
      return;
    }
    slot.state = "waiting";
    this.#thumbnails.want(entry, entry.look, (image, error) => {
      slot.state = "done";
      slot.card.classList.toggle("failed", image === null);
      if (image === null) {
        slot.card.title = `${entry.name}: ${entry.about} There is no thumbnail: ${error.message}`;
        return;
      }
      [slot.canvas.width, slot.canvas.height] = [image.width, image.height];
      slot.canvas.getContext("2d").putImageData(image, 0, 0);
      slot.card.classList.add("made");
    });
  }

  /** Makes all thumbnails anew, those in sight first; the old ones stay until then. */
  renew() {
    for (const slot of this.#cards.values()) {
      slot.state = "none";
      slot.card.classList.remove("made");
    }
    this.#visible.forEach((entry) => this.#ask(entry));
  }

  /** Marks the card whose look it is. */
  mark(look) {
    for (const [entry, { card }] of this.#cards) {
      const isChosen = isSame(entry.look, look);
      card.setAttribute("aria-pressed", String(isChosen));
      if (isChosen) {
        this.#roving.stopAt(card);
      }
    }
  }

  /** The card whose look it is, if it is one. */
  find(look) {
    return this.#entries.find((entry) => isSame(entry.look, look));
  }

  /** An entry by its id. */
  entry(id) {
    return this.#entries.find((entry) => entry.id === id);
  }
}
