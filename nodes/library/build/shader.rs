//! One shader: its text put together, validated, and what it says about itself.

use crate::filtered::filtered_inputs;
use crate::imports::{AT_PLACE, ENTRY, OF_PIXEL, STORE, Text};
use crate::pieces::{self, Cut, Own};
use crate::uniform::Block;
use naga::front::wgsl::{Frontend, Options};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{ImageClass, Module, StorageFormat, TypeInner};
use std::fmt::Write as _;
use std::path::Path;

/// Findings of reflection in one shader.
pub struct Shader {
    /// The complete WGSL module.
    pub source: String,
    /// Names of what it imports, in order.
    pub imports: Vec<String>,
    /// Its own text in pieces, as Rust has them.
    pub own: Vec<String>,
    /// The pieces of an entry point that was written for it.
    pub entry: Vec<String>,
    /// Names of the textures that it reads.
    pub textures: Vec<String>,
    /// Part that it can take in a dispatch of several.
    pub fusible: Fusible,
    /// The struct of its uniform block.
    pub struct_params: Option<StructParams>,
    /// Inputs that are interpolated by functions of which there are filtered ones.
    pub filtered: Vec<usize>,
    /// The input of which its windows hold pixels as they are.
    pub windowed: Option<usize>,
    /// Channels of the storage textures.
    pub outputs: Vec<u32>,
    /// The uniform block at binding 1; kernels without parameters have none.
    pub params: Option<Block>,
}

/// The struct of a uniform block in the text of its shader.
pub struct StructParams {
    /// Number of pieces before it.
    pub before: usize,
    /// Number of its pieces.
    pub pieces: usize,
    /// Its text.
    pub text: String,
}

/// Part that a kernel can take in a dispatch of several, but for windows.
pub enum Fusible {
    /// None.
    Never,
    /// The first.
    First,
    /// Before the window of another kernel, by so many of its first pieces.
    BeforeWindow(usize),
    /// Any; the inputs that it reads itself.
    SinglePixels(Vec<usize>),
}

impl Shader {
    /// Reads the shader at `path`, with what it imports from the folder `shaders`.
    ///
    /// # Errors
    /// Fault, as naga words it, or the rule of the house that it breaks.
    pub fn read(shaders: &Path, path: &Path) -> Result<Self, String> {
        let text = Text::read(shaders, path)?;
        let source = format!("{}{}", text.shared, text.own);
        let module = parse(&source)?;
        let found = Own::new(&module, &text.shared, &text.own);
        let around = found.has_function(OF_PIXEL).then(|| found.around());
        let entry =
            around.as_ref().map(|around| entry_point(&text, &found.textures(), around)).transpose()?;
        let entry = entry.unwrap_or_default();
        let source = source + &entry;
        let whole = (!entry.is_empty()).then(|| parse(&source)).transpose()?;
        let (inputs, outputs, params) = bindings(whole.as_ref().unwrap_or(&module))?;
        let textures = found.textures();
        if textures.len() != inputs {
            return Err("textures are declared by the kernel itself".into());
        }
        let cut = found.cut(around.is_some())?;
        let fusible = match around {
            Some(around) if outputs.len() == 1 => Fusible::SinglePixels(around),
            Some(_) => return Err(format!("a shader with `{OF_PIXEL}` has one result")),
            None => fusible(&text.own, &found, &cut, outputs.len())?,
        };
        let struct_params = found.block().map(|place| {
            let [before, end] = [place.start, place.end].map(|at| cut.before(at));
            StructParams { before, pieces: end - before, text: text.own[place].to_owned() }
        });
        let rust = |pieces: &[pieces::Piece<'_>]| pieces.iter().map(|piece| format!("{piece:?}")).collect();
        Ok(Self {
            own: rust(&cut.pieces),
            entry: rust(&pieces::entry(&entry)),
            fusible,
            struct_params,
            filtered: filtered_inputs(&text.own, &textures, shaders, &text.imports)?,
            windowed: windowed(&text.own, &textures),
            textures: textures.into_iter().map(str::to_owned).collect(),
            source,
            imports: text.imports,
            outputs,
            params,
        })
    }
}

/// Parses and validates a module.
///
/// # Errors
/// The words of naga.
pub fn parse(source: &str) -> Result<Module, String> {
    let mut options = Options::new();
    options.parse_doc_comments = true;
    let module = Frontend::new_with_options(options).parse(source).map_err(|e| e.emit_to_string(source))?;
    // Exactly what every WebGPU device can do: no optional capability.
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|e| e.emit_to_string(source))?;
    Ok(module)
}

