//! Scenes on paper: what the window shows is what `render` makes of them, whichever processor computes other looks.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use isophote_finishing::apply::backend::Backend;
use isophote_pictures::material::MaterialKind;
use isophote_window::state::outcome::{Opened, Outcome};
use isophote_window::state::scenery::OnScene;

use super::directed::{Seen, others, shown};
use super::ruled::{open_picture, open_scene, render};
use super::{SIZE, Script, alone, session};
use crate::support::ruled_cubes;

fn laid(backend: Backend, folder: &Path) {
    ruled_cubes(folder, "");
    let mut session = session(folder, &["ink", "none"], (96, 64));
    session.backend = backend;
    let seen = Seen::default();
    let [own, other] = [folder, folder].map(Path::to_owned);
    let plain = shown(folder, &seen, move |session| open_scene(&own, session));
    let on_paper = shown(folder, &seen, |session| {
        let name = PathBuf::from("kraft");
        let material = Arc::new(MaterialKind::Paper.open(&name).unwrap());
        let paper = Opened::Material(MaterialKind::Paper, Some(OnScene { name, material }));
        session.take_over(Outcome::Opened(paper));
    });
    let expected = shown(folder, &seen, move |session| {
        session.choose(1);
        render(&other, session, "laid.png --style ink --paper kraft");
        open_picture(&other, session, "laid.png");
    });
    let app = Script::run(session, SIZE, plain.into_iter().chain(on_paper).chain(expected).collect());
    assert!(app.failure.is_none(), "{:?}", app.failure);
    let [plain, on_paper, expected] = seen.take().try_into().unwrap();
    let (same, other) = (others(&on_paper, &expected), others(&on_paper, &plain));
    assert!(same * 20 < other && other > 2000, "{same} bytes are others, and {other} without paper");
}

#[test]
fn scenes_lie_on_paper() {
    alone("laid::scenes_lie_on_paper", |folder| laid(Backend::Auto, folder));
}

#[test]
fn so_they_do_where_the_device_computes_other_looks() {
    alone("laid::so_they_do_where_the_device_computes_other_looks", |folder| laid(Backend::Gpu, folder));
}
