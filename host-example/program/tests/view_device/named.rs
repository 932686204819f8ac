//! Pictures under their own names: what is opened is what is seen, whichever processor computes its looks.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;

use isophote_finishing::apply::backend::Backend;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::state::playback::Playback;

use super::{App, CANVAS, SIZE, Script, Step, alone, is_at_rest, session};
use crate::support::window::screen;

/// A picture of one colour and a session that shows it.
fn plain_picture(folder: &Path, name: &str, size: (u32, u32), color: [u8; 3]) -> Playback {
    let file = folder.join(name);
    image::RgbImage::from_pixel(size.0, size.1, image::Rgb(color)).save(&file).unwrap();
    Document::open(&file, &Options::default()).unwrap().playback().unwrap()
}

/// Pixels of the canvas that are much redder than blue, or the other way round, in whichever order the screen has its colours.
fn tinted(pixels: &[u8]) -> [usize; 2] {
    let more = |a: usize, b: usize| {
        pixels.chunks_exact(4).filter(|pixel| i32::from(pixel[a]) - i32::from(pixel[b]) > 60).count()
    };
    [more(0, 2), more(2, 0)]
}

/// Opens a wide blue picture while a high red one is shown in a look, and watches what is to be seen until all is done.
fn opened_after_another(backend: Backend, folder: &Path) {
    let mut session = session(folder, &["cartoon"], (96, 64));
    session.backend = backend;
    session.show_playback(plain_picture(folder, "red.png", (240, 320), [200, 30, 30]));
    let blue = plain_picture(folder, "blue.png", (1500, 700), [30, 30, 200]);
    let (seen, mut blue) = (folder.to_owned(), Some(blue));
    let red = Rc::new(RefCell::new(0));
    let (known, known_too) = (Rc::clone(&red), red);
    let open = move |app: &mut App| {
        let [a, b] = tinted(&screen(&seen, CANVAS));
        if a.max(b) < 5000 || !is_at_rest(app) {
            return false;
        }
        *known.borrow_mut() = usize::from(b > a);
        app.session_mut().show_playback(blue.take().unwrap());
        true
    };
    let folder = folder.to_owned();
    let (mut is_plain_seen, mut is_other_seen) = (false, false);
    let watch = move |app: &mut App| {
        let (red, counts) = (*known_too.borrow(), tinted(&screen(&folder, CANVAS)));
        let [old, new] = [counts[red], counts[1 - red]];
        // The screen's file may be read while it is drawn on.
        is_other_seen |= old == 0;
        assert!(!is_other_seen || old == 0, "{old} pixels of the picture of before under the new one's name");
        let is_done = is_at_rest(app);
        assert!(!is_done || new > 5000, "the new picture is to be seen");
        is_plain_seen |= !is_done && new > 5000 && app.session().work.busy.is_some();
        assert!(
            !is_done || is_plain_seen,
            "it is to be seen before its look is there, and that this is made"
        );
        is_done && app.session().open.name() == "blue.png"
    };
    let steps: Vec<(&'static str, Step)> =
        vec![("the red picture", Box::new(open)), ("the blue picture alone", Box::new(watch))];
    let app = Script::run(session, SIZE, steps);
    assert!(app.failure.is_none(), "{:?}", app.failure);
}

#[test]
fn what_is_opened_is_seen_at_once_and_what_was_is_not_seen_under_its_name() {
    alone("named::what_is_opened_is_seen_at_once_and_what_was_is_not_seen_under_its_name", |folder| {
        opened_after_another(Backend::Auto, folder);
    });
}

#[test]
fn so_it_is_where_the_device_computes_looks() {
    alone("named::so_it_is_where_the_device_computes_looks", |folder| {
        opened_after_another(Backend::Gpu, folder)
    });
}