/// Part that a kernel with an entry point of its own can take.
fn fusible(text: &str, own: &Own<'_>, cut: &Cut<'_>, outputs: usize) -> Result<Fusible, String> {
    let stores_once = text.matches("textureStore(").count() == 1 && text.contains(STORE) && outputs == 1;
    match own.workgroup() {
        _ if !own.has_function(AT_PLACE) => Ok(if stores_once { Fusible::First } else { Fusible::Never }),
        Some(at) if stores_once && own.textures() == ["source"] => Ok(Fusible::BeforeWindow(cut.before(at))),
        _ => Err(format!(
            "a shader with `{AT_PLACE}` reads `source` alone and stores by `{STORE}` in one place"
        )),
    }
}

/// The input of which a shader's windows hold pixels as they are; its textures by their names.
fn windowed(own: &str, textures: &[&str]) -> Option<usize> {
    let (_, rest) = own.split_once("fn window_tap(p: vec2i) -> vec4f {\n    return fetch(")?;
    let (texture, rest) = rest.split_once(", ")?;
    let slot = textures.iter().position(|name| *name == texture)?;
    rest.starts_with(&format!("{slot}u, p);\n}}")).then_some(slot)
}

/// The entry point of a shader that computes each pixel from the same pixel of its textures.
fn entry_point(text: &Text, textures: &[&str], around: &[usize]) -> Result<String, String> {
    if text.shared.contains("params") {
        return Err(format!("what a shader with `{OF_PIXEL}` imports must not know of parameters"));
    }
    if textures.is_empty() {
        return Err(format!("a shader with `{OF_PIXEL}` reads at least one texture"));
    }
    let mut arguments = String::new();
    for (slot, name) in textures.iter().enumerate().filter(|(slot, _)| !around.contains(slot)) {
        let _ = write!(arguments, ", fetch({name}, {slot}u, pixel(id))");
    }
    Ok(format!(
        "\n{ENTRY}fn main(@builtin(global_invocation_id) id: vec3u) {{\n    \
         if outside(id) {{\n        return;\n    }}\n    \
         {STORE}{OF_PIXEL}(id{arguments}));\n}}\n"
    ))
}

/// Sampled textures, channels of the storage textures and the uniform block of a module.
fn bindings(module: &Module) -> Result<(usize, Vec<u32>, Option<Block>), String> {
    let [entry] = module.entry_points.as_slice() else {
        return Err(format!("a kernel has exactly one entry point, or `{OF_PIXEL}` in its place"));
    };
    if entry.name != "main" || entry.workgroup_size != [8, 8, 1] {
        return Err("the entry point must be `main` with @workgroup_size(8, 8)".into());
    }
    let mut bindings: Vec<_> =
        module.global_variables.iter().filter_map(|(_, v)| v.binding.map(|b| (b.binding, v.ty))).collect();
    bindings.sort();
    // The grid and the parameters; the place of parameters that a kernel has not stays empty.
    let textures = bindings.iter().filter(|(binding, _)| *binding > 1).zip(2..);
    if let Some(((binding, _), expected)) =
        textures.clone().find(|((binding, _), expected)| binding != expected)
    {
        return Err(format!("textures must be bound at 2, 3, ...: {expected} is missing before {binding}"));
    }
    if bindings.first().is_none_or(|(binding, _)| *binding != 0) {
        return Err("a kernel needs the grid, shaders/gpu/grid.wgsl".into());
    }
    let params = bindings.iter().find(|(binding, _)| *binding == 1);
    let params = params.map(|(_, ty)| Block::read(module, *ty)).transpose()?;
    let (mut inputs, mut outputs) = (0, Vec::new());
    for ((binding, ty), _) in textures {
        match &module.types[*ty].inner {
            TypeInner::Image { class: ImageClass::Sampled { .. }, .. } if outputs.is_empty() => inputs += 1,
            TypeInner::Image { class: ImageClass::Storage { format, .. }, .. } => {
                outputs.push(match format {
                    StorageFormat::R32Float => 1,
                    StorageFormat::Rg32Float => 2,
                    StorageFormat::Rgba32Float => 4,
                    other => return Err(format!("storage format {other:?} is not portable enough")),
                });
            }
            other => return Err(format!("binding {binding} is not allowed to be {other:?}")),
        }
    }
    if outputs.is_empty() {
        return Err("a kernel needs at least one output".into());
    }
    Ok((inputs, outputs, params))
}
