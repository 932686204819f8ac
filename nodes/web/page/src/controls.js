// One control for each kind of parameter. A control is `{element, set(value)}`; what the person changes is told to `onInput`.

import { make } from "./dom.js";
import { hex } from "./look.js";

let last = 0;

/** An id for a label. */
function fresh() {
  last += 1;
  return `control-${last}`;
}

const UNITS = { deg: "°" };

/** How far one press of a key goes: a power of ten near a hundredth of the range. */
function step({ slider: [from, to], type }) {
  return type === "int" ? 1 : 10 ** Math.floor(Math.log10((to - from) / 80));
}

/** A number without digits that nobody set. */
const tidy = (value) => Number(Number(value).toPrecision(6));

/** A slider with a field for the number, which goes as far as the parameter allows. */
function number(param, id, onInput) {
  const [min, max] = param.slider;
  const by = step(param);
  const range = make("input", { type: "range", id, min, max, step: by });
  const field = make("input", {
    type: "number", min: param.range[0], max: param.range[1], step: by, "aria-label": `${param.label}, as a number`, inputMode: "decimal",
  });
  const show = (value) => {
    range.value = value;
    range.style.setProperty("--share", String(Math.min(Math.max((value - min) / (max - min), 0), 1)));
  };
  range.addEventListener("input", () => {
    const value = tidy(range.value);
    field.value = value;
    show(value);
    onInput(value);
  });
  field.addEventListener("input", () => {
    const value = field.valueAsNumber;
    if (Number.isFinite(value) && value >= param.range[0] && value <= param.range[1]) {
      const given = param.type === "int" ? Math.round(value) : value;
      show(given);
      onInput(given);
    }
  });
  const set = (value) => {
    show(value);
    field.value = tidy(value);
  };
  // What is out of range is taken back when the field is left.
  field.addEventListener("change", () => {
    const value = Math.min(Math.max(field.valueAsNumber || 0, param.range[0]), param.range[1]);
    set(param.type === "int" ? Math.round(value) : value);
    onInput(tidy(field.value));
  });
  const unit = param.unit === "" ? null : make("span", { class: "unit" }, UNITS[param.unit] ?? param.unit);
  return { parts: [make("span", { class: "number" }, field, unit), range], set };
}

/** A switch. */
function bool(param, id, onInput) {
  const box = make("input", { type: "checkbox", id, role: "switch" });
  box.addEventListener("change", () => onInput(box.checked));
  return { parts: [box], set: (value) => { box.checked = value; } };
}

/** A list of options. */
function choice(param, id, onInput) {
  const options = param.options.map((option) => make("option", { value: option.id, title: option.doc }, option.label));
  const list = make("select", { id }, ...options);
  const explain = () => { list.title = param.options.find((option) => option.id === list.value)?.doc ?? ""; };
  list.addEventListener("change", () => {
    explain();
    onInput(list.value);
  });
  return {
    parts: [list],
    set: (value) => {
      list.value = value;
      explain();
    },
  };
}

/** A colour, and how opaque it is. */
function color(param, id, onInput) {
  const field = make("input", { type: "color", id });
  const alpha = make("input", { type: "range", min: 0, max: 1, step: 0.01, "aria-label": `${param.label}, opacity`, title: "Opacity" });
  const tell = () => {
    const opacity = Number(alpha.value);
    alpha.style.setProperty("--share", String(opacity));
    const rgb = [1, 3, 5].map((at) => parseInt(field.value.slice(at, at + 2), 16) / 255);
    onInput(hex([...rgb, opacity]));
  };
  field.addEventListener("input", tell);
  alpha.addEventListener("input", tell);
  const set = (value) => {
    const text = hex(value);
    field.value = text.slice(0, 7);
    alpha.value = text.length > 7 ? parseInt(text.slice(7), 16) / 255 : 1;
    alpha.style.setProperty("--share", alpha.value);
  };
  return { parts: [make("span", { class: "color" }, alpha, field)], set };
}

/** Units in words, after a hint. */
const MEASURES = { px: " In pixels of a picture 1080 lines high.", "%": " In per cent.", deg: " In degrees." };

const KINDS = { float: number, int: number, bool, choice, color };

/** Keys that change a value step by step. */
const STEPS = new Set(["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "PageUp", "PageDown", "Home", "End"]);

/** Tells where one change of a control begins and ends: a drag, a colour that is picked, presses of keys in a row. */
function rows(element, onHold, onSettle) {
  let isStepped = false;
  element.addEventListener("keydown", ({ key }) => { isStepped = STEPS.has(key); });
  element.addEventListener("pointerdown", () => {
    isStepped = false;
    onHold();
    const end = () => {
      ["pointerup", "pointercancel"].forEach((kind) => removeEventListener(kind, end, true));
      // What is picked from a list or a palette comes after the pointer is up.
      setTimeout(() => element.querySelector("input[type=color]") === null && onSettle());
    };
    ["pointerup", "pointercancel"].forEach((kind) => addEventListener(kind, end, true));
  });
  // Browsers tell of a change at each press of a key.
  element.addEventListener("change", () => !isStepped && onSettle());
  element.addEventListener("focusout", onSettle);
}

/**
 * The control of a parameter.
 * @param {{param: object, standard: unknown}} entry
 * @param {(value: unknown) => void} onInput
 * @param {{hold: () => void, settle: () => void}} row told when a change begins that may take its time, and when it ends
 */
export function control({ param, standard }, onInput, { hold: onHold, settle: onSettle }) {
  const id = fresh();
  const { parts, set } = KINDS[param.type](param, id, onInput);
  const what = param.type === "color" ? hex(standard) : param.options?.find((option) => option.id === standard)?.label ?? String(standard);
  const tip = `${param.hint}${MEASURES[param.unit] ?? ""}\n\nDefault: ${what}. Double-click for the default.`;
  const label = make("label", { for: id, title: tip }, param.label);
  const element = make("div", { class: `control ${param.type}` }, label, ...parts);
  label.addEventListener("click", (event) => {
    // Nothing may move between the clicks of a double click.
    if (param.type === "float" || param.type === "int") {
      event.preventDefault();
      document.getElementById(id).focus({ preventScroll: true });
    }
  });
  rows(element, onHold, onSettle);
  element.addEventListener("dblclick", (event) => {
    if (!(event.target instanceof HTMLInputElement && event.target.type === "number")) {
      set(standard);
      onInput(standard);
      onSettle();
    }
  });
  return { element, set };
}
