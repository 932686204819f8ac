//! Key frames of sequences that are painted on in the window: carried along the motion, saved, exported, and followed by `apply`.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use image::{GrayImage, Luma};
use isophote_files::files::Existing;
use isophote_loader::Library;
use isophote_window::jobs::carrying::{CarryJob, Carrying};
use isophote_window::jobs::document::{Document, Options};
use isophote_window::jobs::export::ExportJob;
use isophote_window::jobs::maps;
use isophote_window::state::command;
use isophote_window::state::document::kind::Kind as DocumentKind;
use isophote_window::state::look::EditedLook;
use isophote_window::state::outcome::{Opened, Outcome};
use isophote_window::state::painted::channel::{Channel, Kind};
use isophote_window::state::playback::Playback;
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;
use isophote_window::state::work::Request;
use isophote_window::widgets;

use crate::support::{self, isophote, succeeds, turning_triangle};

/// Frames of a triangle that turns, with motion, in a folder.
fn shot(folder: &Path) {
    turning_triangle(folder);
    let mut command = isophote();
    command.current_dir(folder).args(["render", "triangle.gltf", "shot.####.exr", "--animate"]);
    command.args(["--fps", "12", "--frames", "1-6", "--size", "160x120", "--no-ground"]);
    succeeds(command.args(["--background", "transparent"]));
}

/// A window on the frames.
fn window(document: &Document) -> Harness<'static, Session> {
    let library = Library::from_file(support::library()).expect("the library");
    let looks = vec![EditedLook::open(&library, "ink".as_ref()).expect("the style")];
    let mut session = Session::new(library, looks, Settings::default()).expect("a session");
    session.show_playback(document.playback().expect("it is read"));
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1200.0, 4000.0))
        .build_ui_state(|ui, session: &mut Session| widgets::show(ui, session), session);
    widgets::theme::apply(&harness.ctx);
    harness.run_ok();
    harness.get_by_label("Brush").click();
    harness.run_ok();
    harness
}

/// Goes to a frame and shows it.
fn go_to(harness: &mut Harness<'_, Session>, document: &Document, frame: i64) {
    let playback = harness.state_mut().open.playback_mut().expect("frames");
    playback.seek(frame);
    let read = document.wait(frame).expect("the frame");
    playback.take(document.frames().expect("frames"), Some(Ok(read))).expect("it is shown");
    harness.run_ok();
}

/// Takes the look away from a square in the middle of the frame that is shown.
fn paint(harness: &mut Harness<'_, Session>, at: [f32; 2]) {
    let session = harness.state_mut();
    let brush = &mut session.painting.brush;
    (brush.channel, brush.size, brush.hardness) = (Channel::Mask, 30.0, 1.0);
    session.begin_stroke(at, false);
    session.end_stroke();
    harness.run_ok();
}

/// The mask that lies on the frame that is shown.
fn mask(session: &Session) -> GrayImage {
    let playback = session.open.playback().expect("frames");
    let size = playback.size();
    let maps = playback.maps().expect("what is painted");
    GrayImage::from_fn(size.0, size.1, |x, y| Luma([maps.layer(Channel::Mask).get(x, y)]))
}

fn playback(session: &Session) -> &Playback {
    session.open.playback().expect("frames")
}

#[test]
fn what_is_painted_on_key_frames_is_carried_as_the_program_carries_it() {
    let folder = support::folder();
    let at = |name: &str| folder.path().join(name);
    shot(folder.path());
    let document = Document::open(&at("shot.####.exr"), &Options::default()).expect("a sequence");
    let mut harness = window(&document);
    harness.get_by_label_contains("becomes a key frame");
    paint(&mut harness, [80.0, 60.0]);
    harness.get_by_label("Painted on: 1");
    harness.get_by_label_contains("lies on all frames");
    let first = mask(harness.state());
    go_to(&mut harness, &document, 6);
    assert_eq!(mask(harness.state()), first, "it lies there as it is");
    // Painted on, this one has a map of its own, which begins with what lay there.
    paint(&mut harness, [120.0, 100.0]);
    harness.get_by_label("Painted on: 1, 6");
    harness.get_by_label_contains("nearest as it is");
    let last = mask(harness.state());
    assert!(last.get_pixel(120, 100)[0] == 0 && last.get_pixel(80, 60)[0] == 0);
    go_to(&mut harness, &document, 3);
    assert_eq!(mask(harness.state()), first, "the nearest");
    // The program carries the maps of both.
    let over = playback(harness.state()).painted().expect("maps");
    for (frame, maps) in over.keys.iter() {
        maps::write(Kind::Mask, maps, over.size, &at(&format!("key.{frame:04}.png"))).expect("it is saved");
    }
    let mut carry = isophote();
    carry.current_dir(folder.path()).args(["carry", "key.####.png", "shot.####.exr", "carried.####.png"]);
    succeeds(&mut carry);
    // So does the window.
    harness.get_by_label("Carry along the motion").click();
    harness.run_ok();
    assert_eq!(harness.state_mut().work.take_requests(), [Request::CarryMaps]);
    let job = CarryJob::of(playback(harness.state()), &harness.state().library).expect("key frames");
    assert!(job.carry(&|| false).is_err(), "it ends where nobody wants it");
    let (keys, carried) = job.carry(&|| true).expect("it is carried");
    harness.state_mut().take_over(Outcome::Carried(keys, carried));
    harness.run_ok();
    harness.get_by_label_contains("carried along the motion");
    let mut differing = 0;
    for frame in 1..=6 {
        go_to(&mut harness, &document, frame);
        let file = image::open(at(&format!("carried.{frame:04}.png"))).expect("a map").into_luma8();
        let own = mask(harness.state());
        // What no key frame shows has no look in a mask of a file, and is as before where it was painted in the window.
        differing += file.pixels().zip(own.pixels()).filter(|(a, b)| a != b && a[0] != 0).count();
        assert!(frame == 1 || own != first, "frame {frame}");
    }
    assert_eq!(differing, 0);
}

