//! A shader's text put together from its files.

use std::fs;
use std::path::{Path, PathBuf};

/// The text at `path`, every line `#import folder/name` in it replaced by `folder/name.wgsl` of the folder `shaders`;
/// each file once.
///
/// # Errors
/// Which file cannot be read.
pub fn assembled(shaders: &Path, path: &Path) -> Result<String, String> {
    let mut text = String::new();
    include(shaders, path, &mut Vec::new(), &mut text)?;
    Ok(text)
}

fn include(shaders: &Path, path: &Path, done: &mut Vec<PathBuf>, text: &mut String) -> Result<(), String> {
    if done.iter().any(|d| d == path) {
        return Ok(());
    }
    done.push(path.to_owned());
    let own = fs::read_to_string(path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    for line in own.lines() {
        if let Some(name) = line.strip_prefix("#import ") {
            include(shaders, &shaders.join(format!("{}.wgsl", name.trim())), done, text)?;
        } else {
            text.push_str(line);
            text.push('\n');
        }
    }
    Ok(())
}
