//! Shaders that do the work of several kernels in one dispatch.

use super::format::Format;
use super::fusion::Lead;
use super::shader::{NEAREST_HALF, Reading, Shader, variant};
use crate::kernel::{Fusible, Kernel, PAIR_WORKGROUP};
use crate::wgsl::Piece;
use std::collections::HashSet;
use std::fmt::Write as _;

/// Text in the place of [`STORE`](crate::wgsl::STORE) where other kernels follow.
const FOLLOW: &str = "follow(id, ";

/// A kernel among those of a dispatch.
#[derive(Clone, Debug)]
pub(super) struct Link {
    pub kernel: &'static Kernel,
    /// By input: the kernel of the dispatch that has computed it; none for a texture.
    pub values: Vec<Option<usize>>,
}

/// Kernels that run in one dispatch.
#[derive(Clone, Debug)]
pub(super) struct Fused {
    pub links: Vec<Link>,
    /// Which of them come first, together.
    pub lead: Lead,
    /// Result that is stored: the kernels that have computed it, and its format.
    pub outputs: Vec<(usize, Format)>,
    /// True where the texture that the first of several reads is held in the window that is summed, as it is at the same level.
    pub is_held: bool,
    /// Access of the first to its textures.
    pub reading: Reading,
}

/// The uniform bytes of several kernels: each block begins at a multiple of 16 bytes.
pub(super) fn padded(size: usize) -> usize {
    size.next_multiple_of(16)
}

impl Fused {
    /// The shader.
    pub fn shader(&self) -> Shader {
        let kernels = || self.links.iter().map(|link| link.kernel);
        let params_size = kernels().map(|kernel| padded(kernel.params_size)).sum();
        let outputs: Vec<Format> = self.outputs.iter().map(|(_, format)| *format).collect();
        Shader {
            name: self.name().into(),
            source: self.source().into(),
            inputs: self.textures(),
            outputs: outputs.into(),
            params_size,
            workgroup: if self.lead == Lead::Single { self.reading.workgroup() } else { PAIR_WORKGROUP },
            filtered: self.links.first().map_or(&[][..], |link| self.reading.filtered(link.kernel)).into(),
        }
    }

    fn is_half(&self) -> bool {
        self.outputs.iter().any(|(_, format)| *format == Format::Rgba16)
    }

    /// Number of textures that are read.
    fn textures(&self) -> usize {
        self.links.iter().flat_map(|link| &link.values).filter(|value| value.is_none()).count()
    }

    fn name(&self) -> String {
        let mut name = String::new();
        for (place, link) in self.links.iter().enumerate() {
            let is_lead = place < self.lead.len();
            let between = if place == 0 {
                ""
            } else if is_lead {
                "&"
            } else {
                "+"
            };
            let _ = write!(name, "{between}{}", link.kernel.name);
            let taken: Vec<usize> = (0..link.values.len()).filter(|at| link.values[*at].is_some()).collect();
            match taken[..] {
                _ if is_lead => {}
                [0] if link.values[0] == Some(place - 1) => {}
                [at] if link.values[at] == Some(place - 1) => drop(write!(name, "@{at}")),
                _ => {
                    let value =
                        |value: &Option<usize>| value.map_or("t".to_owned(), |place| place.to_string());
                    let values: Vec<String> = link.values.iter().map(value).collect();
                    let _ = write!(name, "@({})", values.join(","));
                }
            }
            if place + 1 < self.links.len() && self.outputs.iter().any(|(of, _)| *of == place) {
                name.push('*');
            }
        }
        name + &variant(self.is_half(), self.reading)
    }

    /// The module. What kernels after the first declare gets the number of their place behind its name, so that two may use
    /// the same names.
    fn source(&self) -> String {
        let mut text = self.imports();
        text.push_str(&self.uniforms());
        let mut bindings = Bindings { text: String::new(), count: 0 };
        let following = match self.lead {
            Lead::Single => self.single(&mut bindings, &mut text),
            _ => self.window(&mut bindings, &mut text),
        };
        let following = following + &self.followers(&mut bindings, &mut text);
        text.push_str(&bindings.text);
        let mut stores = String::new();
        for (at, (place, format)) in self.outputs.iter().enumerate() {
            let image = if at == 0 { "target_image".to_owned() } else { format!("target_image_{at}") };
            let binding = 2 + bindings.count + at;
            let _ = writeln!(
                text,
                "@group(0) @binding({binding}) var {image}: texture_storage_2d<{}, write>;",
                format.wgsl()
            );
            let value = format!("value_{place}");
            let value = if *format == Format::Rgba16 { format!("nearest_half({value})") } else { value };
            let _ = writeln!(stores, "    textureStore({image}, vec2i(id.xy), {value});");
        }
        let _ = write!(text, "\nfn follow(id: vec3u, first: vec4f) {{\n{following}{stores}}}\n");
        if self.is_half() {
            text.push_str(NEAREST_HALF);
        }
        text
    }

