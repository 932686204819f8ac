//! Paper and hatching that were chosen for what is open.

use std::path::Path;

use super::scenery::OnScene;
use super::session::Session;
use isophote_pictures::material::MaterialKind;

/// Materials that were chosen for what is open, by their kinds and names.
pub fn chosen(session: &Session) -> Vec<(MaterialKind, &Path)> {
    match session.open.playback() {
        Some(playback) => {
            playback.info().materials.iter().map(|(kind, name)| (*kind, name.as_path())).collect()
        }
        None => {
            let materials = session.open.scenery().map_or(&[][..], |scenery| &scenery.materials);
            materials.iter().map(|own| (own.material.kind(), own.name.as_path())).collect()
        }
    }
}

/// True where a scene lies on a material that the look takes.
pub fn are_on_scene(session: &Session) -> bool {
    let takes = |own: &OnScene| session.looks.takes(own.material.kind().guide().id());
    session.open.scenery().is_some_and(|scenery| scenery.materials.iter().any(takes))
}

/// Options of `apply` and `render` for them.
pub fn options(session: &Session) -> Vec<String> {
    let option = |(kind, name): (MaterialKind, &Path)| {
        [format!("--{}", kind.guide().id()), name.to_string_lossy().into_owned()]
    };
    chosen(session).into_iter().flat_map(option).collect()
}