#[test]
fn maps_of_a_sequence_that_is_open_no_more_are_not_wanted() {
    let folder = support::folder();
    shot(folder.path());
    let document =
        Document::open(&folder.path().join("shot.####.exr"), &Options::default()).expect("a sequence");
    let mut harness = window(&document);
    paint(&mut harness, [80.0, 60.0]);
    let session = harness.state();
    let mut carrying = Carrying::new(&(Arc::new(|| {}) as Arc<dyn Fn() + Send + Sync>)).expect("a thread");
    for (open, is_told) in [(Some(playback(session)), true), (None, false)] {
        carrying.ask(CarryJob::of(playback(session), &session.library).expect("a key frame"));
        carrying.follow(open);
        let mut told = None;
        while carrying.is_busy() {
            told = carrying.answer();
            std::thread::sleep(Duration::from_millis(2));
        }
        assert_eq!(matches!(told, Some(Outcome::Carried(..))), is_told);
    }
}

#[test]
fn files_of_all_frames_show_what_the_window_shows_and_steps_go_back() {
    let folder = support::folder();
    let at = |name: &str| folder.path().join(name);
    shot(folder.path());
    let document = Document::open(&at("shot.####.exr"), &Options::default()).expect("a sequence");
    let mut harness = window(&document);
    paint(&mut harness, [80.0, 60.0]);
    let session = harness.state_mut();
    assert_eq!(command::map_file(session, Kind::Mask), at("shot-mask.png"));
    let job = CarryJob::of(playback(session), &session.library).expect("a key frame");
    let (keys, carried) = job.carry(&|| true).expect("it is carried");
    session.take_over(Outcome::Carried(Arc::clone(&keys), Arc::clone(&carried)));
    let pattern = at("shot.mask.####.png");
    assert_eq!(command::map_file(session, Kind::Mask), pattern);
    assert!(
        command::line(session).contains("--mask") && command::line(session).contains("shot.mask.####.png")
    );
    let over = playback(session).painted().expect("maps");
    let refused = maps::write_all(Kind::Mask, &over, &at("one.png"), Existing::Keep).expect_err("one file");
    assert!(refused.to_string().contains("####"), "{refused}");
    maps::write_all(Kind::Mask, &over, &pattern, Existing::Keep).expect("they are saved");
    let refused = maps::write_all(Kind::Mask, &over, &pattern, Existing::Keep).expect_err("they are there");
    assert!(refused.to_string().contains("shot.mask.0001.png"), "{refused}");
    assert_eq!(session.unsaved_maps().len(), 1);
    session.take_over(Outcome::Opened(Opened::SavedMap(Kind::Mask, pattern.clone(), over.keys)));
    assert!(session.unsaved_maps().is_empty());
    let mut apply = isophote();
    apply.current_dir(folder.path()).args(["apply", "ink", "shot.####.exr", "out.####.png", "--mask"]);
    succeeds(apply.arg(&pattern));
    let mut job =
        ExportJob::new(DocumentKind::Sequence, &at("shot.####.exr"), &at("exported.####.png"), None);
    job.preset = Some("{\"style\": \"ink\"}".to_owned());
    job.maps = playback(session).painted();
    support::export(job);
    for frame in 1..=6 {
        let [applied, exported] = ["out", "exported"]
            .map(|name| image::open(at(&format!("{name}.{frame:04}.png"))).expect("a picture").into_rgba8());
        assert!(applied == exported, "frame {frame}");
    }
    // What is painted now is carried no more, until that is taken back.
    paint(&mut harness, [20.0, 20.0]);
    assert!(!playback(harness.state()).keys().expect("maps").is_carried());
    // What comes too late is not taken.
    harness.state_mut().take_over(Outcome::Carried(keys, carried));
    assert!(!playback(harness.state()).keys().expect("maps").is_carried());
    harness.state_mut().undo();
    assert!(playback(harness.state()).keys().expect("maps").is_carried());
    harness.state_mut().undo();
    assert!(playback(harness.state()).keys().expect("maps").is_one());
    // A key frame is taken back where there is another one.
    go_to(&mut harness, &document, 4);
    paint(&mut harness, [30.0, 30.0]);
    harness.get_by_label("Painted on: 1, 4");
    harness.get_by_label("Remove this key frame").click();
    harness.run_ok();
    harness.get_by_label("Painted on: 1");
}
