// The package on a page: every node, the same pixels as `isophote apply`, tiles, updates and refusals.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { promisify } from "node:util";
import { built, launch, open, serve } from "./browser.mjs";

const run = promisify(execFile);
let browser, server, page, complaints, folder;

before(async () => {
  folder = await mkdtemp(join(tmpdir(), "isophote-"));
  server = await serve({ "/package/": built("ISOPHOTE_PACKAGE") });
  browser = await launch();
  ({ page, complaints } = await open(browser, server.address));
  await page.evaluate(async () => {
    const isophote = await import("/package/src/index.js");
    window.looks = isophote.looks;
    window.iso = await isophote.Isophote.create();
    // Things with edges, a slope of colours, and something like grain.
    window.picture = new OffscreenCanvas(232, 174);
    const context = window.picture.getContext("2d");
    const slope = context.createLinearGradient(0, 0, 232, 174);
    slope.addColorStop(0, "#1d3557");
    slope.addColorStop(1, "#f1c27d");
    context.fillStyle = slope;
    context.fillRect(0, 0, 232, 174);
    let seed = 1;
    const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
    for (let spot = 0; spot < 90; spot += 1) {
      context.fillStyle = `hsl(${random() * 360} 60% ${20 + random() * 60}%)`;
      context.beginPath();
      context.ellipse(random() * 232, random() * 174, 3 + random() * 22, 3 + random() * 12, random() * 3, 0, 7);
      context.fill();
    }
  });
});

after(async () => {
  await browser?.close();
  await server?.close();
  await rm(folder, { recursive: true, force: true });
});

test("every node runs in every precision", { timeout: 600_000 }, async () => {
  const outcome = await page.evaluate(async () => {
    const [width, height] = [48, 32];
    const { device } = window.iso;
    const made = (format, bytes) => {
      const usage = GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST;
      const texture = device.createTexture({ size: [width, height], format, usage });
      const data = new Float32Array(width * height * (bytes / 4)).map((_, at) => ((at * 7919) % 101) / 101);
      device.queue.writeTexture({ texture }, data, { bytesPerRow: width * bytes }, [width, height]);
      return texture;
    };
    const inputs = {
      color: made("rgba32float", 16),
      normal: made("rgba32float", 16),
      depth: made("r32float", 4),
      object_id: made("r32float", 4),
    };
    const done = [];
    for (const { id, output } of window.iso.catalogue.nodes) {
      for (const precision of ["exact", "half"]) {
        const guides = ["normal", "depth", "object_id"];
        const stylizer = await window.iso.stylizer(id, { width, height, guides, precision });
        await window.iso.checked(() => {
          const encoder = device.createCommandEncoder();
          stylizer.encode(encoder, inputs);
          device.queue.submit([encoder.finish()]);
        });
        await device.queue.onSubmittedWorkDone();
        stylizer.destroy();
      }
      if (window.iso.graph(id).nodes.length === 1 && output.kind === "color") {
        // Samplers read pictures of a page, which have eight bits.
        await window.iso.apply({ style: id }, window.picture, { precision: "fast" });
      }
      done.push(id);
    }
    return done;
  });
  assert.ok(outcome.length > 25, `${outcome.length} nodes`);
  assert.deepEqual(complaints, []);
});

test("pictures are those of apply", { timeout: 600_000 }, async () => {
  const encoded = await page.evaluate(async () => {
    const blob = await window.picture.convertToBlob({ type: "image/png" });
    return [...new Uint8Array(await blob.arrayBuffer())];
  });
  await writeFile(join(folder, "picture.png"), Uint8Array.from(encoded));
  const styles = ["cartoon", "painting", "oil_paint", "watercolor", "ink", "coherent", "blueprint"];
  for (const style of styles) {
    const out = join(folder, `${style}.png`);
    const preset = join(folder, `${style}.json`);
    await writeFile(preset, JSON.stringify({ style, parameters: {} }));
    await run(built("ISOPHOTE_HOST"), ["apply", preset, join(folder, "picture.png"), out, "--backend", "cpu"]);
    const [worst, beyond] = await page.evaluate(async ([name, bytes]) => {
      const blob = new Blob([Uint8Array.from(bytes)], { type: "image/png" });
      const bitmap = await createImageBitmap(blob, { colorSpaceConversion: "none" });
      const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
      const context = canvas.getContext("2d");
      context.drawImage(bitmap, 0, 0);
      const wanted = context.getImageData(0, 0, bitmap.width, bitmap.height).data;
      const { data } = await window.iso.apply({ style: name, parameters: {} }, window.picture);
      let [most, count] = [0, 0];
      data.forEach((value, at) => {
        const difference = Math.abs(value - wanted[at]);
        most = Math.max(most, difference);
        count += difference > 1 ? 1 : 0;
      });
      return [most, count / data.length];
    }, [style, [...await readFile(out)]]);
    console.log(`${style}: worst ${worst}/255, ${(beyond * 100).toFixed(3)} % beyond 1/255`);
    // A stream line or a comparison that goes the other way on the last bit.
    assert.ok(beyond < 0.0001, `${style}: ${(beyond * 100).toFixed(3)} % of the values differ by more than 1/255`);
  }
});

