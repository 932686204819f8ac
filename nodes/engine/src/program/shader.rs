//! Shaders of dispatches: that of a kernel as it is, or one that does the work of several.

use super::format::Format;
use crate::kernel::{Import, Kernel};
use std::borrow::Cow;
use std::collections::HashSet;
use std::fmt::Write as _;

/// A shader, as data: it may come from this library's kernels or, through the C ABI, from another's.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Shader {
    /// Name of the kernel, or of several with a plus between them; those that write 16-bit floats have `/half` behind, those
    /// that interpolate by a sampler `/filtered`. Shaders of one name are the same.
    pub name: Cow<'static, str>,
    /// Complete WGSL module, entry point `main`.
    pub source: Cow<'static, str>,
    /// Number of sampled textures.
    pub inputs: usize,
    /// Formats of the storage textures.
    pub outputs: Cow<'static, [Format]>,
    /// Size of the uniform block at binding 1, in bytes; 0 for none.
    pub params_size: usize,
    /// Sampled textures that are read through the sampler at [`SAMPLER_BINDING`](crate::kernel::SAMPLER_BINDING); without
    /// any there is no such binding.
    pub filtered: Cow<'static, [usize]>,
}

/// A kernel among those of a dispatch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub kernel: &'static Kernel,
    /// Of the inputs of a kernel that follows another: the one that the other has computed.
    pub taken: usize,
}

/// The entry of a text that stores a result, up to the value.
const STORE: &str = "textureStore(target_image, vec2i(id.xy), ";

/// What takes its place where other kernels follow.
const FOLLOW: &str = "follow(id, ";

/// What takes its place where 16-bit floats are stored.
const STORE_HALF: &str = "store_half(id, ";

/// The nearest value that 16-bit floats can hold.
const HALF: &str = "nearest_half(value)";

/// Devices may cut bits off instead of rounding, which adds up from pass to pass, and may make what is too large infinite.
/// Ties go to even.
const NEAREST_HALF: &str = "
fn nearest_half(value: vec4f) -> vec4f {
    let bits = bitcast<vec4u>(clamp(value, vec4f(-65504.0), vec4f(65504.0)));
    return bitcast<vec4f>((bits + 0xfffu + ((bits >> vec4u(13u)) & vec4u(1u))) & vec4u(0xffffe000u));
}
";

impl Shader {
    /// That of one kernel, which writes `outputs` and interpolates by a sampler if `is_filtered`.
    pub(super) fn of(kernel: &'static Kernel, outputs: &[Format], is_filtered: bool) -> Self {
        let is_half = outputs.contains(&Format::Rgba16);
        let source = if is_filtered { filtered_source(kernel).into() } else { Cow::Borrowed(kernel.shader) };
        Self {
            name: match variant(is_half, is_filtered) {
                "" => Cow::Borrowed(kernel.name),
                variant => format!("{}{variant}", kernel.name).into(),
            },
            source: if is_half { stored_as(&source, outputs).into() } else { source },
            inputs: kernel.inputs,
            outputs: outputs.to_vec().into(),
            params_size: kernel.params_size,
            filtered: if is_filtered { kernel.parts.filtered.into() } else { Cow::Borrowed(&[]) },
        }
    }

    /// That of kernels which follow one another: the last writes `output`, the first interpolates by a sampler if
    /// `is_filtered`.
    pub(super) fn of_chain(links: &[Link], output: Format, is_filtered: bool) -> Self {
        let mut name = String::new();
        for (place, link) in links.iter().enumerate() {
            let _ = write!(name, "{}{}", if place > 0 { "+" } else { "" }, link.kernel.name);
            if place > 0 && link.taken > 0 {
                let _ = write!(name, "@{}", link.taken);
            }
        }
        name.push_str(variant(output == Format::Rgba16, is_filtered));
        let kernels = || links.iter().map(|link| link.kernel);
        let inputs = kernels().map(|kernel| kernel.inputs).sum::<usize>() + 1 - links.len();
        let params_size = kernels().map(|kernel| padded(kernel.params_size)).sum();
        Self {
            name: name.into(),
            source: chained(links, inputs, output, is_filtered).into(),
            inputs,
            outputs: vec![output].into(),
            params_size,
            filtered: match links.first() {
                Some(link) if is_filtered => link.kernel.parts.filtered.into(),
                _ => Cow::Borrowed(&[]),
            },
        }
    }
}

