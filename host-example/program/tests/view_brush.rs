//! The brush of the window: strokes, steps, files, and looks that follow what is painted as `apply` does.

use std::path::Path;
use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Event, Modifiers, PointerButton, Pos2, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use exr::prelude::WritableImage;
use isophote_files::files::Existing;
use isophote_finishing::stylize::value::Value;
use isophote_loader::{Control, Library};
use isophote_pictures::exr::Guide;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::jobs::export::ExportJob;
use isophote_window::jobs::maps;
use isophote_window::jobs::stylizing::{Stylist, Task};
use isophote_window::state::command;
use isophote_window::state::document::kind::Kind as DocumentKind;
use isophote_window::state::leaving::Leaving;
use isophote_window::state::look::EditedLook;
use isophote_window::state::outcome::{Dialog, Opened, Outcome};
use isophote_window::state::painted::channel::{Channel, Kind};
use isophote_window::state::painted::maps::Maps;
use isophote_window::state::playback::Playback;
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;
use isophote_window::state::work::Request;
use isophote_window::widgets;

use crate::support::{self, isophote, picture, succeeds};

/// Size of the picture.
const SIZE: (u32, u32) = (120, 90);

/// A window on a picture of a folder in a look.
fn window(folder: &Path, look: &str) -> Harness<'static, Session> {
    let file = folder.join("in.png");
    picture(SIZE.0, SIZE.1).save(&file).expect("it can be written");
    let library = Library::from_file(support::library()).expect("the library");
    let looks = vec![EditedLook::open(&library, look.as_ref()).expect("the style")];
    let session = Session::new(library, looks, Settings::default()).expect("a session");
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1200.0, 2400.0))
        .build_ui_state(|ui, session: &mut Session| widgets::show(ui, session), session);
    widgets::theme::apply(&harness.ctx);
    show(&mut harness, &file);
    harness
}

fn show(harness: &mut Harness<'_, Session>, file: &Path) {
    let document = Document::open(file, &Options::default()).expect("a picture");
    harness.state_mut().show_playback(document.playback().expect("it is read"));
    harness.run_ok();
}

/// The place of a pixel's middle in the window.
fn place(session: &Session, x: f32, y: f32) -> Pos2 {
    let area = session.viewport.places(SIZE)[1];
    let scale = session.viewport.scale(SIZE);
    pos2(area.x + (x + 0.5) * scale, area.y + (y + 0.5) * scale)
}

/// Drags with a button from pixel to pixel.
fn drag(harness: &mut Harness<'_, Session>, way: &[[f32; 2]], button: PointerButton, modifiers: Modifiers) {
    let places: Vec<Pos2> = way.iter().map(|[x, y]| place(harness.state(), *x, *y)).collect();
    let press = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers };
    harness.event_modifiers(Event::PointerMoved(places[0]), modifiers);
    harness.step();
    harness.event_modifiers(press(places[0], true), modifiers);
    harness.step();
    // All of them within one frame.
    for at in &places[1..] {
        harness.event_modifiers(Event::PointerMoved(*at), modifiers);
    }
    harness.step();
    harness.event_modifiers(press(places[places.len() - 1], false), modifiers);
    harness.run_ok();
}

fn painted(session: &Session, channel: Channel) -> impl Fn(u32, u32) -> u8 + '_ {
    let maps = session.open.playback().and_then(|playback| playback.maps()).map(Arc::clone);
    move |x, y| maps.as_ref().map_or(channel.plain(), |maps| maps.layer(channel).get(x, y))
}

