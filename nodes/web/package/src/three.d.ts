import type { MRTNode, Node, PassNode, TextureNode } from "three/webgpu";
import type { Guide, Isophote, Look } from "./index.js";

export interface StylizeOptions {
  /** Which guides the look is given; `normal` and `depth` without. With `motion`, looks with `steadiness` are steady over time. */
  guides?: ("normal" | "depth" | "motion")[];
  /** `fast` without. */
  precision?: "exact" | "half" | "fast";
}

/** A look on textures of nodes, as a node that gives gamma-encoded colours. Shows the plain colour while shaders compile. */
export class StylizeNode extends Node {
  constructor(
    isophote: Isophote,
    look: Look,
    inputs: { color: TextureNode } & Partial<Record<Guide, TextureNode>>,
    options?: { precision?: "exact" | "half" | "fast" },
  );
  readonly look: Look;
  /** Resolves when the look is shown for the first time; rejects with what keeps it from being so. */
  readonly ready: Promise<void>;
  /** Takes over another look from the next frame on; rejects with a `LookError` where it is refused. */
  setLook(look: Look): Promise<void>;
  /** Takes the next frame for the first of a shot, as after a cut. */
  cut(): Promise<void>;
}

/**
 * A look on what a pass draws, with its normals and depths, beside what the pass draws already (`pass.setMRT(…)` before). It is the last node of a pipeline, whose `outputColorTransform`
 * is false: colours are tone-mapped and encoded before the look sees them.
 */
export function stylize(isophote: Isophote, look: Look, scenePass: PassNode, options?: StylizeOptions): StylizeNode;

/** What textures that hold guides are called. */
export const NAMES: { normal: string; depth: string; motion: string };

/** What a renderer is told to draw beside colours, for who reads the textures without a node. */
export function targets(guides?: ("normal" | "depth" | "motion")[]): MRTNode;
