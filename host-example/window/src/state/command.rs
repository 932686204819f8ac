//! The command line that gives the picture that is shown.

use std::path::PathBuf;

use super::materials;
use super::painted::channel::Kind;
use super::playback::Playback;
use super::quoting::{quoted, quoted_path};
use super::scenery::Scenery;
use super::session::Session;
use isophote_files::frames::Pattern;
use isophote_finishing::staging::{Behind, MotionArgs, StagingArgs};
use isophote_finishing::stylize::precision::Precision;
use isophote_finishing::stylize::preset::Lengths;
use isophote_render::background::Background;
use isophote_scene::floor;

/// The command line, quoted for a shell.
pub fn line(session: &Session) -> String {
    let look = session.looks.seen();
    let style = quoted_path(&look.commanded());
    let mut words = vec!["isophote".to_owned()];
    let input = session.open.file().map_or_else(|| "SCENE.gltf".into(), quoted_path);
    match session.open.playback() {
        Some(playback) => {
            words.extend(["apply".to_owned(), style, input]);
            words.push(quoted_path(&output(playback)));
            words.extend(selection(playback).iter().chain(&painted(session)).map(|word| quoted(word)));
        }
        None => {
            words.extend(["render".to_owned(), input, "picture.png".to_owned()]);
            let (width, height) = session.nominal_size();
            words.extend(["--size".to_owned(), format!("{width}x{height}")]);
            words.extend(staging(session, false).iter().chain(&moment(session)).map(|word| quoted(word)));
            if !look.is_plain() {
                words.push(format!("--style {style}"));
            }
        }
    }
    words.extend(materials::options(session).iter().map(|word| quoted(word)));
    let parameters = look.parameters(&session.library).unwrap_or_default();
    words.extend(look.settings(&parameters).iter().map(|setting| format!("--set {}", quoted(setting))));
    if look.preset.lengths == Some(Lengths::Pixels) {
        words.push("--lengths pixels".into());
    }
    words.extend(precision(session));
    words.join(" ")
}

/// The command line as it is put on the clipboard, of which the window tells.
pub fn copied(session: &mut Session) -> String {
    let unsaved: Vec<Kind> = kinds(session).filter(|kind| saved(session, *kind).is_none()).collect();
    session.notes.say(match unsaved[..] {
        [] => "Copied the command line of this picture".to_owned(),
        [kind, ..] => {
            let file = map_file(session, kind);
            format!("Copied the command line of this picture. Save the {} as {}", kind.name(), file.display())
        }
    });
    let line = line(session);
    // It has camera and light.
    if let Some(scenery) = session.open.scenery_mut() {
        scenery.keep();
    }
    line
}

/// The option for a precision that is not the usual one.
pub fn precision(session: &Session) -> Vec<String> {
    match session.precision {
        Precision::Exact => Vec::new(),
        precision => vec!["--precision".into(), precision.name().into()],
    }
}

/// A name for the result beside the input.
pub fn output(playback: &Playback) -> PathBuf {
    let path = playback.path();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    // The place of a sequence's numbers stays at the end.
    let name = match stem.split_once('.') {
        Some((name, number)) => format!("{name}-look.{number}"),
        None => format!("{stem}-look"),
    };
    let known = ["png", "jpg", "jpeg", "tif", "tiff", "exr"];
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let is_kept = known.contains(&extension.as_str()) || playback.frames().is_some();
    path.with_file_name(format!("{name}.{}", if is_kept { &extension } else { "png" }))
}

/// Options of `apply` for the layer and the view that were chosen.
pub fn selection(playback: &Playback) -> Vec<String> {
    let selection = &playback.info().selection;
    let mut words = Vec::new();
    for (option, value) in [("--layer", &selection.layer), ("--view", &selection.view)] {
        words.extend(value.iter().flat_map(|value| [option.to_owned(), value.clone()]));
    }
    words.extend(selection.force.then(|| "--force-layer".to_owned()));
    words
}

/// Options of `apply` for what is painted, by the files that hold it or are to hold it.
fn painted(session: &Session) -> Vec<String> {
    let option =
        |kind: Kind| [format!("--{}", kind.option()), map_file(session, kind).to_string_lossy().into_owned()];
    kinds(session).flat_map(option).collect()
}

