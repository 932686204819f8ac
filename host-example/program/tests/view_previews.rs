//! Previews of looks: that they are what the whole picture would be if it were made small, and that they are made in order,
//! kept, and given up.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use egui::{Color32, ColorImage};
use isophote_loader::Library;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::jobs::preview::queue::Queue;
use isophote_window::jobs::preview::render::Renderer;
use isophote_window::state::document::reduce;
use isophote_window::state::look::EditedLook;
use isophote_window::state::preview::order::{FINENESS, Order};
use isophote_window::state::preview::picture::Picture;
use isophote_window::state::preview::{Place, Previews};

use crate::support;

/// This only ends a test that hangs.
const PATIENCE: Duration = Duration::from_secs(120);
/// Times that thumbnails are smaller than the picture here.
const FACTOR: u32 = 6;
/// Mean levels by which they may differ from the whole picture made small. Hatching differs most: its lines are drawn anew at
/// each size.
const MOST_DIFFERENT: f32 = 12.0;

fn library() -> Library {
    Library::from_file(support::library()).expect("the library")
}

fn look(name: &str) -> Arc<EditedLook> {
    Arc::new(EditedLook::open(&library(), name.as_ref()).expect("a look"))
}

fn picture(width: u32, height: u32) -> Arc<Picture> {
    let folder = support::folder();
    let file = folder.path().join("picture.png");
    support::picture(width, height).save(&file).expect("the folder is writable");
    let document = Document::open(&file, &Options::default()).expect("a picture");
    let frame = document.wait(1).expect("a picture");
    Arc::new(Picture { frame, things: None, size: (width, height), exposure: 1.0 })
}

fn rendered(picture: &Picture, order: &Order) -> ColorImage {
    let mut renderer = Renderer::new(library(), 0);
    renderer.render(picture, order, &|| false).expect("a preview").expect("it was not cancelled")
}

/// Mean difference of two pictures, in levels of 255.
fn difference(a: &ColorImage, b: &ColorImage) -> f32 {
    assert_eq!(a.size, b.size);
    let levels = |color: &Color32| color.to_array().map(f32::from);
    let far = |(a, b): (&Color32, &Color32)| {
        levels(a).iter().zip(levels(b)).take(3).map(|(a, b)| (a - b).abs()).sum::<f32>() / 3.0
    };
    a.pixels.iter().zip(&b.pixels).map(far).sum::<f32>() / a.pixels.len() as f32
}

/// A picture made smaller by averaging its light.
fn smaller(image: &ColorImage) -> ColorImage {
    let light = |v: u8| isophote_pictures::transfer::srgb_decode(f32::from(v) / 255.0);
    let level = |v: f32| (isophote_pictures::transfer::srgb_encode(v) * 255.0).round() as u8;
    let factor = FACTOR as usize;
    let size = image.size.map(|side| side / factor);
    let mean = |x: usize, y: usize, channel: usize| {
        let cells = (0..factor * factor).map(|at| (x * factor + at % factor, y * factor + at / factor));
        let sum: f32 =
            cells.map(|(x, y)| light(image.pixels[y * image.size[0] + x].to_array()[channel])).sum();
        level(sum / (factor * factor) as f32)
    };
    let pixels = (0..size[0] * size[1]).map(|at| {
        let (x, y) = (at % size[0], at / size[0]);
        Color32::from_rgb(mean(x, y, 0), mean(x, y, 1), mean(x, y, 2))
    });
    ColorImage::new(size, pixels.collect())
}

#[test]
fn the_picture_itself_is_its_preview() {
    let picture = picture(48, 32);
    let image = rendered(&picture, &Order::whole(look("none"), (48, 32), 2));
    let wanted = support::picture(48, 32);
    for (pixel, wanted) in image.pixels.iter().zip(wanted.pixels()) {
        let [r, g, b] = wanted.0;
        assert_eq!(*pixel, Color32::from_rgb(r, g, b));
    }
}

#[test]
fn a_small_preview_is_the_whole_picture_made_small() {
    let picture = picture(1080, 720);
    let small = (1080 / FACTOR, 720 / FACTOR);
    for name in [
        "cartoon",
        "watercolor",
        "look:fineliner",
        "look:copperplate",
        "look:impasto",
        "look:midnight_blueprint",
    ] {
        let look = look(name);
        let whole = smaller(&rendered(&picture, &Order::whole(Arc::clone(&look), (1080, 720), 1)));
        let [coarse, fine] = [1, FINENESS].map(|fineness| {
            difference(&rendered(&picture, &Order::whole(Arc::clone(&look), small, fineness)), &whole)
        });
        let plain = difference(&rendered(&picture, &Order::whole(self::look("none"), small, 1)), &whole);
        eprintln!(
            "{name}: {fine:.2} levels from the whole picture made small, {coarse:.2} if it were no finer, {plain:.2} without the look"
        );
        // Surroundings that decide about lines are of fewer pixels in a preview, so that a few lines are others.
        assert!(
            fine < MOST_DIFFERENT && fine < plain && fine < coarse * 0.6,
            "{name}: {fine} {coarse} {plain}"
        );
    }
}

#[test]
fn a_part_is_cut_from_the_whole_to_the_bit() {
    let picture = picture(160, 120);
    for name in ["none", "cartoon", "ink", "oil_paint"] {
        let look = look(name);
        let whole = rendered(&picture, &Order::whole(Arc::clone(&look), (80, 60), 2));
        let part = [[30, 20], [50, 41]];
        let order = Order { part, ..Order::whole(look, (80, 60), 2) };
        let cut = rendered(&picture, &order);
        assert_eq!(cut, whole.region_by_pixels([30, 20], [20, 21]), "{name}");
    }
}