    /// Texts that the kernels import, each once.
    fn imports(&self) -> String {
        let mut text = String::new();
        let mut known: HashSet<&str> = HashSet::new();
        for (place, link) in self.links.iter().enumerate() {
            let pair = link.kernel.fusible.pair().filter(|_| self.is_of_pair(place));
            let imports = pair.map_or(link.kernel.pieces.imports, |pair| pair.imports);
            for import in imports.iter().filter(|import| known.insert(import.name)) {
                // Only what the first kernel imports may know of its parameters.
                self.place(0, &[]).write(self.reading.pieces(import), &mut text);
            }
        }
        text
    }

    /// True for a kernel that is the rows or the columns of a window.
    fn is_of_pair(&self, place: usize) -> bool {
        self.lead != Lead::Single && (self.lead.len() - 2..self.lead.len()).contains(&place)
    }

    /// One uniform block with the blocks of all kernels, if any has one.
    fn uniforms(&self) -> String {
        let places = || self.links.iter().enumerate().filter(|(_, link)| link.kernel.params_size > 0);
        if places().next().is_none() {
            return String::new();
        }
        let mut text = String::from("struct Uniforms {\n");
        for (place, _) in places() {
            // Rows and columns have blocks of one kind.
            let ty = if self.is_of_pair(place) { self.lead.len() - 2 } else { place };
            let _ = writeln!(text, "    @align(16) params_{place}: Params_{ty},");
        }
        text.push_str("}\n@group(0) @binding(1) var<uniform> uniforms: Uniforms;\n");
        text
    }

    /// Kernel of this place among the others, with its textures at these slots.
    fn place<'s>(&self, number: usize, slots: &'s [Option<usize>]) -> Place<'s> {
        let is_held = self.lead == Lead::ProducerAndPair && self.is_held;
        Place { number, slots, is_held: is_held && number == 0, reading: self.reading }
    }

    /// Adds the text of a first kernel; returns what begins the function of those that follow.
    fn single(&self, bindings: &mut Bindings, text: &mut String) -> String {
        let link = &self.links[0];
        let (arguments, slots) = bindings.of(link, 0);
        if link.kernel.fusible.around().is_some() {
            let _ = write!(
                text,
                "@compute @workgroup_size(8, 8)\nfn main(@builtin(global_invocation_id) id: vec3u) {{\n    \
                 if !outside(id) {{\n        {FOLLOW}of_pixel(id{arguments}));\n    }}\n}}\n"
            );
        }
        self.place(0, &slots).write(link.kernel.pieces.own, text);
        format!("    let value_0 = {};\n", stored("first", link.kernel.outputs[0]))
    }

    /// Adds the texts of a window and of what it sums; returns the same.
    fn window(&self, bindings: &mut Bindings, text: &mut String) -> String {
        let (rows, last) = (self.lead.len() - 2, self.lead.len() - 1);
        let kernel = self.links[rows].kernel;
        let Some(pair) = kernel.fusible.pair() else { return String::new() };
        bindings.of(&self.links[0], 0);
        if let Fusible::BeforeWindow { anywhere } = self.links[0].kernel.fusible {
            self.place(0, &[]).write(anywhere, text);
        }
        let window = self.place(rows, &[]);
        window.write(pair.block, text);
        let source = if rows > 0 { "at_place(p)" } else { "fetch(source, 0u, p)" };
        let _ = writeln!(text, "fn pair_source(p: vec2i) -> vec4f {{\n    return {source};\n}}");
        text.push_str(if rows > 0 && self.is_held { HOLDING } else { HOLDING_NOTHING });
        window.write(pair.own, text);
        format!("    let value_{last} = {};\n", stored("first", kernel.outputs[0]))
    }

    /// Adds the texts of the kernels that follow; returns the lines that call them.
    fn followers(&self, bindings: &mut Bindings, text: &mut String) -> String {
        let mut following = String::new();
        for (place, link) in self.links.iter().enumerate().skip(self.lead.len()) {
            let (arguments, slots) = bindings.of(link, place);
            let call = format!("of_pixel_{place}(id{arguments})");
            let _ = writeln!(following, "    let value_{place} = {};", stored(&call, link.kernel.outputs[0]));
            self.place(place, &slots).write(link.kernel.pieces.own, text);
        }
        following
    }
}

