// Files that come in: dropped, opened, pasted; told apart by what they are.

import { byId } from "./dom.js";

const PRESET = /\.json$/i;
const MODEL = /\.(glb|gltf)$/i;

/**
 * What a handful of files is.
 * @param {{path: string, file: File}[]} entries
 * @returns {{kind: "preset"|"model"|"picture"|"none", main?: {path: string, file: File}, entries: object[]}}
 */
export function sort(entries) {
  const model = entries.find(({ path }) => MODEL.test(path));
  if (model !== undefined) {
    return { kind: "model", main: model, entries };
  }
  const preset = entries.find(({ path }) => PRESET.test(path));
  if (preset !== undefined) {
    return { kind: "preset", main: preset, entries };
  }
  const picture = entries.find(({ file }) => file.type.startsWith("image/")) ?? entries[0];
  return picture === undefined ? { kind: "none", entries } : { kind: "picture", main: picture, entries };
}

/** Files of a drop, with those in folders. */
async function dropped(transfer) {
  const items = [...transfer.items].filter(({ kind }) => kind === "file");
  // Must be asked before the first wait: afterwards the transfer is empty.
  const roots = items.map((item) => item.webkitGetAsEntry?.() ?? null);
  const files = items.map((item) => item.getAsFile());
  const found = [];
  for (const [index, root] of roots.entries()) {
    if (root?.isDirectory) {
      await walk(root, "", found);
    } else if (files[index] !== null) {
      found.push({ path: files[index].name, file: files[index] });
    }
  }
  return found;
}

async function walk(folder, prefix, found) {
  const reader = folder.createReader();
  for (;;) {
    const some = await new Promise((resolve, reject) => { reader.readEntries(resolve, reject); });
    if (some.length === 0) {
      return;
    }
    for (const entry of some) {
      if (entry.isDirectory) {
        await walk(entry, `${prefix}${entry.name}/`, found);
      } else {
        const file = await new Promise((resolve, reject) => { entry.file(resolve, reject); });
        found.push({ path: prefix + entry.name, file });
      }
    }
  }
}

/**
 * Listens for files wherever they come from.
 * @param {(entries: {path: string, file: File}[]) => void} onFiles
 * @param {(error: Error) => void} onFault
 */
export function listen(onFiles, onFault) {
  const field = byId("file");
  byId("open").addEventListener("click", () => field.click());
  field.addEventListener("change", () => {
    onFiles([...field.files].map((file) => ({ path: file.webkitRelativePath || file.name, file })));
    field.value = "";
  });
  let depth = 0;
  const hasFiles = (event) => event.dataTransfer?.types.includes("Files");
  const veil = (by) => {
    depth = Math.max(0, depth + by);
    byId("drop").hidden = depth === 0;
  };
  addEventListener("dragenter", (event) => hasFiles(event) && veil(1));
  addEventListener("dragleave", (event) => hasFiles(event) && veil(-1));
  addEventListener("dragover", (event) => {
    if (hasFiles(event)) {
      event.preventDefault();
      event.dataTransfer.dropEffect = "copy";
    }
  });
  addEventListener("drop", (event) => {
    event.preventDefault();
    depth = 0;
    veil(0);
    dropped(event.dataTransfer).then(onFiles).catch(onFault);
  });
  addEventListener("paste", (event) => {
    const files = [...(event.clipboardData?.files ?? [])];
    if (files.length > 0) {
      event.preventDefault();
      onFiles(files.map((file) => ({ path: file.name, file })));
    }
  });
}
