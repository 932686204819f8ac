//! A shader's text put together from its files.

use crate::directives::{Bindings, Directive};
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

/// Attribute of entry points: the engine decides on the sides of workgroups, so that kernels need not.
pub const ENTRY: &str = "@compute @workgroup_size(8, 8)\n";

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
    /// Reads the shader at `path`, with what its directives stand for: `#import folder/name` for the file
    /// `folder/name.wgsl` of the folder `shaders`, `#insert` for the statements of one, the others for what is bound. The
    /// function `main` becomes the entry point where it has no attribute of its own.
    ///
    /// # Errors
    /// Which file cannot be read, and on which line a directive is malformed or out of order.
    pub fn read(shaders: &Path, path: &Path) -> Result<Self, String> {
        let mut text = Self::default();
        let mut bindings = Bindings::default();
        for (number, line) in (1..).zip(read(path)?.lines()) {
            let at_line = |fault| format!("line {number}: {fault}");
            match Directive::read(line).map_err(at_line)? {
                Some(Directive::Import(name)) => text.import(shaders, name)?,
                Some(Directive::Insert(name)) => {
                    text.own.push_str(&inserted(shaders, name).map_err(at_line)?)
                }
                Some(directive) => text.own.push_str(&bindings.declare(directive).map_err(at_line)?),
                None => {
                    let has_attribute = || text.own.lines().last().is_some_and(|line| line.starts_with('@'));
                    if line.starts_with("fn main(") && !has_attribute() {
                        text.own.push_str(ENTRY);
                    }
                    text.own.extend([line, "\n"]);
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
            if let Ok(Some(Directive::Import(inner))) = Directive::read(line) {
                self.import(shaders, inner)?;
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
/// When it cannot be read, and on which line it has a directive that is no import.
pub fn imported(shaders: &Path, name: &str) -> Result<String, String> {
    let mut text = String::new();
    for (number, line) in (1..).zip(read(&shaders.join(format!("{name}.wgsl")))?.lines()) {
        let at_line = |fault| format!("shaders/{name}.wgsl: line {number}: {fault}");
        match Directive::read(line).map_err(at_line)? {
            Some(Directive::Import(_)) => {}
            Some(_) => return Err(at_line(format!("`{line}` is for kernels, which bind what they read"))),
            None => text.extend([line, "\n"]),
        }
    }
    Ok(text)
}

/// The statements that `#insert` stands for: the text of a file after its head, which an empty line ends.
///
/// # Errors
/// When it cannot be read, or has no head.
fn inserted(shaders: &Path, name: &str) -> Result<String, String> {
    let text = read(&shaders.join(format!("{name}.wgsl")))?;
    let (_, statements) =
        text.split_once("\n\n").ok_or_else(|| format!("shaders/{name}.wgsl has no head"))?;
    Ok(statements.to_owned())
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
