//! One shader: its text put together, validated, and what it says about itself.

use crate::uniform::Block;
use naga::front::wgsl::{Frontend, Options};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{ImageClass, Module, StorageFormat, TypeInner};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// The function that a shader has in the place of an entry point when each pixel of its result depends on the same
/// pixel of its textures alone.
const OF_PIXEL: &str = "of_pixel";

/// The folder of what only GPUs need; files of a stem of `shared` hold functions for devices that filter.
const GPU: &str = "gpu";

/// How a result is stored by shaders that others can follow in the same pass.
const STORE: &str = "textureStore(target_image, vec2i(id.xy), ";

/// What reflection finds in one shader.
pub struct Shader {
    /// The complete WGSL module.
    pub source: String,
    /// Names of what it imports, in order.
    pub imports: Vec<String>,
    /// Its own text, without what it imports and without an entry point that was written for it.
    pub own: String,
    /// Whether it computes each pixel from the same pixel of its textures.
    pub is_per_pixel: bool,
    /// Inputs that are interpolated by functions of which there are filtered ones.
    pub filtered: Vec<usize>,
    /// Whether it stores its only result in one place, by the usual words.
    pub can_lead: bool,
    /// Number of sampled textures.
    pub inputs: usize,
    /// Channels of the storage textures.
    pub outputs: Vec<u32>,
    /// The uniform block at binding 1; kernels without parameters have none.
    pub params: Option<Block>,
}

/// Text and imports of one file and of all that it imports.
struct Text {
    imports: Vec<String>,
    shared: String,
    own: String,
}

impl Shader {
    /// Reads the shader at `path`, with what it imports from the folder `shaders`.
    ///
    /// # Errors
    /// What is wrong, as naga says it, or the rule of the house that it breaks.
    pub fn read(shaders: &Path, path: &Path) -> Result<Self, String> {
        let mut text = Text { imports: Vec::new(), shared: String::new(), own: String::new() };
        let own = read(path)?;
        for line in own.lines() {
            match line.strip_prefix("#import ") {
                Some(name) => text.import(shaders, name.trim())?,
                None => {
                    text.own.push_str(line);
                    text.own.push('\n');
                }
            }
        }
        let filtered = filtered_inputs(&text.own, shaders, &text.imports)?;
        let mut shader = text.reflect()?;
        shader.filtered = filtered;
        Ok(shader)
    }
}

/// The text of what shaders import by `name`, without its own imports, which stand before it.
///
/// # Errors
/// When it cannot be read.
pub fn imported(shaders: &Path, name: &str) -> Result<String, String> {
    let text = read(&shaders.join(format!("{name}.wgsl")))?;
    let lines = text.lines().filter(|line| !line.starts_with("#import "));
    Ok(lines.flat_map(|line| [line, "\n"]).collect())
}

/// That text with the functions of `shaders/gpu` of the same stem in the place of its own, for devices that filter; none
/// where there is no such file.
///
/// # Errors
/// When one of the files cannot be read.
pub fn filtered(shaders: &Path, name: &str) -> Result<Option<String>, String> {
    let path = shaders.join(GPU).join(format!("{}.wgsl", stem(name)));
    if !name.starts_with("shared/") || !path.exists() {
        return Ok(None);
    }
    let functions = read(&path)?;
    let mut text = imported(shaders, name)?;
    for name in functions.lines().filter_map(function) {
        let start = format!("\nfn {name}(");
        if let Some(at) = text.find(&start)
            && let Some(end) = text[at..].find("\n}\n")
        {
            text.replace_range(at..at + end + 2, "");
        }
    }
    Ok(Some(text + &functions))
}

/// The name of the function that a line begins.
fn function(line: &str) -> Option<&str> {
    line.strip_prefix("fn ").and_then(|rest| rest.split_once('(')).map(|(name, _)| name)
}