#[test]
fn steady_and_animated_looks_have_previews_and_alpha_shows_squares() {
    let folder = support::folder();
    let file = folder.path().join("steady.json");
    let text = r#"{"style": "cartoon", "parameters": {"steadiness": 0.5, "posterize": {"1": 2, "9": 8}}}"#;
    std::fs::write(&file, text).expect("the folder is writable");
    let picture = picture(60, 40);
    let look = Arc::new(EditedLook::open(&library(), &file).expect("a look"));
    let image = rendered(&picture, &Order::whole(look, (60, 40), 1));
    assert!(difference(&image, &rendered(&picture, &Order::whole(self::look("none"), (60, 40), 1))) > 1.0);
    let clear = image::RgbaImage::from_pixel(32, 16, image::Rgba([255, 0, 0, 0]));
    let file = folder.path().join("clear.png");
    clear.save(&file).expect("the folder is writable");
    let frame = Document::open(&file, &Options::default()).and_then(|d| d.wait(1)).expect("a picture");
    let clear = Picture { frame, things: None, size: (32, 16), exposure: 1.0 };
    let image = rendered(&clear, &Order::whole(self::look("none"), (32, 16), 1));
    assert!(image.pixels[0] != image.pixels[8] && image.pixels[0].r() == image.pixels[0].g());
}

/// Collects previews until nothing is to be made.
fn finish(queue: &Queue, previews: &mut Previews, want: &dyn Fn(&mut Previews)) -> u32 {
    let (started, mut made) = (Instant::now(), 0);
    loop {
        for done in queue.collect() {
            previews.take(done);
            made += 1;
        }
        want(previews);
        let tasks = previews.tasks();
        if tasks.is_empty() {
            return made;
        }
        queue.follow(tasks);
        assert!(started.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn previews_are_made_once_and_anew_for_another_picture() {
    let woken = Arc::new(AtomicU32::new(0));
    let count = Arc::clone(&woken);
    let wake = Arc::new(move || {
        count.fetch_add(1, Ordering::Relaxed);
    });
    let queue = Queue::new(library(), wake).expect("a thread");
    let context = egui::Context::default();
    let mut previews = Previews::default();
    let looks = ["cartoon", "ink", "none"].map(look);
    let want = |previews: &mut Previews| {
        for (index, look) in looks.iter().enumerate() {
            previews.want(Place::Card(index as u64), Order::whole(Arc::clone(look), (45, 30), 2));
        }
    };
    want(&mut previews);
    assert!(
        previews.tasks().is_empty() && previews.get(&context, Place::Card(0), false).is_none(),
        "no picture yet"
    );
    previews.set_picture(picture(90, 60));
    assert_eq!(finish(&queue, &mut previews, &want), 3);
    assert!(woken.load(Ordering::Relaxed) >= 3);
    for place in (0..3).map(Place::Card) {
        let preview = previews.get(&context, place, false).expect("it was made");
        assert!(preview.is_current && preview.size == (45, 30) && preview.part == reduce::whole((45, 30)));
        assert!(previews.problem(place).is_none());
    }
    assert_eq!(finish(&queue, &mut previews, &want), 0, "they are kept");
    // A large picture is begun, and given up for another.
    let large = picture(1200, 800);
    previews.set_picture(Arc::clone(&large));
    let slow = |previews: &mut Previews| {
        previews.want(Place::Large, Order::whole(look("oil_paint"), (1200, 800), 1));
    };
    slow(&mut previews);
    assert!(!previews.get(&context, Place::Card(0), false).expect("it is there").is_current);
    queue.follow(previews.tasks());
    std::thread::sleep(Duration::from_millis(30));
    previews.set_picture(picture(90, 60));
    assert_eq!(finish(&queue, &mut previews, &want), 3, "what was begun is not finished");
    assert!(previews.get(&context, Place::Large, false).is_none());
}

#[test]
fn work_is_given_up_when_it_is_cancelled() {
    let picture = picture(900, 600);
    let calls = AtomicU32::new(0);
    let cancelled = || calls.fetch_add(1, Ordering::Relaxed) > 3;
    let mut renderer = Renderer::new(library(), 0);
    let order = Order::whole(look("oil_paint"), (900, 600), 1);
    assert!(renderer.render(&picture, &order, &cancelled).expect("no error").is_none());
    assert!(calls.load(Ordering::Relaxed) > 3);
}

#[test]
fn memory_is_bounded() {
    let mut previews = Previews::default();
    previews.set_picture(picture(60, 40));
    let look = look("none");
    // 64 MiB each, of which one is given up for the other.
    for place in [Place::Card(1), Place::Card(2)] {
        previews.want(place, Order::whole(Arc::clone(&look), (4096, 4096), 1));
        let serial = previews.tasks().first().expect("it is asked for").serial;
        for _ in 0..3 {
            assert!(previews.tasks().is_empty());
        }
        previews.take((serial, Ok(ColorImage::filled([4096, 4096], Color32::RED))));
    }
    let context = egui::Context::default();
    context.input_mut(|input| input.max_texture_side = 8192);
    assert!(previews.get(&context, Place::Card(1), false).is_none());
    assert!(previews.get(&context, Place::Card(2), false).is_some());
}
