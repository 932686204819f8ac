//! Control maps of scenes, whichever processor computes looks.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::Duration;

use isophote_finishing::apply::backend::Backend;
use isophote_scene::Scene;
use isophote_window::state::scenery::{Scenery, Staging};

use super::{App, CANVAS, SIZE, Script, Step, alone, frames, is_at_rest, pause, session};
use crate::support::window::screen;
use crate::support::{controlled_cube, cube};

type Seen = Rc<RefCell<Vec<Vec<u8>>>>;

/// Shows a scene and keeps what is to be seen of it.
fn shown(file: PathBuf, folder: &Path, seen: &Seen) -> Vec<(&'static str, Step)> {
    let (folder, seen) = (folder.to_owned(), Rc::clone(seen));
    let before = Rc::new(RefCell::new(0));
    let known = Rc::clone(&before);
    let open = move |app: &mut App| {
        *known.borrow_mut() = frames(app);
        let scene = Scene::load(&file, None).unwrap();
        let scenery = Scenery::new(scene, Staging::default(), 1.5);
        app.session_mut().show_scene(scenery, None, "scene".into());
        true
    };
    let is_there = move |app: &mut App| is_at_rest(app) && frames(app) > *before.borrow();
    let keep = move |_: &mut App| {
        seen.borrow_mut().push(screen(&folder, CANVAS));
        true
    };
    vec![
        ("a scene", Box::new(open)),
        ("its picture", Box::new(is_there)),
        ("the screen", Box::new(pause(Duration::from_millis(500)))),
        ("what is seen", Box::new(keep)),
    ]
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
    let steps = scenes.into_iter().flat_map(|file| shown(file, folder, &seen)).collect();
    let app = Script::run(session, SIZE, steps);
    assert!(app.failure.is_none(), "{:?}", app.failure);
    let [plain, neutral, directed] = seen.take().try_into().unwrap();
    let others = |a: &[u8], b: &[u8]| a.iter().zip(b).filter(|(a, b)| a.abs_diff(**b) > 32).count();
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
