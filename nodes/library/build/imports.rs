//! A shader's text put together from its files.

use std::fs;
use std::path::Path;

/// Group and stem of a file.
pub type Name = (String, String);

/// Folder of what several shaders share, and of its twins in Rust.
pub const SHARED: &str = "shared";

/// Folder of what only GPUs need, such as where a texture lies in the picture, and functions for devices that filter, under the
/// stems of `shared`; it has no twins.
pub const GPU: &str = "gpu";

/// The function that a shader has in the place of an entry point when each pixel of its result depends on the same
/// pixel of its textures alone.
pub const OF_PIXEL: &str = "of_pixel";

/// The function of a shader that can be computed anywhere for the window of another kernel.
pub const AT_PLACE: &str = "at_place";

/// Storage of a result by shaders that others can follow in the same pass.
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

/// Import in the place of another where windows hold 16-bit floats: the file of its name with `_half` behind it; none where
/// there is no such file.
///
/// # Errors
/// When it cannot be read.
pub fn packed(shaders: &Path, name: &str) -> Result<Option<String>, String> {
    let name = format!("{name}_half");
    let is_there = shaders.join(format!("{name}.wgsl")).exists();
    is_there.then(|| imported(shaders, &name)).transpose()
}

/// The text of a file.
///
/// # Errors
/// That it cannot be read.
pub fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| format!("cannot read {}: {e}", path.display()))
}