#[test]
fn strokes_paint_along_their_way_and_are_steps() {
    let folder = support::folder();
    let mut harness = window(folder.path(), "ink");
    harness.get_by_label("Brush").click();
    harness.run_ok();
    harness.get_by_role_and_label(Role::ComboBox, "Paints").click();
    harness.run_ok();
    harness.get_by_label("Amount of lines").click();
    harness.run_ok();
    let brush = &mut harness.state_mut().painting.brush;
    assert_eq!(brush.channel, Channel::LineAmount);
    (brush.size, brush.hardness, brush.strengths[Channel::LineAmount as usize]) = (10.0, 1.0, -1.0);
    // It moves the picture as long as it does not paint.
    let (none, left) = (Modifiers::NONE, PointerButton::Primary);
    drag(&mut harness, &[[20.0, 20.0], [40.0, 20.0]], left, none);
    assert!(harness.state().maps().is_none() && !harness.state().viewport.is_fitting());
    harness.state_mut().viewport.fit();
    harness.get_by_label("Paint").click();
    harness.run_ok();
    assert!(harness.state().is_painting());
    // Around a corner, which is between two frames.
    drag(&mut harness, &[[20.0, 20.0], [80.0, 20.0], [80.0, 70.0]], left, none);
    let at = |harness: &Harness<'_, Session>, x, y| painted(harness.state(), Channel::LineAmount)(x, y);
    for (x, y) in [(20, 20), (50, 20), (80, 20), (80, 45), (80, 70)] {
        assert_eq!(at(&harness, x, y), 0, "{x} {y}");
    }
    for (x, y) in [(50, 27), (50, 45), (70, 40), (110, 80)] {
        assert_eq!(at(&harness, x, y), 127, "{x} {y}");
    }
    assert!(
        painted(harness.state(), Channel::Detail)(50, 20) == 127 && harness.state().viewport.is_fitting()
    );
    // Alt takes back; the right button moves the picture.
    let alt = Modifiers { alt: true, ..none };
    drag(&mut harness, &[[80.0, 45.0], [80.0, 46.0]], left, alt);
    assert_eq!((at(&harness, 80, 45), at(&harness, 80, 60)), (127, 0));
    drag(&mut harness, &[[20.0, 40.0], [30.0, 40.0]], PointerButton::Secondary, none);
    assert!(!harness.state().viewport.is_fitting() && at(&harness, 25, 40) == 127);
    // Each is a step.
    harness.state_mut().undo();
    assert_eq!(at(&harness, 80, 45), 0);
    harness.state_mut().undo();
    assert_eq!(at(&harness, 50, 20), 127);
    assert_eq!(harness.state().can(), [false, true]);
    harness.state_mut().redo();
    harness.state_mut().redo();
    assert_eq!((at(&harness, 80, 45), at(&harness, 50, 20)), (127, 0));
}

#[test]
fn maps_are_filled_and_cleared_and_looks_tell_what_they_follow() {
    let folder = support::folder();
    let mut harness = window(folder.path(), "ink");
    harness.get_by_label("Brush").click();
    harness.run_ok();
    harness.get_by_label("Paint").click();
    harness.run_ok();
    let brush = &mut harness.state_mut().painting.brush;
    (brush.channel, brush.strengths[Channel::LineAmount as usize]) = (Channel::LineAmount, -1.0);
    let at = |harness: &Harness<'_, Session>, x, y| painted(harness.state(), Channel::LineAmount)(x, y);
    harness.get_by_label("Fill").click();
    harness.run_ok();
    assert_eq!(at(&harness, 119, 89), 0);
    harness.get_by_label("Clear").click();
    harness.run_ok();
    assert_eq!(at(&harness, 50, 20), 127);
    // Of a look that follows no map only the mask is painted.
    assert!(harness.query_by_label_contains("follows no").is_none());
    let library = harness.state().library.clone();
    let blur = EditedLook::open(&library, "gaussian".as_ref()).expect("the style");
    harness.state_mut().take_over(Outcome::Opened(Opened::Look(Box::new(blur))));
    harness.run_ok();
    harness.get_by_label_contains("follows no control map");
    harness.state_mut().painting.brush.channel = Channel::Mask;
    harness.run_ok();
    assert!(harness.query_by_label_contains("follows no").is_none());
    // A stroke ends where the brush is put away under it.
    harness.state_mut().begin_stroke([60.0, 45.0], false);
    harness.get_by_label("Paint").click();
    harness.run_ok();
    assert!(!harness.state().is_painting() && harness.state().painting.stroke.is_none());
    assert_eq!(painted(harness.state(), Channel::Mask)(60, 45), 0);
}

