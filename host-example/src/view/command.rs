//! The command line that gives the picture that is shown.

use std::path::{Path, PathBuf};

use super::reel::Reel;
use super::session::Session;
use crate::apply::space::srgb_encode;
use crate::render::background::Background;
use crate::stylize::lengths::Lengths;

/// The command line, quoted for a shell.
pub fn line(session: &Session) -> String {
    let look = session.seen();
    let style = look.rebuilt().map_or_else(|| quoted_path(&look.source), quoted);
    let mut words = vec!["isophote".to_owned()];
    let input = session.file.as_deref().map_or_else(|| "SCENE.gltf".into(), quoted_path);
    match &session.reel {
        Some(reel) => {
            words.extend(["apply".to_owned(), style, input]);
            words.push(quoted_path(&output(reel)));
        }
        None => {
            words.extend(["render".to_owned(), input, "picture.png".to_owned()]);
            words.extend(staging(session).iter().map(|word| quoted(word)));
            if !look.is_plain() {
                words.push(format!("--style {style}"));
            }
        }
    }
    let knobs = look.knobs(&session.library).unwrap_or_default();
    words.extend(look.settings(&knobs).iter().map(|setting| format!("--set {}", quoted(setting))));
    if look.preset.lengths == Some(Lengths::Pixels) {
        words.push("--lengths pixels".into());
    }
    words.join(" ")
}

/// A name for the result beside the input.
pub fn output(reel: &Reel) -> PathBuf {
    let path = reel.path();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    // The place of a sequence's numbers stays at the end.
    let name = match stem.split_once('.') {
        Some((name, number)) => format!("{name}-look.{number}"),
        None => format!("{stem}-look"),
    };
    let known = ["png", "jpg", "jpeg", "tif", "tiff", "exr"];
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let is_kept = known.contains(&extension.as_str()) || reel.frames().is_some();
    path.with_file_name(format!("{name}.{}", if is_kept { &extension } else { "png" }))
}

/// Options of `render` for size, camera and light, where they are not as they are without being asked for.
pub fn staging(session: &Session) -> Vec<String> {
    let [_, area] = session.easel.halves();
    let mut words = vec!["--size".to_owned(), format!("{}x{}", area.width as u32, area.height as u32)];
    let Some(scenery) = &session.scenery else { return words };
    let mut add = |option: &str, value: String| words.extend([option.to_owned(), value]);
    match scenery.camera() {
        Some(node) => {
            let index = scenery.cameras().into_iter().position(|(known, _)| known == node);
            if let Some(index) = index.filter(|index| *index > 0) {
                add("--camera", index.to_string());
            }
        }
        None => {
            let [azimuth, elevation, distance] = scenery.framed(area.width / area.height);
            add("--azimuth", format!("{azimuth:.2}"));
            add("--elevation", format!("{elevation:.2}"));
            add("--distance", format!("{distance:.4}"));
        }
    }
    if let Some(sun) = scenery.lighting.sun {
        add("--light", format!("{:.1},{:.1}", sun.azimuth.to_degrees(), sun.elevation.to_degrees()));
    }
    match &scenery.lighting.background {
        Background::Transparent => add("--background", "transparent".into()),
        Background::Color(color) => {
            let [r, g, b] = color.to_array().map(|v| (srgb_encode(v) * 255.0).round() as u8);
            add("--background", format!("#{r:02x}{g:02x}{b:02x}"));
        }
        Background::Environment(_) => {
            if let Some(file) = &scenery.lighting.surroundings {
                add("--background", file.to_string_lossy().into_owned());
            }
        }
        Background::Sky => {}
    }
    words
}

fn quoted_path(path: &Path) -> String {
    quoted(&path.to_string_lossy())
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:@%+".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_needs_it() {
        assert_eq!(quoted("line_color=#102030"), "'line_color=#102030'");
        assert_eq!(quoted("a/b-c.json"), "a/b-c.json");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted(""), "''");
    }
}
