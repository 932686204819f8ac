//! Rules of looks for things, as the window computes looks: at all sizes, in parts, and side by side.

use std::path::Path;
use std::sync::Arc;

use isophote_loader::{Control, Library};
use isophote_pictures::exr::Guide;
use isophote_scene::Scene;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::jobs::preview::render::Renderer;
use isophote_window::jobs::stylizing::{Stylist, Task};
use isophote_window::state::document::frame::{Frame, GuideImage};
use isophote_window::state::look::EditedLook;
use isophote_window::state::preview::order::Order;
use isophote_window::state::preview::picture::Picture;
use isophote_window::state::things::Things;

use crate::support::{self, folder, ruled_cubes};

/// Rules for a thing and for what is not there.
const RULES: &str = r#"{"match": "cryptomatte:hero", "look": {"style": "gaussian", "parameters": {"sigma": 6}}},
    {"match": "material:skinn", "lines": false}"#;
const SIZE: (u32, u32) = (120, 80);

fn library() -> Library {
    Library::from_file(support::library()).expect("the library")
}

/// Looks with rules and without.
fn looks(folder: &Path) -> [EditedLook; 2] {
    let rules = folder.join("rules.json");
    [&rules, Path::new("cartoon")].map(|name| EditedLook::open(&library(), name).expect("a look"))
}

/// A picture whose left half the hero of a scene covers, and the things of this scene.
fn prepare(folder: &Path) -> (Arc<Frame>, Option<Things>) {
    ruled_cubes(folder, RULES);
    let scene = Arc::new(Scene::load(&folder.join("cube.gltf"), None).expect("a scene"));
    let file = folder.join("photo.png");
    support::picture(SIZE.0, SIZE.1).save(&file).expect("the folder is writable");
    let document = Document::open(&file, &Options::default()).expect("a picture");
    let mut frame = Frame::clone(&document.wait(1).expect("a picture"));
    let data = (0..SIZE.0 * SIZE.1).map(|at| if at % SIZE.0 < SIZE.0 / 2 { 1.0 } else { 0.0 }).collect();
    frame.guides.push(Arc::new(GuideImage { guide: Guide::ObjectId, channels: 1, data }));
    (Arc::new(frame), Some(Things::Scene { scene, name: "cube.gltf".into(), sampled: None }))
}

/// Columns in which two pictures of a width are not alike.
fn columns<P: PartialEq>(one: &[P], other: &[P], width: usize) -> Vec<usize> {
    let is_other = |x: &usize| (0..one.len() / width).any(|y| one[y * width + x] != other[y * width + x]);
    (0..width).filter(is_other).collect()
}

#[test]
fn things_have_their_looks_at_all_sizes_and_what_is_not_there_is_told_once() {
    let folder = folder();
    let (frame, things) = prepare(folder.path());
    let [ruled, plain] = looks(folder.path());
    let mut stylist = Stylist::new(library());
    let mut told = Vec::new();
    for size in [SIZE, (60, 40)] {
        let mut made = |look: &EditedLook| {
            let (look, frame, things) = (look.clone(), Arc::clone(&frame), things.clone());
            let task = Task { look, frame, things, share: 1.0, size, shot: 1 };
            let pixels = stylist.stylize(&task, &mut Control::default()).expect("a look");
            let numbers = pixels.expect("it was not cancelled").to_f32();
            numbers.as_chunks::<4>().0.to_vec()
        };
        let apart = columns(&made(&ruled), &made(&plain), size.0 as usize);
        told.extend(stylist.take_news());
        let half = size.0 as usize / 2;
        assert!(apart.len() > half / 2 && apart.iter().all(|x| *x < half), "{apart:?} of {size:?}");
    }
    assert!(told.len() == 1 && told[0].contains("did you mean skin?"), "{told:?}");
}

#[test]
fn so_they_have_in_parts_of_looks_that_are_seen_side_by_side() {
    let folder = folder();
    let (frame, things) = prepare(folder.path());
    let picture = Picture { frame, things, size: SIZE, exposure: 1.0 };
    let [ruled, plain] = looks(folder.path()).map(|look| {
        let order = Order { look: Arc::new(look), size: SIZE, part: [[40, 10], [90, 50]], fineness: 1 };
        let rendered = Renderer::new(library(), 0).render(&picture, &order, &|| false).expect("a preview");
        rendered.expect("it was not cancelled").pixels
    });
    let apart = columns(&ruled, &plain, 50);
    assert!(apart.len() > 10 && apart.iter().all(|x| *x < 20), "{apart:?}");
}