/// A kernel among those of a dispatch, as its pieces are written.
struct Place<'s> {
    number: usize,
    /// By input: where its texture is among all that are read.
    slots: &'s [Option<usize>],
    /// True where a window holds what it reads.
    is_held: bool,
    reading: Reading,
}

impl Place<'_> {
    fn write(&self, pieces: &[Piece], text: &mut String) {
        let number = self.number;
        for piece in pieces {
            let _ = match *piece {
                Piece::Binding(_) | Piece::Format { .. } => Ok(()),
                // The first kernel keeps its names, by which what it imports may call it.
                Piece::Name(name) if number > 0 => write!(text, "{name}_{number}"),
                Piece::Params => write!(text, "uniforms.params_{number}"),
                Piece::ColumnsParams => write!(text, "uniforms.params_{}", number + 1),
                Piece::ParamsType => write!(text, "Params_{number}"),
                Piece::Slot(input) => {
                    write!(text, "{}", self.slots.get(input).copied().flatten().unwrap_or(input))
                }
                Piece::Workgroup => write!(text, "{}", self.reading.sides()),
                Piece::Store => write!(text, "{FOLLOW}"),
                Piece::Load if self.is_held => write!(text, "pair_held("),
                Piece::Text(_) | Piece::Name(_) | Piece::Load => write!(text, "{}", piece.text()),
            };
        }
    }
}

/// The textures that are read, so far.
struct Bindings {
    text: String,
    count: usize,
}

impl Bindings {
    /// Binds the textures of the kernel at this place. Returns the arguments of its function of single pixels, each with a
    /// comma before it, and the slots of its inputs.
    fn of(&mut self, link: &Link, place: usize) -> (String, Vec<Option<usize>>) {
        let (mut arguments, mut slots) = (String::new(), Vec::new());
        let around = link.kernel.fusible.around().unwrap_or_default();
        for (input, (name, value)) in link.kernel.pieces.textures.iter().zip(&link.values).enumerate() {
            if let Some(place) = value {
                let _ = write!(arguments, ", value_{place}");
                slots.push(None);
                continue;
            }
            let slot = self.count;
            let name = if place == 0 { (*name).to_owned() } else { format!("{name}_{place}") };
            let _ = writeln!(self.text, "@group(0) @binding({}) var {name}: texture_2d<f32>;", slot + 2);
            if !around.contains(&input) {
                let _ = write!(arguments, ", fetch({name}, {slot}u, pixel(id))");
            }
            slots.push(Some(slot));
            self.count += 1;
        }
        (arguments, slots)
    }
}

/// Contents of a window at first: what the pass before reads, as far around as it reads. Later it holds what rows sum, and
/// then their sums.
const HOLDING: &str = "
var<private> pair_corner: vec2i;
var<private> pair_stride: i32;

// Loads the part of the picture of `size` from `first` on that the invocations of a workgroup need.
fn pair_hold(first: vec2i, size: vec2i, index: i32) {
    pair_corner = first - grid.halo;
    pair_stride = size.x + 2 * grid.halo.x;
    let count = pair_stride * (size.y + 2 * grid.halo.y);
    for (var i = index; i < count; i += 256) {
        pair_window[i] = fetch(source, 0u, pair_corner + vec2i(i % pair_stride, i / pair_stride));
    }
    workgroupBarrier();
}

fn pair_held(p: vec2i) -> vec4f {
    let at = p - pair_corner;
    return pair_window[at.y * pair_stride + at.x];
}

";

/// Where the pass before reads another level, or there is none.
const HOLDING_NOTHING: &str = "
fn pair_hold(first: vec2i, size: vec2i, index: i32) {
}

";

/// A value as it would be read from a texture with so many channels.
fn stored(value: &str, channels: u32) -> String {
    match channels {
        1 => format!("vec4f(({value}).x, 0.0, 0.0, 1.0)"),
        2 => format!("vec4f(({value}).xy, 0.0, 1.0)"),
        _ => value.to_owned(),
    }
}