/// Maps of which something is painted.
fn kinds(session: &Session) -> impl Iterator<Item = Kind> {
    let keys = session.open.playback().and_then(|playback| playback.keys());
    Kind::ALL.into_iter().filter(move |kind| keys.is_some_and(|keys| keys.has(*kind)))
}

/// The file that holds a map as it is painted now.
fn saved(session: &Session, kind: Kind) -> Option<&PathBuf> {
    session.painting.file(kind, session.open.playback()?.keys()?)
}

/// The file that holds a map, or one beside the input that would; where frames have maps of their own the pattern of the files.
pub fn map_file(session: &Session, kind: Kind) -> PathBuf {
    let playback = session.open.playback();
    let input = playback.map_or_else(PathBuf::new, |playback| playback.path().to_owned());
    let is_one = playback.and_then(Playback::keys).is_none_or(|keys| keys.is_one());
    let beside = || {
        let pattern = Pattern::new(&input).ok().flatten().filter(|_| !is_one);
        if let Some(pattern) = pattern {
            return pattern.with_word(kind.option()).with_extension("png");
        }
        let stem = input.file_stem().unwrap_or_default().to_string_lossy();
        // The place of a sequence's numbers is none of a map that lies over all frames.
        let stem = stem.split_once('.').map_or(&*stem, |(name, _)| name);
        input.with_file_name(format!("{stem}-{}.png", kind.option()))
    };
    saved(session, kind).cloned().unwrap_or_else(beside)
}

/// Options of `render` for the time of an animated scene.
pub fn moment(session: &Session) -> Vec<String> {
    let Some(scenery) = session.open.scenery().filter(|scenery| !scenery.scene.animations.is_empty()) else {
        return Vec::new();
    };
    MotionArgs { start: scenery.time().0, ..motion(scenery) }.words()
}

/// Options of `render` that play the animation from its start.
pub fn animation(session: &Session) -> Vec<String> {
    session.open.scenery().map_or_else(Vec::new, |scenery| motion(scenery).words())
}

fn motion(scenery: &Scenery) -> MotionArgs {
    // The first plays where none is named.
    let animation = Some(scenery.animation).filter(|index| *index > 0).map(|index| index.to_string());
    MotionArgs { animate: true, animation, start: 0.0 }
}

/// Options of `render` for the file, camera and light, where they are not as they are without being asked for. A turntable
/// goes around by itself, wherever the file's camera stands.
pub fn staging(session: &Session, is_turntable: bool) -> Vec<String> {
    let [_, area] = session.viewport.halves();
    let Some(scenery) = session.open.scenery() else { return Vec::new() };
    let mut staging = StagingArgs {
        light: scenery.sun_from_here(),
        exposure: scenery.lighting.exposure,
        background: behind(scenery),
        ..StagingArgs::default()
    };
    match scenery.camera() {
        Some(node) => {
            let index = scenery.cameras().into_iter().position(|(known, _)| known == node);
            let index = index.filter(|index| *index > 0 && !is_turntable);
            staging.camera = index.map(|index| index.to_string());
        }
        None => {
            let framed = scenery.framed(area.width / area.height);
            staging.azimuth = Some(framed.azimuth);
            staging.elevation = Some(framed.elevation);
            staging.distance = Some(framed.distance);
            (staging.target, staging.fov) = (framed.target, framed.fov);
        }
    }
    if scenery.ground != floor::lacks_floor(&scenery.scene) {
        (staging.ground, staging.no_ground) = (scenery.ground, !scenery.ground);
    }
    [scenery.reading.words(), staging.words()].concat()
}

/// Background of the scene, as it is written.
fn behind(scenery: &Scenery) -> Behind {
    match (&scenery.lighting.background, &scenery.lighting.surroundings) {
        (Background::Transparent, _) => Behind::Transparent,
        (Background::Color(color), _) => Behind::Color(*color),
        (Background::Environment(_), Some(file)) => Behind::File(file.clone()),
        (Background::Environment(_), None) | (Background::Sky, _) => Behind::Sky,
    }
}
