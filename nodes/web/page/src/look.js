// Looks as the page holds them: `{style, lengths, parameters}`, where the parameters are those that differ from their defaults, and
// `objects` where there are rules for things, which are kept and not followed.

/** The keys of a look that say what is computed, without those for people. */
export function bare(look) {
  const { style, lengths = "relative", parameters = {}, objects } = look;
  return { style, lengths, parameters: { ...parameters }, ...(objects && { objects }) };
}

/** A look out of what a file or a link holds: a preset, or a graph. */
export function fromFile(json) {
  if (json === null || typeof json !== "object" || Array.isArray(json)) {
    throw new Error("it is no object with a style");
  }
  return bare(Array.isArray(json.nodes) ? { style: json } : json);
}

/** What a preset calls itself and says of itself, or the file that it came in: `{name, about}`. */
export function titleOf(json, file) {
  const text = (value) => (typeof value === "string" ? value.trim() : "");
  return { name: text(json.name) || file.replace(/\.json$/i, ""), about: text(json.about) };
}

/** Whether two looks compute the same: here rules for things do nothing. */
export function isSame(a, b) {
  return JSON.stringify(canonical(a)) === JSON.stringify(canonical(b));
}

function canonical({ style, lengths = "relative", parameters = {} }) {
  const entries = Object.entries(parameters).sort(([a], [b]) => (a < b ? -1 : 1));
  return { style, lengths, parameters: entries.map(([name, value]) => [name, isColor(value) ? hex(value) : value]) };
}

/**
 * The parameters of a look: of its node, or of all nodes of its graph.
 * @returns {{name: string, param: object, standard: unknown, heading: string}[]} `standard` is the value where the look gives none
 */
export function controls(catalogue, look) {
  if (typeof look.style === "string") {
    const node = catalogue.nodes.find(({ id }) => id === look.style);
    return (node?.params ?? []).map((param) => ({ name: param.id, param, standard: param.default, heading: param.group }));
  }
  return look.style.nodes.flatMap(({ name: place, node: id, params = {} }) => {
    const node = catalogue.nodes.find((other) => other.id === id);
    return (node?.params ?? []).map((param) => ({
      name: `${place}.${param.id}`,
      param,
      standard: params[param.id] ?? param.default,
      heading: `${node.label}: ${param.group || "settings"}`,
    }));
  });
}

/** What a look is called that has no name, and what it does. */
export function description(catalogue, look) {
  const node = catalogue.nodes.find(({ id }) => id === look.style);
  return node === undefined ? { name: "Graph", about: "A graph of nodes" } : { name: node.label, about: node.hint };
}

/** The look with another value, which is left out where it is the standard. */
export function withValue(look, { name, standard }, value) {
  const parameters = { ...look.parameters };
  if (isEqual(value, standard)) {
    delete parameters[name];
  } else {
    parameters[name] = value;
  }
  return { ...look, parameters };
}

/** Whether a look, whose graph this is, changes with the number of the frame. */
export function isTimed({ parameters = {} }, { nodes }) {
  return nodes.some(({ params }) => params?.hold > 0) || Object.values(parameters).some(isKeyed);
}

/** Whether two values of a parameter are the same. */
export function isEqual(a, b) {
  if (isColor(a) || isColor(b)) {
    return isColor(a) && isColor(b) && hex(a) === hex(b);
  }
  return a === b;
}

/** Whether a value is a colour. */
export function isColor(value) {
  return Array.isArray(value) || (typeof value === "string" && /^#[0-9a-f]{6}([0-9a-f]{2})?$/i.test(value));
}

/** A colour as `#rrggbb`, or `#rrggbbaa` where it is not opaque. */
export function hex(color) {
  if (typeof color === "string") {
    return color.toLowerCase().replace(/^(#.{6})ff$/, "$1");
  }
  const part = (value) => Math.round(Math.min(Math.max(value, 0), 1) * 255).toString(16).padStart(2, "0");
  const [r, g, b, a = 1] = color;
  return `#${part(r)}${part(g)}${part(b)}${a >= 1 ? "" : part(a)}`;
}

/** Whether a value is given by frames. */
export function isKeyed(value) {
  return value !== null && typeof value === "object" && !Array.isArray(value);
}
