//! Functions for devices that interpolate by samplers, in the place of those of the shaders.

use crate::imports::{GPU, imported, read};
use std::path::Path;

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

/// The inputs that a shader's own text hands to functions of which there are filtered ones; its textures by their names.
pub fn filtered_inputs(
    own: &str,
    textures: &[&str],
    shaders: &Path,
    imports: &[String],
) -> Result<Vec<usize>, String> {
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
                let argument = call.split([',', ')']).next().unwrap_or_default();
                let slot = textures.iter().position(|texture| *texture == argument);
                inputs.push(slot.ok_or_else(|| format!("`{name}` must be given a texture by its name"))?);
            }
        }
    }
    inputs.sort_unstable();
    inputs.dedup();
    Ok(inputs)
}

/// The name of the function that a line begins.
fn function(line: &str) -> Option<&str> {
    line.strip_prefix("fn ").and_then(|rest| rest.split_once('(')).map(|(name, _)| name)
}

fn stem(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}