test("tiles are the whole picture", { timeout: 120_000 }, async () => {
  const differences = await page.evaluate(async () => {
    const large = new OffscreenCanvas(700, 300);
    large.getContext("2d").drawImage(window.picture, 0, 0, 700, 300);
    const whole = await window.iso.apply({ style: "cartoon" }, large);
    const shares = [];
    const tiled = await window.iso.apply({ style: "cartoon" }, large, { memory: 4e6, onProgress: (s) => shares.push(s) });
    return [whole.data.filter((value, at) => Math.abs(value - tiled.data[at]) > 1).length, shares];
  });
  assert.equal(differences[0], 0);
  assert.ok(differences[1].length > 1 && differences[1].at(-1) === 1, `${differences[1]}`);
});

test("masks are pictures, normals are not", async () => {
  const [left, right, refused] = await page.evaluate(async () => {
    const { width, height } = window.picture;
    const mask = new OffscreenCanvas(width, height);
    const context = mask.getContext("2d");
    context.fillRect(0, 0, width, height);
    context.fillStyle = "#ffffff";
    context.fillRect(0, 0, width / 2, height);
    const plain = window.picture.getContext("2d").getImageData(0, 0, width, height).data;
    const { data } = await window.iso.apply({ style: "kuwahara", lengths: "pixels" }, { color: window.picture, mask });
    const changed = [0, 0];
    data.forEach((value, at) => { changed[(at >> 2) % width < width / 2 ? 0 : 1] += Math.abs(value - plain[at]) > 1 ? 1 : 0; });
    const sources = { color: window.picture, normal: window.picture };
    return [...changed, await window.iso.apply({ style: "ink" }, sources).catch((error) => error.message)];
  });
  assert.ok(left > 1000, `${left} values`);
  assert.equal(right, 0);
  assert.match(refused, /'normal'.*texture of floats/);
});

test("a number is a matter of uniforms", async () => {
  const changes = await page.evaluate(async () => {
    const look = (parameters) => ({ style: "cartoon", parameters });
    const stylizer = await window.iso.stylizer(look({}), { width: 64, height: 48 });
    const found = [await stylizer.update(look({ posterize: 5 })), await stylizer.update(look({ abstraction: "flow" }))];
    const refused = await stylizer.update(look({ posterize: -1 })).catch((error) => error.message);
    found.push(refused, await stylizer.update(look({ abstraction: "flow", posterize: 4 })));
    stylizer.destroy();
    return found;
  });
  assert.equal(changes[0], "uniforms");
  assert.match(changes[2], /posterize/);
  assert.equal(changes[3], "uniforms");
});

test("what is wrong with a look is said", async () => {
  const said = await page.evaluate(() => [
    { style: "cartoom" },
    { style: "cartoon", parameters: { posterise: 3 } },
    { style: "cartoon", parameters: { posterize: "many" } },
    { styles: "cartoon" },
    "cartoom",
    3,
  ].map((look) => {
    try {
      window.iso.graph(look);
      return "nothing";
    } catch (error) {
      return `${error.name}: ${error.message}`;
    }
  }));
  assert.match(said[0], /^LookError: .*cartoom.*cartoon/);
  assert.match(said[1], /posterise.*posterize/);
  assert.match(said[2], /posterize/);
  assert.match(said[3], /styles/);
  assert.match(said[4], /did you mean 'cartoon'/);
  assert.match(said[5], /no preset/);
});

test("presets are read as by the other faces", async () => {
  const table = JSON.parse(await readFile(new URL("../../../tests/data/presets.json", import.meta.url), "utf8"));
  assert.ok(table.length > 20);
  const found = await page.evaluate((cases) => cases.map(({ preset, frame = 0 }) => {
    try {
      const { nodes } = window.iso.graph(preset, frame);
      return { values: Object.fromEntries(nodes.filter(({ params }) => params).map(({ name, params }) => [name, params])) };
    } catch (error) {
      return { error: error.message };
    }
  }), table);
  table.forEach(({ why, values, error }, at) => {
    if (error === undefined) {
      assert.deepEqual(found[at].values, values, `${why}: ${found[at].error}`);
    } else {
      assert.ok(found[at].error?.includes(error), `${why}: ${JSON.stringify(found[at])}`);
    }
  });
});

test("looks are named as presets are", async () => {
  const [named, written] = await page.evaluate(() => ["look:linocut", window.looks.linocut].map((look) => window.iso.graph(look)));
  assert.deepEqual(named, written);
});

test("types name every guide", async () => {
  const types = await readFile(new URL("../package/src/index.d.ts", import.meta.url), "utf8");
  const [, list] = types.match(/export type Guide =([^;]*);/);
  const ids = await page.evaluate(() => window.iso.catalogue.guides.map(({ id }) => id));
  assert.deepEqual([...list.matchAll(/"(\w+)"/g)].map(([, id]) => id), ids);
});

test("all looks that ship are accepted", async () => {
  const count = await page.evaluate(() => Object.values(window.looks).map((look) => window.iso.graph(look)).length);
  assert.ok(count > 40, `${count} looks`);
  const file = new URL("../../../nodes/library/looks/order.txt", import.meta.url);
  const [, list] = (await readFile(file, "utf8")).match(/\{([^}]*)\}/);
  const order = list.trim().split(/\s+/);
  assert.deepEqual(await page.evaluate(() => Object.keys(window.looks)), order);
});
