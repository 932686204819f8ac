// The declarations of the packed package, through the compiler of TypeScript.

import { execFile } from "node:child_process";
import { copyFile, mkdir, mkdtemp, rm, symlink, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { built } from "./browser.mjs";

const run = promisify(execFile);
const here = dirname(fileURLToPath(import.meta.url));
const tools = join(here, "../node_modules");
let folder;

before(async () => {
  folder = await mkdtemp(join(tmpdir(), "isophote-"));
  const modules = join(folder, "node_modules");
  await mkdir(join(modules, "isophote"), { recursive: true });
  await run("tar", ["-xzf", built("ISOPHOTE_PACKED"), "-C", join(modules, "isophote"), "--strip-components=1"]);
  for (const name of ["three", "@types"]) {
    await symlink(join(tools, name), join(modules, name), "junction");
  }
  await copyFile(join(here, "types.ts"), join(folder, "types.ts"));
  const compilerOptions = {
    strict: true,
    noUncheckedIndexedAccess: true,
    module: "nodenext",
    target: "es2022",
    lib: ["es2022", "dom"],
    types: [],
    skipLibCheck: true,
    preserveSymlinks: true,
    noEmit: true,
  };
  await writeFile(join(folder, "package.json"), '{ "type": "module" }');
  await writeFile(join(folder, "tsconfig.json"), JSON.stringify({ compilerOptions, files: ["types.ts"] }));
});

after(() => rm(folder, { recursive: true, force: true }));

test("programs of TypeScript are checked by the declarations", { timeout: 120_000 }, async () => {
  const compiled = await run(process.execPath, [join(tools, "typescript/bin/tsc"), "-p", folder]).catch((error) => error);
  if (compiled.code !== undefined) {
    throw new Error(compiled.stdout);
  }
});
