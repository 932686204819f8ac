/** A value of a parameter: a number, a switch, the id of an option, or a colour as `#rrggbb` or numbers from 0 to 1. */
export type Value = number | boolean | string | number[];

/** Values by frame; between them numbers and colours change evenly (`linear`) or not at all (`step`). */
export interface Keys {
  [frame: `${number}`]: Value;
  between?: "linear" | "step";
}

/** A preset: a style with its parameters. The same file as in the other programs of Isophote. */
export interface Preset {
  name?: string;
  about?: string;
  tags?: string[];
  /** Id of a node of the catalogue, or a graph. */
  style: string | Graph;
  /** Whether lengths are pixels of a picture 1080 lines high (the default), or of the picture itself. */
  lengths?: "relative" | "pixels";
  /** By id; `node.id` where the style is a graph. */
  parameters?: Record<string, Value | Keys>;
}

/** Nodes and how they are connected: a graph file. */
export interface Graph {
  format: "isophote-graph";
  version: 1;
  nodes: { name: string; node: string; params?: Record<string, Value>; inputs?: Record<string, string> }[];
  output: string;
}

/** A preset, a graph, or a name: the id of a node, or `look:` and the id of a look. */
export type Look = Preset | Graph | string;

export interface Port {
  id: string;
  kind: "color" | "scalar" | "tensor" | "normal" | "depth" | "object_id" | "flow" | "motion" | "rest_position";
  doc: string;
  optional: boolean;
}

export interface Param {
  id: string;
  label: string;
  doc: string;
  /** Heading under which panels show it; empty for the node's own. */
  group: string;
  type: "float" | "int" | "bool" | "choice" | "color";
  unit: "" | "px" | "%" | "deg";
  /** Whether changing it may change what is computed and not only uniform bytes. */
  structural: boolean;
  default: Value;
  /** Of numbers: what is accepted. */
  range?: [number, number];
  /** Of numbers: what a slider shows. */
  slider?: [number, number];
  /** Of choices. */
  options?: { id: string; label: string; doc: string }[];
}

export interface Node {
  id: string;
  label: string;
  group: "structure" | "smoothing" | "lines" | "painting" | "coherence" | "colour" | "time" | "styles";
  doc: string;
  /** Where the thesis or a paper describes it. */
  section: string;
  inputs: Port[];
  params: Param[];
  output: Port;
}

/** A picture that may enter a graph beside the colour. */
export interface GuideInfo {
  id: Guide;
  label: string;
  doc: string;
  kind: Port["kind"];
  /** Values a pixel. */
  channels: number;
}

export interface Catalogue {
  nodes: Node[];
  guides: GuideInfo[];
}

export type Guide =
  | "normal" | "depth" | "object_id" | "mask" | "flow" | "motion" | "motion_forward" | "rest_position";

/** A picture: anything that `GPUQueue.copyExternalImageToTexture` takes, or a texture of the same device. */
export type Source = GPUCopyExternalImageSource | GPUTexture;

/** A picture and its guides, of which only masks and flow maps may have eight bits. */
export type Sources =
  & { color: Source }
  & Partial<Record<"mask" | "flow", Source>>
  & Partial<Record<Exclude<Guide, "mask" | "flow">, GPUTexture>>;

export interface PictureOptions {
  /** Space of the colour that enters and leaves: gamma-encoded `srgb` (the default), or scene-linear. */
  space?: "srgb" | "linear" | "acescg";
  /** How colour and alpha are related: `premultiplied` (the default), `straight`, or with light where coverage is 0. */
  alpha?: "premultiplied" | "straight" | "emissive";
  /** `exact`: 32-bit floats (the default). `half`: 16 bits for colours, half the memory. `fast`: interpolated by samplers, too. */
  precision?: "exact" | "half" | "fast";
  /** Number of the frame, which renews what `hold` lets last. */
  frame?: number;
  /** Where the picture stands in a larger one, in pixels: marks are anchored there. */
  origin?: [number, number];
  /** Rendered size over full size. */
  scale?: number;
}

export interface StylizerOptions extends PictureOptions {
  width: number;
  height: number;
  /**
   * Guides that every frame brings. `normal`: view-space x, y, z in -1..1 and validity in alpha; `depth`: distance from the
   * camera, 0 or less where there is nothing; `object_id`: a number per object.
   */
  guides?: Guide[];
}

export interface ApplyOptions extends Omit<PictureOptions, "space" | "alpha"> {
  /** Bytes that textures may take; larger pictures are computed in tiles. 512 MiB without. */
  memory?: number;
  /** Told the share that is done. */
  onProgress?: (share: number) => void;
  signal?: AbortSignal;
}

export interface PaintOptions {
  /** Another picture, shown left of `edge`. */
  beside?: GPUTexture;
  /** From 0 to 1. */
  edge?: number;
  /** Size of the part that is shown, in sizes of the picture. */
  scale?: [number, number];
  /** Left top corner of that part, in sizes of the picture. */
  offset?: [number, number];
  /** Whether the target's colour is not multiplied by alpha. */
  straight?: boolean;
}

/** A look ready for pictures of one size. */
export class Stylizer {
  readonly look: Look;
  readonly width: number;
  readonly height: number;
  /** Takes over another look, frame or origin. Rejects with a {@link LookError} and changes nothing where it is refused. */
  update(look: Look, options?: { frame?: number; origin?: [number, number] }): Promise<"uniforms" | "structure">;
  /** Records the look; the result is the same texture until an update changes the structure. */
  encode(encoder: GPUCommandEncoder, inputs: { color: GPUTexture } & Partial<Record<Guide, GPUTexture>>): GPUTexture;
  destroy(): void;
}

/** Draws what stylizers compute. */
export class Painter {
  paint(encoder: GPUCommandEncoder, picture: GPUTexture, target: GPUTexture, options?: PaintOptions): void;
}

export class Isophote {
  /** Loads the planner and opens a graphics device, or uses the page's own. */
  static create(options?: {
    wasm?: string | URL | Response | BufferSource | WebAssembly.Module | Promise<Response>;
    device?: GPUDevice;
    adapter?: GPUAdapter;
  }): Promise<Isophote>;
  readonly device: GPUDevice;
  readonly painter: Painter;
  /** Whether the device computes on the CPU. */
  readonly isSoftware: boolean;
  readonly catalogue: Catalogue;
  /** The graph that a look comes to. Throws a {@link LookError} that says what is wrong with it. */
  graph(look: Look, frame?: number): Graph;
  stylizer(look: Look, options: StylizerOptions): Promise<Stylizer>;
  /** The look on one picture of any size, as gamma-encoded pixels; alpha is straight. */
  apply(
    look: Look,
    inputs: Source | Sources,
    options?: ApplyOptions,
  ): Promise<ImageData>;
  /** A picture as a texture that stylizers read. */
  texture(source: GPUCopyExternalImageSource): GPUTexture;
  destroy(): void;
}

/** What a look has that is refused: an unknown name, a value out of range, an open input. */
export class LookError extends Error {}

/** The looks that ship, by id. */
export const looks: Record<string, Preset>;
