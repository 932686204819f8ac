//! A shader's text put together from its files.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// The function that a shader has in the place of an entry point when each pixel of its result depends on the same
/// pixel of its textures alone.
pub const OF_PIXEL: &str = "of_pixel";

/// How a result is stored by shaders that others can follow in the same pass.
pub const STORE: &str = "textureStore(target_image, vec2i(id.xy), ";

/// A shader's text and what it imports.
#[derive(Default)]
pub struct Text {
    /// Names of what it imports, `folder/name`, each after what it uses itself.
    pub imports: Vec<String>,
    /// Their texts, in that order.
    pub shared: String,
    /// Its own text.
    pub own: String,
}

impl Text {
    /// Reads the shader at `path`, with what it imports from the folder `shaders`: every line `#import folder/name`
    /// stands for `folder/name.wgsl`.
    ///
    /// # Errors
    /// Which file cannot be read.
    pub fn read(shaders: &Path, path: &Path) -> Result<Self, String> {
        let mut text = Self::default();
        for line in read(path)?.lines() {
            match line.strip_prefix("#import ") {
                Some(name) => text.import(shaders, name.trim())?,
                None => {
                    text.own.push_str(line);
                    text.own.push('\n');
                }
            }
        }
        Ok(text)
    }

    /// Adds what is imported as `folder/name`, after all that it imports itself; each once.
    fn import(&mut self, shaders: &Path, name: &str) -> Result<(), String> {
        if self.imports.iter().any(|known| known == name) {
            return Ok(());
        }
        for line in read(&shaders.join(format!("{name}.wgsl")))?.lines() {
            if let Some(inner) = line.strip_prefix("#import ") {
                self.import(shaders, inner.trim())?;
            }
        }
        self.imports.push(name.to_owned());
        self.shared.push_str(&imported(shaders, name)?);
        Ok(())
    }

    /// Whether it computes each pixel from the same pixel of its textures.
    pub fn is_per_pixel(&self) -> bool {
        self.own.contains(&format!("fn {OF_PIXEL}("))
    }

    /// The textures, by their slots, that a shader of single pixels reads itself: those that have a constant for their slot.
    pub fn around(&self) -> Vec<usize> {
        let has_constant =
            |name: &str| self.own.contains(&format!("\nconst INPUT_{}: u32 = ", name.to_uppercase()));
        sampled(&self.own).enumerate().filter(|(_, name)| has_constant(name)).map(|(slot, _)| slot).collect()
    }

    /// The input of which its windows hold pixels as they are.
    pub fn windowed(&self) -> Option<usize> {
        let (_, rest) = self.own.split_once("fn window_tap(p: vec2i) -> vec4f {\n    return fetch(")?;
        let (texture, rest) = rest.split_once(", ")?;
        let slot = sampled(&self.own).position(|name| name == texture)?;
        rest.starts_with(&format!("{slot}u, p);\n}}")).then_some(slot)
    }

    /// The complete module, with an entry point for a shader of single pixels.
    ///
    /// # Errors
    /// The rule of the house that such a shader breaks.
    pub fn module(&self) -> Result<String, String> {
        let mut module = format!("{}{}", self.shared, self.own);
        if self.is_per_pixel() {
            if self.shared.contains("params") {
                return Err(format!("what a shader with `{OF_PIXEL}` imports must not know of parameters"));
            }
            module.push_str(&entry_point(&self.own, &self.around())?);
        }
        Ok(module)
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

/// What stands for an import where windows hold 16-bit floats: the file of its name with `_half` behind it; none where
/// there is no such file.
///
/// # Errors
/// When it cannot be read.
pub fn packed(shaders: &Path, name: &str) -> Result<Option<String>, String> {
    let name = format!("{name}_half");
    let is_there = shaders.join(format!("{name}.wgsl")).exists();
    is_there.then(|| imported(shaders, &name)).transpose()
}

/// Names of the textures that a shader's own text reads, in order.
pub fn sampled(own: &str) -> impl Iterator<Item = &str> {
    let names = own.lines().filter_map(|line| line.strip_suffix(": texture_2d<f32>;"));
    names.filter_map(|line| line.rsplit_once(" var ")).map(|(_, name)| name)
}

/// The text of a file.
///
/// # Errors
/// That it cannot be read.
pub fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| format!("cannot read {}: {e}", path.display()))
}

/// The entry point of a shader that computes each pixel from the same pixel of its textures.
fn entry_point(own: &str, around: &[usize]) -> Result<String, String> {
    let mut arguments = String::new();
    for (slot, name) in sampled(own).enumerate().filter(|(slot, _)| !around.contains(slot)) {
        let _ = write!(arguments, ", fetch({name}, {slot}u, pixel(id))");
    }
    if sampled(own).next().is_none() {
        return Err(format!("a shader with `{OF_PIXEL}` reads at least one texture"));
    }
    Ok(format!(
        "\n@compute @workgroup_size(8, 8)\nfn main(@builtin(global_invocation_id) id: vec3u) {{\n    \
         if outside(id) {{\n        return;\n    }}\n    \
         {STORE}{OF_PIXEL}(id{arguments}));\n}}\n"
    ))
}