#[test]
fn maps_are_kept_with_their_files_and_nothing_is_lost_unasked() {
    let folder = support::folder();
    let mut harness = window(folder.path(), "ink");
    let session = harness.state_mut();
    session.painting.brush.channel = Channel::Mask;
    session.begin_stroke([30.0, 30.0], false);
    session.go_on_stroke([60.0, 30.0]);
    assert!(session.open.playback().expect("a picture").maps().is_none(), "not before it ends");
    session.end_stroke();
    let file = folder.path().join("in-mask.png");
    assert_eq!(command::map_file(session, Kind::Mask), file);
    assert!(command::line(session).contains("--mask"), "{}", command::line(session));
    assert!(command::copied(session).contains("in-mask.png"));
    assert_eq!(session.unsaved_maps(), [("in.png".to_owned(), Kind::Mask)]);
    session.leave();
    assert_eq!(session.dialogs.leaving, Leaving::Asks);
    harness.run_ok();
    harness.get_by_label("The mask that was painted over in.png is not saved.");
    harness.get_by_label("Discard and close");
    harness.get_by_label("Cancel").click();
    harness.run_ok();
    assert_eq!(harness.state().dialogs.leaving, Leaving::Stays);
    // Another picture is opened and has none of it; it is there again with the first, without steps of before.
    let other = folder.path().join("other.png");
    picture(30, 30).save(&other).expect("it can be written");
    show(&mut harness, &other);
    assert!(harness.state().maps().is_none() && !harness.state().can()[0]);
    assert_eq!(harness.state().unsaved_maps().len(), 1);
    show(&mut harness, &folder.path().join("in.png"));
    assert_eq!(painted(harness.state(), Channel::Mask)(45, 30), 0);
    // Steps of before bring back no other maps than those of what is open.
    let parameters = Arc::clone(harness.state().looks.parameters());
    let parameter = parameters.iter().find(|parameter| parameter.name == "line_width").expect("it has one");
    harness.state_mut().set(parameter, &Value::Float(3.0));
    show(&mut harness, &other);
    show(&mut harness, &folder.path().join("in.png"));
    harness.state_mut().undo();
    assert_eq!(painted(harness.state(), Channel::Mask)(45, 30), 0);
    // Saved, it is as safe as a file.
    let over = harness.state().open.playback().and_then(Playback::painted).expect("maps");
    maps::write_all(Kind::Mask, &over, &file, Existing::Keep).expect("it is saved");
    let saved = Opened::SavedMap(Kind::Mask, file.clone(), over.keys);
    harness.state_mut().take_over(Outcome::Opened(saved));
    assert!(harness.state().unsaved_maps().is_empty());
    let session = harness.state_mut();
    session.leave();
    assert_eq!(session.dialogs.leaving, Leaving::Closes);
}

#[test]
fn files_of_maps_come_back_as_they_were_and_others_are_refused() {
    let folder = support::folder();
    let mut harness = window(folder.path(), "ink");
    let session = harness.state_mut();
    session.painting.brush.channel = Channel::Mask;
    session.begin_stroke([30.0, 30.0], false);
    session.go_on_stroke([60.0, 30.0]);
    session.end_stroke();
    let file = folder.path().join("in-mask.png");
    let maps = Arc::clone(session.open.playback().and_then(|p| p.maps()).expect("maps"));
    maps::write(Kind::Mask, &maps, SIZE, &file).expect("it is saved");
    let read = maps::read(Kind::Mask, &file, [SIZE; 2]).expect("it is read");
    assert_eq!(*read, *maps);
    session.clear_map();
    session.take_over(Outcome::Opened(Opened::Map(Kind::Mask, file.clone(), read)));
    assert_eq!(painted(session, Channel::Mask)(45, 30), 0);
    assert!(session.unsaved_maps().is_empty());
    session.take_over(Outcome::Chosen(Dialog::OpenMap(Kind::Control), vec![file.clone()]));
    session.take_over(Outcome::Chosen(Dialog::SaveMap(Kind::Mask), vec![file.clone()]));
    let wanted = [Request::OpenMap(Kind::Control, file.clone()), Request::SaveMap(Kind::Mask, file.clone())];
    assert_eq!(session.work.take_requests(), wanted);
    // A mask is no control map, nor is one of another picture's size.
    let refused = maps::read(Kind::Control, &file, [SIZE; 2]).expect_err("it is grey").to_string();
    assert!(refused.contains("is grey"), "{refused}");
    let refused = maps::read(Kind::Mask, &file, [(30, 30); 2]).expect_err("of another size").to_string();
    assert!(refused.contains("120x90") && refused.contains("30x30"), "{refused}");
    let refused =
        maps::write(Kind::Mask, &maps, SIZE, &folder.path().join("map.exr")).expect_err("no PNG").to_string();
    assert!(refused.contains("map.exr") && refused.contains(".png"), "{refused}");
}