fn stem(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// The inputs that a shader's own text hands to functions of which there are filtered ones.
fn filtered_inputs(own: &str, shaders: &Path, imports: &[String]) -> Result<Vec<usize>, String> {
    let textures: Vec<&str> = sampled(own).collect();
    let mut inputs = Vec::new();
    for import in imports {
        let path = shaders.join(GPU).join(format!("{}.wgsl", stem(import)));
        if filtered(shaders, import)?.is_none() {
            continue;
        }
        let plain = imported(shaders, import)?;
        let functions = read(&path)?;
        // What the text itself does not have is a helper.
        for name in
            functions.lines().filter_map(function).filter(|name| plain.contains(&format!("\nfn {name}(")))
        {
            for call in own.split(&format!("{name}(")).skip(1) {
                let argument = call.split(',').next().unwrap_or_default();
                let slot = textures.iter().position(|texture| *texture == argument);
                inputs.push(slot.ok_or_else(|| format!("`{name}` must be given a texture by its name"))?);
            }
        }
    }
    inputs.sort_unstable();
    inputs.dedup();
    Ok(inputs)
}

/// Names of the textures that a shader's own text reads, in order.
fn sampled(own: &str) -> impl Iterator<Item = &str> {
    let names = own.lines().filter_map(|line| line.strip_suffix(": texture_2d<f32>;"));
    names.filter_map(|line| line.rsplit_once(" var ")).map(|(_, name)| name)
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| format!("cannot read {}: {e}", path.display()))
}

impl Text {
    /// Adds what is imported as `folder/name`, after all that it imports itself; each once.
    fn import(&mut self, shaders: &Path, name: &str) -> Result<(), String> {
        if self.imports.iter().any(|known| known == name) {
            return Ok(());
        }
        let path: PathBuf = shaders.join(format!("{name}.wgsl"));
        for line in read(&path)?.lines() {
            if let Some(inner) = line.strip_prefix("#import ") {
                self.import(shaders, inner.trim())?;
            }
        }
        self.imports.push(name.to_owned());
        self.shared.push_str(&imported(shaders, name)?);
        Ok(())
    }

    fn reflect(self) -> Result<Shader, String> {
        let Self { imports, shared, own } = self;
        let is_per_pixel = own.contains(&format!("fn {OF_PIXEL}("));
        let mut source = format!("{shared}{own}");
        if is_per_pixel && shared.contains("params") {
            return Err(format!("what a shader with `{OF_PIXEL}` imports must not know of parameters"));
        }
        if is_per_pixel {
            source.push_str(&entry_point(&own)?);
        }
        let mut options = Options::new();
        options.parse_doc_comments = true;
        let module =
            Frontend::new_with_options(options).parse(&source).map_err(|e| e.emit_to_string(&source))?;
        // Exactly what every WebGPU device can do: no optional capability.
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .map_err(|e| e.emit_to_string(&source))?;
        let stores = own.matches("textureStore(").count();
        let can_lead = is_per_pixel || stores == 1 && own.contains(STORE);
        let (inputs, outputs, params) = bindings(&module)?;
        let can_lead = can_lead && outputs.len() == 1;
        let filtered = Vec::new();
        Ok(Shader { source, imports, own, is_per_pixel, filtered, can_lead, inputs, outputs, params })
    }
}

/// The entry point of a shader that computes each pixel from the same pixel of its textures.
fn entry_point(own: &str) -> Result<String, String> {
    let mut arguments = String::new();
    for (slot, name) in sampled(own).enumerate() {
        let _ = write!(arguments, ", fetch({name}, {slot}u, p)");
    }
    if arguments.is_empty() {
        return Err(format!("a shader with `{OF_PIXEL}` reads at least one texture"));
    }
    Ok(format!(
        "\n@compute @workgroup_size(8, 8)\nfn main(@builtin(global_invocation_id) id: vec3u) {{\n    \
         if outside(id) {{\n        return;\n    }}\n    let p = pixel(id);\n    \
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
