//! Control maps of scenes, whichever processor computes looks.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::Duration;

use isophote_finishing::apply::backend::Backend;
use isophote_scene::Scene;
use isophote_window::state::scenery::{Scenery, Staging};
use isophote_window::state::session::Session;

use super::{App, CANVAS, SIZE, Script, Step, alone, frames, is_at_rest, pause, session};
use crate::support::window::screen;
use crate::support::{controlled_cube, cube};

/// Pictures on the screen that were kept.
pub type Seen = Rc<RefCell<Vec<Vec<u8>>>>;

/// Does something by which another picture is shown, and keeps what is to be seen of it.
pub fn shown(
    folder: &Path,
    seen: &Seen,
    mut act: impl FnMut(&mut Session) + 'static,
) -> Vec<(&'static str, Step)> {
    let (folder, seen) = (folder.to_owned(), Rc::clone(seen));
    let before = Rc::new(RefCell::new(0));
    let known = Rc::clone(&before);
    let open = move |app: &mut App| {
        *known.borrow_mut() = frames(app);
        act(app.session_mut());
        true
    };
    let is_there = move |app: &mut App| is_at_rest(app) && frames(app) > *before.borrow();
    let keep = move |_: &mut App| {
        seen.borrow_mut().push(screen(&folder, CANVAS));
        true
    };
    vec![
        ("something else", Box::new(open)),
        ("its picture", Box::new(is_there)),
        ("the screen", Box::new(pause(Duration::from_millis(500)))),
        ("its picture at rest", Box::new(is_at_rest)),
        ("what is seen", Box::new(keep)),
    ]
}

/// Bytes of the screen that are others.
pub fn others(a: &[u8], b: &[u8]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a.abs_diff(**b) > 32).count()
}

fn followed(backend: Backend, folder: &Path) {
    let mut session = session(folder, &["ink"], (96, 64));
    session.backend = backend;
    let seen = Seen::default();
    // Folders of their own: files have the same names.
    let within = |name: &str| {
        let folder = folder.join(name);
        std::fs::create_dir(&folder).unwrap();
        folder
    };
    let scenes = [
        cube(&within("plain")),
        controlled_cube(&within("neutral"), "_CONTROL", |_| [0.5; 4]),
        controlled_cube(&within("directed"), "_CONTROL", |_| [0.5, 0.5, 0.0, 0.5]),
    ];
    let opened = |file: PathBuf| {
        shown(folder, &seen, move |session| {
            let scene = Scene::load(&file, None).unwrap();
            let scenery = Scenery::new(scene, Staging::default(), 1.5);
            session.show_scene(scenery, None, "scene".into());
        })
    };
    let steps = scenes.into_iter().flat_map(opened).collect();
    let app = Script::run(session, SIZE, steps);
    assert!(app.failure.is_none(), "{:?}", app.failure);
    let [plain, neutral, directed] = seen.take().try_into().unwrap();
    assert_eq!(others(&plain, &neutral), 0, "0.5 changes nothing");
    let changed = others(&plain, &directed);
    assert!(changed > 500, "without lines {changed} bytes of the screen are others");
}

#[test]
fn looks_follow_the_control_map_of_a_scene() {
    alone("directed::looks_follow_the_control_map_of_a_scene", |folder| followed(Backend::Auto, folder));
}

#[test]
fn so_they_do_where_the_device_computes_them() {
    alone("directed::so_they_do_where_the_device_computes_them", |folder| followed(Backend::Gpu, folder));
}
