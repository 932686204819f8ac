//! The command line that gives the picture that is shown.

use std::path::{Path, PathBuf};

use super::reel::Reel;
use super::session::Session;
use isophote_finishing::stylize::lengths::Lengths;
use isophote_finishing::stylize::precision::Precision;
use isophote_pictures::space::srgb_encode;
use isophote_render::background::Background;
use isophote_scene::floor;

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
            words.extend(selection(reel).iter().map(|word| quoted(word)));
        }
        None => {
            words.extend(["render".to_owned(), input, "picture.png".to_owned()]);
            let (width, height) = session.nominal_size();
            words.extend(["--size".to_owned(), format!("{width}x{height}")]);
            words.extend(staging(session).iter().chain(&moment(session)).map(|word| quoted(word)));
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
    words.extend(precision(session));
    words.join(" ")
}

/// The option for a precision that is not the usual one.
pub fn precision(session: &Session) -> Vec<String> {
    match session.precision {
        Precision::Exact => Vec::new(),
        precision => vec!["--precision".into(), precision.name().into()],
    }
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

/// Options of `apply` for the layer and the view that were chosen.
pub fn selection(reel: &Reel) -> Vec<String> {
    let selection = reel.document.selection();
    let mut words = Vec::new();
    for (option, value) in [("--layer", &selection.layer), ("--view", &selection.view)] {
        words.extend(value.iter().flat_map(|value| [option.to_owned(), value.clone()]));
    }
    words.extend(selection.force.then(|| "--force-layer".to_owned()));
    words
}

/// Options of `render` for the time of an animated scene.
pub fn moment(session: &Session) -> Vec<String> {
    let Some(scenery) = session.scenery.as_ref().filter(|scenery| !scenery.scene.animations.is_empty())
    else {
        return Vec::new();
    };
    let words = ["--animate".into(), "--start".into(), format!("{:.4}", scenery.time().0)];
    words.into_iter().chain(animation(session)).collect()
}

/// The option of `render` for an animation that is not the first.
pub fn animation(session: &Session) -> Vec<String> {
    let index = session.scenery.as_ref().map_or(0, |scenery| scenery.animation);
    if index == 0 { Vec::new() } else { vec!["--animation".into(), index.to_string()] }
}

/// Options of `render` for camera and light, where they are not as they are without being asked for.
pub fn staging(session: &Session) -> Vec<String> {
    let [_, area] = session.viewport.halves();
    let Some(scenery) = &session.scenery else { return Vec::new() };
    let mut words = scenery.reading.clone();
    let mut add = |option: &str, value: String| words.extend([option.to_owned(), value]);
    match scenery.camera() {
        Some(node) => {
            let index = scenery.cameras().into_iter().position(|(known, _)| known == node);
            if let Some(index) = index.filter(|index| *index > 0) {
                add("--camera", index.to_string());
            }
        }
        None => {
            let framed = scenery.framed(area.width / area.height);
            add("--azimuth", format!("{:.3}", framed.azimuth));
            add("--elevation", format!("{:.3}", framed.elevation));
            add("--distance", format!("{:.4}", framed.distance));
            if let Some([x, y, z]) = framed.target.map(|target| target.to_array()) {
                add("--target", format!("{x},{y},{z}"));
            }
            if let Some(fov) = framed.fov {
                add("--fov", fov.to_string());
            }
        }
    }
    if let Some(sun) = scenery.sun_from_here() {
        add("--light", format!("{:.2},{:.2}", sun.azimuth.to_degrees(), sun.elevation.to_degrees()));
    }
    if scenery.lighting.exposure != 0.0 {
        add("--exposure", format!("{:.3}", scenery.lighting.exposure));
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
    if scenery.ground != floor::lacks_floor(&scenery.scene) {
        words.push(if scenery.ground { "--ground".into() } else { "--no-ground".into() });
    }
    words
}

/// A path as a shell takes it, and the program not for an option.
fn quoted_path(path: &Path) -> String {
    let path = path.to_string_lossy();
    quoted(&if path.starts_with('-') { format!("./{path}") } else { path.into_owned() })
}

/// A word as a shell takes it. A terminal would obey control characters when the line is pasted.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:@%+".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    if !word.chars().any(char::is_control) {
        return format!("'{}'", word.replace('\'', r"'\''"));
    }
    let escaped = word.chars().map(|c| match c {
        '\'' | '\\' => format!("\\{c}"),
        c if c.is_control() => {
            c.encode_utf8(&mut [0; 4]).bytes().map(|byte| format!("\\{byte:03o}")).collect()
        }
        c => c.into(),
    });
    format!("$'{}'", escaped.collect::<String>())
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
        assert_eq!(quoted("a\u{1b}[2J\n'\\\u{9b}"), r"$'a\033[2J\012\'\\\302\233'");
        assert_eq!(quoted_path(Path::new("-o.png")), "./-o.png");
    }
}