/// What stands behind the names of shaders that differ from those of their kernels.
fn variant(is_half: bool, is_filtered: bool) -> &'static str {
    match (is_half, is_filtered) {
        (false, false) => "",
        (true, false) => "/half",
        (false, true) => "/filtered",
        (true, true) => "/half/filtered",
    }
}

/// The module of a kernel that interpolates by a sampler.
fn filtered_source(kernel: &Kernel) -> String {
    let imports = kernel.parts.imports.iter().map(|import| import.filtered.unwrap_or(import.text));
    imports.chain([kernel.parts.own]).collect()
}

/// The size of a uniform block among several: each begins at a multiple of 16 bytes.
pub(super) fn padded(size: usize) -> usize {
    size.next_multiple_of(16)
}

/// A module whose storage textures have these formats in place of those of 32-bit floats.
fn stored_as(source: &str, outputs: &[Format]) -> String {
    const TYPE: &str = "texture_storage_2d<";
    let mut parts = source.split(TYPE);
    let mut text = parts.next().unwrap_or_default().to_owned();
    let mut outputs = outputs.iter();
    for part in parts {
        let rest = part.split_once(',').map_or(part, |(_, rest)| rest);
        let format = outputs.next().map_or("", |format| format.wgsl());
        let _ = write!(text, "{TYPE}{format},{rest}");
    }
    if text.contains(STORE) {
        text = text.replace(STORE, STORE_HALF);
        let _ = write!(
            text,
            "{NEAREST_HALF}\nfn store_half(id: vec3u, value: vec4f) {{\n    {STORE}{HALF});\n}}\n"
        );
    }
    text
}

/// The module of kernels that follow one another. What those after the first declare gets the number of their place behind
/// its name, so that two may use the same names.
fn chained(links: &[Link], inputs: usize, output: Format, is_filtered: bool) -> String {
    let mut text = String::new();
    let mut known: HashSet<&str> = HashSet::new();
    let imports = links.iter().flat_map(|link| link.kernel.parts.imports);
    for Import { text: loaded, filtered, .. } in imports.filter(|import| known.insert(import.name)) {
        // Only what the first kernel imports may know of its parameters.
        for line in filtered.filter(|_| is_filtered).unwrap_or(loaded).lines() {
            rename(line, &mut text, |word| (word == "params").then(|| "uniforms.params_0".to_owned()));
            text.push('\n');
        }
    }
    text.push_str(&uniforms(links));
    let mut binding = 2;
    let mut following = String::new();
    for (place, link) in links.iter().enumerate() {
        let own = Own::new(link.kernel.parts.own, place);
        let mut arguments = String::new();
        for (input, name) in own.textures.iter().enumerate() {
            if place > 0 && input == link.taken {
                arguments.push_str(", value");
                continue;
            }
            let _ = writeln!(text, "@group(0) @binding({binding}) var {name}: texture_2d<f32>;");
            let _ = write!(arguments, ", fetch({name}, {}u, pixel(id))", binding - 2);
            binding += 1;
        }
        let name = if place == 0 { "of_pixel".to_owned() } else { format!("of_pixel_{place}") };
        let call = format!("{name}(id{arguments})");
        if place > 0 {
            let _ = writeln!(following, "    value = {};", stored(&call, link.kernel.outputs[0]));
        } else if link.kernel.parts.is_per_pixel {
            text.push_str(&entry_point(&call));
        }
        text.push_str(&own.text);
        if place == 0 {
            let value = stored("first", link.kernel.outputs[0]);
            let _ = writeln!(following, "    var value = {value};");
        }
    }
    let _ = write!(
        text,
        "@group(0) @binding({}) var target_image: texture_storage_2d<{}, write>;\n\n\
         fn follow(id: vec3u, first: vec4f) {{\n{following}    {STORE}{});\n}}\n",
        inputs + 2,
        output.wgsl(),
        if output == Format::Rgba16 { HALF } else { "value" },
    );
    if output == Format::Rgba16 {
        text.push_str(NEAREST_HALF);
    }
    text
}

/// The entry point of a chain whose first kernel computes single pixels.
fn entry_point(call: &str) -> String {
    format!(
        "@compute @workgroup_size(8, 8)\nfn main(@builtin(global_invocation_id) id: vec3u) {{\n    \
         if !outside(id) {{\n        {FOLLOW}{call});\n    }}\n}}\n"
    )
}

