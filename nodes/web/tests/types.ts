// What users of TypeScript write; it is compiled, and never run.

import { Isophote, looks, LookError, type Look, type Param } from "isophote";
import { stylize, type StylizeNode } from "isophote/three";
import { pass } from "three/tsl";
import { Camera, Scene } from "three/webgpu";

export async function pictures(image: HTMLImageElement): Promise<ImageData> {
  const isophote = await Isophote.create();
  const onCpu = await Isophote.create({ backend: "cpu", cpu: { wasm: new URL("https://example.org/cpu.wasm") } });
  const backend: "gpu" | "cpu" = onCpu.backend;
  console.log(backend, onCpu.reason?.length);
  const look: Look = { style: "cartoon", parameters: { posterize: 6, sigma_d: { "1": 2, "9": 4, between: "step" } } };
  try {
    isophote.graph(look);
  } catch (error) {
    console.log(error instanceof LookError);
  }
  const param: Param | undefined = isophote.catalogue.nodes[0]?.params[0];
  console.log(param?.slider?.[0]);
  return isophote.apply(looks.copperplate ?? look, image, { onProgress: (share) => console.log(share) });
}

export async function frames(isophote: Isophote, color: GPUTexture, normal: GPUTexture): Promise<GPUTexture> {
  const stylizer = await isophote.stylizer({ style: "ink" }, { width: 320, height: 240, precision: "fast", guides: ["normal"] });
  const encoder = isophote.device.createCommandEncoder();
  const result = stylizer.encode(encoder, { color, normal });
  isophote.painter.paint(encoder, result, color, { beside: normal, edge: 0.5 });
  const change: "uniforms" | "structure" = await stylizer.update({ style: "ink", parameters: { tone: 0.5 } });
  console.log(change);
  return result;
}

export function scenes(isophote: Isophote): StylizeNode {
  const scenePass = pass(new Scene(), new Camera());
  // @ts-expect-error There is no such guide.
  stylize(isophote, { style: "ink" }, scenePass, { guides: ["wood"] });
  // @ts-expect-error A look names its style.
  stylize(isophote, { parameters: {} }, scenePass);
  const steady = stylize(isophote, { style: "ink" }, scenePass, { guides: ["depth", "motion"] });
  void steady.cut();
  return steady;
}
