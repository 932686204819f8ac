// Bundles the page into one file: `node bundle.mjs PACKAGE_DIR OUT_HTML`.
//
// PACKAGE_DIR is the npm package as it is published, with its modules of WebAssembly and `src/looks.js`. Scripts, styles, modules and
// the sample pictures are written into the page, so that it works from a folder and asks nobody for anything.

import { build } from "esbuild";
import { mkdirSync, readFileSync, writeFileSync, existsSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const here = dirname(fileURLToPath(import.meta.url));
const samples = resolve(here, "../../../host-example/window/samples");

const installed = resolve(here, "../node_modules");

/** Add-ons of three.js import its other entry, which would be a second copy of it. */
const oneThree = {
  name: "one-three",
  setup: ({ onResolve }) => onResolve({ filter: /^three$/ }, () => ({ path: join(installed, "three/build/three.webgpu.js") })),
};

/** Pictures that the page brings along: file and what people call it. */
const SAMPLES = [
  ["fountain.jpg", "A fountain"],
  ["statue.jpg", "A statue"],
];

/** The page's scripts as one script. */
async function script(packageDir) {
  const { outputFiles } = await build({
    entryPoints: [join(here, "src/main.js")],
    bundle: true,
    write: false,
    minify: true,
    format: "esm",
    target: "es2022",
    charset: "utf8",
    legalComments: "inline",
    alias: {
      isophote: join(packageDir, "src/index.js"),
      "isophote/three": join(packageDir, "src/three.js"),
    },
    // The package lies elsewhere and imports three, too.
    nodePaths: [installed],
    plugins: [oneThree],
    logLevel: "warning",
  });
  // A script ends at the first end tag, even within a string.
  return outputFiles[0].text.replaceAll("</script", "<\\/script");
}

/** The program of the processor's threads as one script. */
async function worker(packageDir) {
  const { outputFiles } = await build({
    entryPoints: [join(packageDir, "src/cpu-worker.js")],
    bundle: true,
    write: false,
    minify: true,
    format: "iife",
    target: "es2022",
    charset: "utf8",
  });
  return Buffer.from(outputFiles[0].contents);
}

/** The page's styles as one sheet. */
async function style() {
  const { outputFiles } = await build({
    entryPoints: [join(here, "src/style.css")],
    bundle: true,
    write: false,
    minify: true,
    charset: "utf8",
  });
  return outputFiles[0].text;
}

/** An element that holds bytes and is not run. */
function data(id, bytes, label) {
  const name = label === undefined ? "" : ` data-label="${label}"`;
  return `<script type="application/octet-stream" id="${id}"${name}>${bytes.toString("base64")}</script>`;
}

/** Under which licences the page stands, and what it holds of others. */
function licences(packageDir) {
  const files = [
    join(packageDir, "LICENSE-MIT"),
    join(packageDir, "LICENSE-APACHE"),
    join(installed, "three/LICENSE"),
    join(packageDir, "LICENSES-OF-OTHERS.txt"),
  ];
  const text = files.filter(existsSync).map((file) => readFileSync(file, "utf8")).join("\n\n");
  return `<script type="text/plain" id="licences">\n${text.replaceAll("</script", "<\\/script")}</script>`;
}

/** Writes a size as people read it. */
function kilobytes(bytes) {
  return `${Math.round(bytes / 1024)} KB`;
}

async function main([packageDir, out]) {
  if (packageDir === undefined || out === undefined) {
    throw new Error("say the folder of the package and the file to write: node bundle.mjs PACKAGE_DIR OUT_HTML");
  }
  const module = (id, file) => {
    const wasm = join(packageDir, file);
    if (!existsSync(wasm)) {
      throw new Error(`${wasm} is missing; build the modules into the package first`);
    }
    return data(id, gzipSync(readFileSync(wasm), { level: 9 }));
  };
  const [code, sheet, thread] = await Promise.all([script(resolve(packageDir)), style(), worker(resolve(packageDir))]);
  const modules = [module("isophote-wasm", "isophote.wasm"), module("isophote-cpu-wasm", "isophote-cpu.wasm"), data("isophote-cpu-worker", thread)];
  const pictures = SAMPLES.map(([file, label]) => data(`sample-${file}`, readFileSync(join(samples, file)), label)).join("\n");
  const parts = { style: `<style>${sheet}</style>`, data: `${licences(resolve(packageDir))}\n${modules.join("\n")}\n${pictures}`, script: `<script type="module">${code}</script>` };
  const page = readFileSync(join(here, "src/index.html"), "utf8").replace(/<!-- (style|data|script) -->/g, (_, part) => parts[part]);
  mkdirSync(dirname(resolve(out)), { recursive: true });
  writeFileSync(out, page);
  const without = page.length - pictures.length;
  const compressed = gzipSync(page.replace(pictures, ""), { level: 9 }).length;
  console.log(`${out}: ${kilobytes(page.length)}; without sample pictures ${kilobytes(without)}, compressed ${kilobytes(compressed)}`);
}

main(process.argv.slice(2)).catch((error) => {
  console.error(`bundle.mjs: ${error.message}`);
  process.exitCode = 1;
});