/// A value as it would be read from a texture with so many channels.
fn stored(value: &str, channels: u32) -> String {
    match channels {
        1 => format!("vec4f(({value}).x, 0.0, 0.0, 1.0)"),
        2 => format!("vec4f(({value}).xy, 0.0, 1.0)"),
        _ => value.to_owned(),
    }
}

/// One uniform block with the blocks of all kernels, if any has one.
fn uniforms(links: &[Link]) -> String {
    let places = || links.iter().enumerate().filter(|(_, link)| link.kernel.params_size > 0);
    if places().next().is_none() {
        return String::new();
    }
    let mut text = String::from("struct Uniforms {\n");
    for (place, _) in places() {
        let _ = writeln!(text, "    @align(16) params_{place}: Params_{place},");
    }
    text.push_str("}\n@group(0) @binding(1) var<uniform> uniforms: Uniforms;\n");
    text
}

/// A kernel's own text among those of others.
struct Own {
    /// Without bindings, and with other names for what it declares.
    text: String,
    /// The new names of the textures that it reads, in their order.
    textures: Vec<String>,
}

impl Own {
    fn new(own: &str, place: usize) -> Self {
        // The first kernel keeps its names, by which what it imports may call it; only its parameters lie elsewhere.
        let declared: HashSet<&str> = match place {
            0 => ["params", "Params"].into(),
            _ => own.lines().filter_map(declared).filter(|name| *name != "target_image").collect(),
        };
        let bindings = || own.lines().filter(|line| line.starts_with("@group"));
        let read = bindings().filter(|line| line.ends_with("texture_2d<f32>;")).filter_map(declared_name);
        let renamed = |name: &str| if place == 0 { name.to_owned() } else { format!("{name}_{place}") };
        let textures = read.map(renamed).collect();
        let mut text = String::with_capacity(own.len() * 2);
        let mut is_struct = false;
        for line in own.lines().filter(|line| !line.starts_with("@group")) {
            is_struct = line.starts_with("struct ") || is_struct && line != "}";
            // The fields of a struct keep their names.
            let (field, line) = match line.find(':').filter(|_| is_struct && line.starts_with(' ')) {
                Some(at) => line.split_at(at),
                None => ("", line),
            };
            text.push_str(field);
            rename(line, &mut text, |word| match word {
                "params" if declared.contains(word) => Some(format!("uniforms.params_{place}")),
                _ => declared.contains(word).then(|| format!("{word}_{place}")),
            });
            text.push('\n');
        }
        Self { text: text.replace(STORE, FOLLOW), textures }
    }
}

/// The name that a line declares for the whole module, if it does.
fn declared(line: &str) -> Option<&str> {
    let is_declaration = ["fn ", "struct ", "const ", "override ", "var<", "alias ", "@group"];
    is_declaration.iter().any(|start| line.starts_with(start)).then(|| declared_name(line)).flatten()
}

fn declared_name(line: &str) -> Option<&str> {
    let rest =
        ["fn ", "struct ", "const ", "override ", "alias "].iter().find_map(|start| line.strip_prefix(start));
    // Variables may have an address space before their name.
    let rest =
        rest.or_else(|| line.split_once("var<").and_then(|(_, rest)| rest.split_once("> ")).map(|(_, r)| r));
    let rest = rest.or_else(|| line.split_once(" var ").map(|(_, rest)| rest))?;
    rest.split(|c: char| !is_letter(c)).next().filter(|name| !name.is_empty())
}

fn is_letter(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// Appends `line` to `text` with other words where `other` has one, but for fields of structs and comments.
fn rename(line: &str, text: &mut String, other: impl Fn(&str) -> Option<String>) {
    let (code, comment) = line.find("//").map_or((line, ""), |at| line.split_at(at));
    let mut rest = code;
    while let Some(start) = rest.find(is_letter) {
        let (before, word) = rest.split_at(start);
        let end = word.find(|c| !is_letter(c)).unwrap_or(word.len());
        let (word, after) = word.split_at(end);
        text.push_str(before);
        let is_field = before.ends_with('.') || (before.is_empty() && text.ends_with('.'));
        match other(word).filter(|_| !is_field) {
            Some(new) => text.push_str(&new),
            None => text.push_str(word),
        }
        rest = after;
    }
    text.push_str(rest);
    text.push_str(comment);
}