/// Looks follow a map as `apply` does, by whichever way, to the byte.
#[test]
fn looks_follow_what_is_painted_as_apply_does() {
    let folder = support::folder();
    let at = |name: &str| folder.path().join(name);
    for look in ["ink", "watercolor"] {
        let mut harness = window(folder.path(), look);
        let session = harness.state_mut();
        session.painting.brush.size = 40.0;
        for (channel, way) in [
            (Channel::LineWidth, [[10.0, 40.0], [60.0, 50.0]]),
            (Channel::Detail, [[80.0, 10.0], [80.0, 80.0]]),
            (Channel::Mask, [[20.0, 80.0], [110.0, 80.0]]),
        ] {
            session.painting.brush.channel = channel;
            session.begin_stroke(way[0], false);
            session.go_on_stroke(way[1]);
            session.end_stroke();
        }
        let playback = session.open.playback().expect("a picture");
        let (frame, share) = playback.frame(false).expect("a frame");
        let maps: &Maps = playback.maps().expect("maps");
        for kind in Kind::ALL {
            maps::write(kind, maps, SIZE, &at(&format!("{}.png", kind.option()))).expect("it is saved");
        }
        let own = EditedLook::clone(session.look());
        let task = Task { look: own, frame: Arc::clone(frame), things: None, share, size: SIZE, shot: 1 };
        let mut stylist = Stylist::new(session.library.clone());
        let made = stylist.stylize(&task, &mut Control::default()).expect("a result").expect("not cancelled");
        let made: Vec<u8> = made.to_f32().iter().map(|v| (v * 255.0).round() as u8).collect();
        let mut apply = isophote();
        apply.args(["apply", look]).args([at("in.png"), at("out.png")]).arg("--force");
        succeeds(apply.arg("--control").arg(at("control.png")).arg("--mask").arg(at("mask.png")));
        let applied = image::open(at("out.png")).expect("a picture").into_rgba8();
        assert_eq!(applied.as_raw().len(), made.len());
        let other = applied.as_raw().iter().zip(&made).filter(|(a, b)| a != b).count();
        assert_eq!(other, 0, "{look}");
        // Where the look is taken away there is the picture.
        let source = image::open(at("in.png")).expect("a picture").into_rgba8();
        assert_eq!(applied.get_pixel(60, 80), source.get_pixel(60, 80));
        let mut job = ExportJob::new(DocumentKind::Picture, &at("in.png"), &at("exported.png"), None);
        job.preset = Some(format!("{{\"style\": \"{look}\"}}"));
        job.maps = playback.painted();
        support::export(job);
        assert!(image::open(at("exported.png")).expect("a picture").into_rgba8() == applied, "{look}");
    }
}

/// Pixels of the file that are not square, and frames that follow one another.
#[test]
fn what_is_painted_fits_files_whose_pixels_are_not_square_and_lies_on_all_frames() {
    let folder = support::folder();
    let at = |name: &str| folder.path().join(name);
    for frame in 1..=2 {
        picture(60, 40).save(at(&format!("shot.000{frame}.png"))).expect("it can be written");
    }
    let document = Document::open(&at("shot.####.png"), &Options::default()).expect("a sequence");
    let mut harness = window(folder.path(), "ink");
    let session = harness.state_mut();
    session.show_playback(document.playback().expect("it is read"));
    session.fill_map();
    assert_eq!(command::map_file(session, Kind::Control), at("shot-control.png"));
    let playback = session.open.playback_mut().expect("frames");
    let map = |playback: &Playback| {
        let (frame, _) = playback.frame(false).expect("a frame");
        let control = frame.guides.iter().find(|image| image.guide == Guide::Control);
        (frame.number, Arc::clone(control.expect("what is painted")))
    };
    let first = map(playback);
    playback.step(1);
    let second = document.wait(2).expect("the frame");
    playback.take(document.frames().expect("frames"), Some(Ok(second))).expect("it is shown");
    let next = map(playback);
    assert_eq!((first.0, next.0), (Some(1), Some(2)));
    assert!(Arc::ptr_eq(&first.1, &next.1), "made once");
    // Twice as wide as high.
    let mut command = isophote();
    command.args(["apply", "gaussian"]).args([at("in.png"), at("wide.exr")]).arg("--set=sigma=1");
    succeeds(&mut command);
    let mut exr = exr::prelude::read_all_data_from_file(at("wide.exr")).expect("a file");
    exr.attributes.pixel_aspect = 2.0;
    exr.write().to_file(at("wide.exr")).expect("it can be written");
    show(&mut harness, &at("wide.exr"));
    let session = harness.state_mut();
    let playback = session.open.playback().expect("a picture");
    assert!(playback.file_size() == SIZE && playback.size() != SIZE, "{:?}", playback.size());
    session.painting.brush.channel = Channel::Mask;
    session.begin_stroke([30.0, 30.0], false);
    session.end_stroke();
    let over = session.open.playback().and_then(Playback::painted).expect("maps");
    maps::write_all(Kind::Mask, &over, &at("wide.png"), Existing::Replace).expect("it is saved");
    let mut apply = isophote();
    apply.args(["apply", "ink"]).args([at("wide.exr"), at("out.exr")]).arg("--mask").arg(at("wide.png"));
    succeeds(&mut apply);
    let size = session.open.playback().expect("a picture").size();
    let read = maps::read(Kind::Mask, &at("wide.png"), [over.size, size]).expect("it is read");
    assert_eq!(read.layer(Channel::Mask).get(30, 30), 0);
}
