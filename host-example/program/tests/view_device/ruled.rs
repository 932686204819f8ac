//! Rules of looks for things: what the window shows is what the command line makes of the same, whichever processor computes
//! other looks.

use std::path::Path;

use isophote_finishing::apply::backend::Backend;
use isophote_scene::{Scene, floor};
use isophote_window::jobs::document::{Document, Options};
use isophote_window::state::scenery::{Scenery, Staging};
use isophote_window::state::session::Session;

use super::directed::{Seen, others, shown};
use super::{SIZE, Script, alone, session};
use crate::support::{isophote, ruled_cubes, succeeds};

/// Rules of all kinds: for a map, for a look, for colours of lines, and for what is not there.
const RULES: &str = r##"{"match": "cryptomatte:hero", "lines": false, "detail": 4},
    {"match": "cryptomatte:p*", "look": {"style": "watercolor"}, "medium": 2},
    {"match": "material:skin", "line_color": "#c03018", "line_width": 2},
    {"match": "cryptomatte:heroo", "line_amount": 4}"##;

/// Runs a verb of the program on files of a folder.
fn run(folder: &Path, command: &str) {
    let words = command.split_whitespace();
    let more = ["--force", "--backend", "cpu", "--on-unknown", "empty"];
    succeeds(isophote().current_dir(folder).args(words).args(more));
}

/// Renders the scene as large as the window shows it.
pub fn render(folder: &Path, session: &Session, rest: &str) {
    let (width, height) = session.nominal_size();
    run(folder, &format!("render cube.gltf {rest} --size {width}x{height}"));
}

pub fn open_picture(folder: &Path, session: &mut Session, name: &str) {
    let document = Document::open(&folder.join(name), &Options::default()).unwrap();
    session.show_playback(document.playback().unwrap());
}

pub fn open_scene(folder: &Path, session: &mut Session) {
    let file = folder.join("cube.gltf");
    let scene = Scene::load(&file, None).unwrap();
    let staging = Staging { ground: floor::lacks_floor(&scene), ..Staging::default() };
    session.show_scene(Scenery::new(scene, staging, 1.5), Some(file), "cube.gltf".into());
}

/// Shows something in a look with rules and in its style without, and then what the command line makes of it with them.
fn followed(
    (backend, folder): (Backend, &Path),
    mut open: impl FnMut(&Path, &mut Session) + 'static,
    made: impl Fn(&Path, &mut Session) + 'static,
) {
    ruled_cubes(folder, RULES);
    let rules = folder.join("rules.json").display().to_string();
    let mut session = session(folder, &["none", &rules, "cartoon"], (96, 64));
    session.backend = backend;
    let seen = Seen::default();
    let [own, other] = [folder, folder].map(Path::to_owned);
    let ruled = shown(folder, &seen, move |session| {
        session.choose(1);
        open(&own, session);
    });
    let plain = shown(folder, &seen, |session| session.choose(2));
    let expected = shown(folder, &seen, move |session| {
        session.choose(0);
        made(&other, session);
    });
    let app = Script::run(session, SIZE, ruled.into_iter().chain(plain).chain(expected).collect());
    assert!(app.failure.is_none(), "{:?}", app.failure);
    let [ruled, plain, expected] = seen.take().try_into().unwrap();
    let (same, other) = (others(&ruled, &expected), others(&ruled, &plain));
    assert!(same * 20 < other && other > 2000, "{same} bytes are others, and {other} without rules");
}

fn scenes_are_as_rendered(backend: Backend, folder: &Path) {
    followed((backend, folder), open_scene, |folder, session| {
        render(folder, session, "ruled.png --style rules.json");
        open_picture(folder, session, "ruled.png");
    });
}

#[test]
fn scenes_follow_rules() {
    alone("ruled::scenes_follow_rules", |folder| scenes_are_as_rendered(Backend::Auto, folder));
}

#[test]
fn so_they_do_where_the_device_computes_other_looks() {
    let name = "ruled::so_they_do_where_the_device_computes_other_looks";
    alone(name, |folder| scenes_are_as_rendered(Backend::Gpu, folder));
}

#[test]
fn pictures_follow_rules_by_the_mattes_of_their_files() {
    alone("ruled::pictures_follow_rules_by_the_mattes_of_their_files", |folder| {
        let open = |folder: &Path, session: &mut Session| {
            render(folder, session, "plain.exr --cryptomatte");
            open_picture(folder, session, "plain.exr");
        };
        followed((Backend::Auto, folder), open, |folder, session| {
            run(folder, "apply --preset rules.json plain.exr applied.exr");
            open_picture(folder, session, "applied.exr");
        });
    });
}
