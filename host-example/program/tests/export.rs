//! Files that the window writes: by another process, the same as on the command line, and nothing that is not whole.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use isophote_finishing::writing::{Depth, FileKind};
use isophote_pictures::transfer::srgb_encode;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::jobs::export::{Export, ExportJob};
use isophote_window::state::batch::Batch;
use isophote_window::state::document::kind::Kind;
use isophote_window::state::formats::{PICTURES, Scaling, VIDEOS};
use isophote_window::state::plan::Plan;
use isophote_window::state::progress::{Progress, State};

use crate::support::video::probe;
use crate::support::{self, cube, fails, folder, isophote, listing, picture, succeeds};

/// This only ends a test that hangs.
const PATIENCE: Duration = Duration::from_secs(120);
const LOOK: &str =
    r#"{"style": "cartoon", "lengths": "pixels", "parameters": {"posterize": 5, "sigma_d": 2}}"#;

fn job(kind: Kind, input: &Path, output: &Path) -> ExportJob {
    // It finds the library beside the program.
    support::library();
    let mut job = ExportJob::new(kind, input, output, Some(LOOK.into()));
    job.program = Some(PathBuf::from(env!("CARGO_BIN_EXE_isophote")));
    if kind != Kind::Scene {
        job.arguments = vec!["--backend".into(), "cpu".into()];
    }
    job
}

/// Waits until `is_so`; returns how far the export is.
fn wait_until(export: &Export, is_so: impl Fn(&Progress) -> bool) -> Progress {
    let started = Instant::now();
    loop {
        let progress = export.poll();
        if is_so(&progress) {
            return progress;
        }
        assert!(started.elapsed() < PATIENCE, "{progress:?}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn ended(job: ExportJob) -> Progress {
    let export = Export::start(job).unwrap_or_else(|e| panic!("{e}"));
    wait_until(&export, |progress| progress.state != State::Running)
}

fn done(job: ExportJob) -> f64 {
    let progress = ended(job);
    assert_eq!((&progress.state, progress.done), (&State::Done, progress.total));
    progress.total
}

#[test]
fn exports_are_what_the_command_line_writes() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("look.json"), LOOK).expect("the folder is writable");
    for number in 1..=3 {
        picture(90 + number, 60).save(at(&format!("in.000{number}.png"))).expect("the folder is writable");
    }
    let apply = |input: &str, output: &str| {
        let mut command = isophote();
        command.current_dir(folder.path()).args(["apply", "--preset", "look.json", input, output]);
        succeeds(command.args(["--backend", "cpu"]));
    };
    let same = |a: &str, b: &str| {
        assert!(fs::read(at(a)).expect("a file") == fs::read(at(b)).expect("a file"), "{a} and {b} differ");
    };
    for name in ["out.png", "out.exr", "out.jpg"] {
        apply("in.0001.png", &format!("apply-{name}"));
        assert_eq!(done(job(Kind::Picture, &at("in.0001.png"), &at(name))), 1.0);
        same(name, &format!("apply-{name}"));
    }
    apply("in.####.png", "apply.####.exr");
    assert_eq!(done(job(Kind::Sequence, &at("in.####.png"), &at("out.####.exr"))), 3.0);
    (1..=3).for_each(|n| same(&format!("out.000{n}.exr"), &format!("apply.000{n}.exr")));
    let mut second = job(Kind::Sequence, &at("in.####.png"), &at("some.####.exr"));
    second.frames = Some("2-3".into());
    assert_eq!(done(second), 2.0);
    assert!(!at("some.0001.exr").exists());
}

#[test]
fn turntables_go_once_around() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("look.json"), LOOK).expect("the folder is writable");
    let scene = cube(folder.path());
    let mut turn = job(Kind::Scene, &scene, &at("turn.####.png"));
    (turn.turntable, turn.frames) = (true, Some("3".into()));
    turn.arguments = ["--size", "64x48"].map(Into::into).into();
    assert_eq!(done(turn), 3.0);
    let (_, _) = succeeds(isophote().current_dir(folder.path()).args([
        "render",
        "cube.gltf",
        "own.####.png",
        "--style",
        "look.json",
        "--size",
        "64x48",
        "--turntable",
        "--frames",
        "3",
    ]));
    let read = |name: &str| fs::read(at(name)).expect("a file");
    for n in 1..=3 {
        assert!(read(&format!("turn.000{n}.png")) == read(&format!("own.000{n}.png")), "frame {n} differs");
    }
    assert!(read("turn.0001.png") != read("turn.0002.png"), "the camera moves");
}

#[test]
fn videos_are_made_of_everything() {
    let Some(folder) = support::video_folder() else { return };
    let at = |name: &str| folder.path().join(name);
    // An odd row and column are left out.
    for number in [1, 2, 4] {
        picture(91, 61).save(at(&format!("in.000{number}.png"))).expect("the folder is writable");
    }
    let mut film = job(Kind::Sequence, &at("in.####.png"), &at("film.mp4"));
    film.arguments.extend(["--on-missing", "skip"].map(Into::into));
    film.rate = 12.0;
    done(film);
    let mut turn = job(Kind::Scene, &cube(folder.path()), &at("turn.mp4"));
    (turn.turntable, turn.frames) = (true, Some("5".into()));
    turn.arguments = ["--size", "65x48"].map(Into::into).into();
    assert_eq!(done(turn), 5.0);
    assert_eq!(done(job(Kind::Video, &at("turn.mp4"), &at("again.mkv"))), 5.0);
    for (name, size, count, rate) in
        [("film.mp4", (90, 60), 3, 12.0), ("turn.mp4", (64, 48), 5, 24.0), ("again.mkv", (64, 48), 5, 24.0)]
    {
        let document = Document::open(&at(name), &Options::default()).unwrap_or_else(|e| panic!("{e}"));
        let frames = document.frames().expect("frames");
        assert_eq!((frames.last(), frames.rate), (count, rate), "{name}");
        let frame = document.wait(count).expect("a frame");
        assert_eq!((frame.width, frame.height), size, "{name}");
    }
    // The first frame is the stylized picture, but for what the encoder loses.
    let mut still = job(Kind::Picture, &at("in.0001.png"), &at("still.png"));
    still.arguments.extend(["--lengths", "pixels"].map(Into::into));
    done(still);
    let still = image::open(at("still.png")).expect("a picture").into_rgb8();
    let film =
        Document::open(&at("film.mp4"), &Options::default()).expect("a video").wait(1).expect("a frame");
    let differences = film.color.iter().enumerate().map(|(i, pixel)| {
        let expected = still.get_pixel(i as u32 % 90, i as u32 / 90).0;
        [0, 1, 2].map(|c: usize| (pixel[c] - f32::from(expected[c]) / 255.0).abs()).iter().sum::<f32>() / 3.0
    });
    let mean = differences.sum::<f32>() / (90.0 * 60.0);
    assert!(mean < 0.02, "the video differs by {mean} from its pictures");
}

#[test]
fn what_is_cancelled_leaves_nothing() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(1600, 1200).save(at("in.png")).expect("the folder is writable");
    let look = r#"{"style": "oil_paint"}"#;
    let start = |output: &str| {
        let mut job = job(Kind::Picture, &at("in.png"), &at(output));
        job.preset = Some(look.into());
        Export::start(job).unwrap_or_else(|e| panic!("{e}"))
    };
    let is_left = |names: &[&str]| {
        let started = Instant::now();
        while listing(folder.path()) != names {
            assert!(started.elapsed() < PATIENCE, "{:?} is left", listing(folder.path()));
            std::thread::sleep(Duration::from_millis(5));
        }
    };
    let mut export = start("out.png");
    let progress = wait_until(&export, |progress| progress.done > 0.0);
    assert!(progress.done < 1.0 && progress.total == 1.0, "a picture tells its share: {progress:?}");
    export.cancel();
    assert_eq!(wait_until(&export, |progress| progress.state != State::Running).state, State::Cancelled);
    assert_eq!(listing(folder.path()), ["in.png"]);
    let export = start("dropped.png");
    wait_until(&export, |progress| progress.done > 0.0);
    drop(export);
    drop(start("at-once.png"));
    is_left(&["in.png"]);
    // What was there before stays.
    fs::write(at("out.png"), "before").expect("the folder is writable");
    let mut export = start("out.png");
    wait_until(&export, |progress| progress.total > 0.0);
    export.cancel();
    wait_until(&export, |progress| progress.state == State::Cancelled);
    assert_eq!(fs::read(at("out.png")).expect("a file"), b"before");
    is_left(&["in.png", "out.png"]);
}

#[test]
fn videos_that_are_cancelled_leave_no_process_and_no_file() {
    let Some(folder) = support::video_folder() else { return };
    let at = |name: &str| folder.path().join(name);
    let mut turn = job(Kind::Scene, &cube(folder.path()), &at("turn.mp4"));
    (turn.turntable, turn.frames) = (true, Some("500".into()));
    turn.arguments = ["--size", "320x240"].map(Into::into).into();
    let before = listing(folder.path());
    let mut export = Export::start(turn).unwrap_or_else(|e| panic!("{e}"));
    let progress = wait_until(&export, |progress| progress.done >= 2.0);
    assert_eq!(progress.total, 500.0);
    export.cancel();
    wait_until(&export, |progress| progress.state == State::Cancelled);
    assert_eq!(listing(folder.path()), before);
}

#[test]
fn failures_are_told_in_the_words_of_the_verb() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(40, 30).save(at("in.0001.png")).expect("the folder is writable");
    fs::write(at("in.0002.png"), "no picture").expect("the folder is writable");
    let fails = |job: ExportJob, words: &[&str]| {
        let State::Failed(text) = ended(job).state else { panic!("nothing is wrong") };
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    };
    fails(job(Kind::Picture, &at("missing.png"), &at("out.png")), &["missing.png"]);
    fails(job(Kind::Picture, &at("in.0001.png"), &at("no/out.png")), &["no/out.png", "cannot be written"]);
    fails(job(Kind::Picture, &at("in.0001.png"), &at("out.gif")), &["out.gif", ".png"]);
    let bad = |text: &str| ExportJob {
        preset: Some(text.into()),
        ..job(Kind::Picture, &at("in.0001.png"), &at("out.png"))
    };
    fails(bad("{"), &["look.json"]);
    fails(bad(r#"{"style": "cartoon", "parameters": {"posterise": 1}}"#), &["posterise"]);
    // The other frames are done.
    fails(job(Kind::Sequence, &at("in.####.png"), &at("out.####.png")), &["in.0002.png", "1 of 2 frames"]);
    assert!(at("out.0001.png").is_file());
    let mut none = job(Kind::Picture, &at("in.0001.png"), &at("out.png"));
    none.program = Some(at("nowhere"));
    fails(none, &["cannot be started"]);
    let plain = ExportJob { preset: None, ..job(Kind::Picture, &at("in.0001.png"), &at("out.png")) };
    assert!(Export::start(plain).is_err());
    assert_eq!(listing(folder.path()), ["in.0001.png", "in.0002.png", "out.0001.png"]);
}

/// The job of a plan, as the window makes it.
fn planned(plan: &Plan, input: &Path) -> ExportJob {
    let mut job = job(plan.kind, input, Path::new(&plan.path));
    (job.frames, job.rate) = (plan.frames(), plan.rate);
    job.arguments.extend(plan.options().words().into_iter().map(Into::into));
    job
}

/// The first value of the first table of quantization of a JPEG file, which its quality says.
fn coarseness(file: &Path) -> u8 {
    let bytes = fs::read(file).expect("a file");
    let table = bytes.windows(2).position(|two| two == [0xFF, 0xDB]).expect("a table");
    bytes[table + 5]
}

#[test]
fn size_quality_and_depth_are_those_that_were_chosen() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(90, 61).save(at("in.png")).expect("the folder is writable");
    let plan = |format: usize, change: &dyn Fn(&mut Plan)| {
        let mut plan = Plan::new(Kind::Picture, &at("in.png"), None, (90, 61), 0);
        plan.format = PICTURES[format];
        plan.rename();
        change(&mut plan);
        assert_eq!(done(planned(&plan, &at("in.png"))), 1.0);
        PathBuf::from(plan.path)
    };
    let color = |file: &Path| image::open(file).expect("a picture").color();
    let deep = plan(0, &|plan| {
        plan.choices.depth = Some(Depth::Sixteen);
        plan.choices.scaling = Scaling::Half;
    });
    assert_eq!(image::image_dimensions(&deep).expect("a picture"), (45, 31));
    assert_eq!(color(&deep), image::ColorType::Rgb16);
    let is_finer = |pixel: &image::Rgb<u16>| pixel.0.iter().any(|v| v % 257 != 0);
    assert!(image::open(&deep).expect("a picture").into_rgb16().pixels().any(is_finer), "more than 8 bits");
    let loose = plan(1, &|plan| plan.choices.quality = 40);
    assert_eq!(coarseness(&loose), 20);
    let usual = plan(1, &|_| {});
    assert_eq!((coarseness(&usual), color(&usual)), (2, image::ColorType::Rgb8));
    let light = plan(2, &|plan| {
        (plan.choices.depth, plan.choices.scaling, plan.choices.side) =
            (Some(Depth::Float), Scaling::Width, 30);
    });
    assert_eq!(image::image_dimensions(&light).expect("a picture"), (30, 20));
    assert_eq!(color(&light), image::ColorType::Rgb32F);
    let light = image::open(&light).expect("a picture");
    // Floats are of light: what is opened again is the same picture.
    let small = plan(2, &|plan| (plan.choices.scaling, plan.choices.side) = (Scaling::Width, 30));
    let small = image::open(&small).expect("a picture").into_rgb8();
    for (light, encoded) in light.into_rgb32f().pixels().zip(small.pixels()) {
        let again = srgb_encode(light[1]) * 255.0;
        assert!((again - f32::from(encoded[1])).abs() < 2.5, "{again} {}", encoded[1]);
    }
    let exr = plan(3, &|plan| plan.choices.depth = Some(Depth::Float));
    let (text, _) = succeeds(isophote().args(["info", "--json"]).arg(exr));
    assert!(text.contains("32"), "{text}");
}

#[test]
fn options_that_files_cannot_have_are_refused_with_what_they_can() {
    let folder = folder();
    picture(20, 12).save(folder.path().join("in.png")).expect("the folder is writable");
    for (output, options, words) in [
        ("out.png", &["--quality", "50"][..], &["--quality", "JPEG"][..]),
        ("out.jpg", &["--depth", "16"], &["--depth", "choose 8"]),
        ("out.tif", &["--depth", "half"], &["8 or 16 or float"]),
        ("out.png", &["--codec", "h264"], &["--codec", "videos"]),
        ("out.png", &["--format", "jpeg"], &["--format", "--to"]),
        ("out.png", &["--resize", "12"], &["50%", "1920x"]),
    ] {
        let mut command = isophote();
        command.current_dir(folder.path()).args(["apply", "cartoon", "in.png", output]).args(options);
        fails(&mut command, 2, words);
    }
    assert_eq!(listing(folder.path()), ["in.png"]);
}

#[test]
fn codecs_rates_and_ranges_are_those_that_were_chosen() {
    let Some(folder) = support::video_folder() else { return };
    let at = |name: &str| folder.path().join(name);
    for number in 1..=4 {
        picture(96, 64).save(at(&format!("in.000{number}.png"))).expect("the folder is writable");
    }
    let input = at("in.####.png");
    let frames = Document::open(&input, &Options::default()).expect("a sequence").frames();
    let made = |format: usize, scaling: Scaling| {
        let mut plan = Plan::new(Kind::Sequence, &input, frames.clone(), (96, 64), 0);
        (plan.first, plan.last, plan.rate) = (2, 4, 12.5);
        (plan.format, plan.choices.scaling) = (VIDEOS[format], scaling);
        plan.rename();
        assert_eq!(done(planned(&plan, &input)), 3.0);
        probe(Path::new(&plan.path), "v:0", "codec_name,width,height,pix_fmt,r_frame_rate,nb_frames")
    };
    assert_eq!(made(0, Scaling::Same), "h264,96,64,yuv420p,25/2,3");
    assert_eq!(made(3, Scaling::Half), "prores,48,32,yuv422p10le,25/2,3");
    assert!(made(7, Scaling::Half).starts_with("gif,48,32,"));
    // Of a video some frames become pictures, and all a smaller video.
    let film = at("in-look.mp4");
    let frames = Document::open(&film, &Options::default()).expect("a video").frames();
    let mut plan = Plan::new(Kind::Video, &film, frames, (96, 64), 0);
    plan.format = PICTURES[1];
    (plan.first, plan.last) = (2, 3);
    plan.rename();
    assert_eq!(done(planned(&plan, &film)), 2.0);
    (plan.format, plan.choices.scaling, plan.choices.side) = (VIDEOS[4], Scaling::Height, 33);
    plan.path = at("small.mkv").display().to_string();
    assert_eq!(done(planned(&plan, &film)), 3.0);
    assert_eq!(probe(&at("small.mkv"), "v:0", "width,height"), "50,34");
    let names = listing(folder.path());
    let pictures: Vec<_> = names.iter().filter(|name| name.ends_with(".jpg")).collect();
    assert_eq!(pictures, ["in-look-look.0002.jpg", "in-look-look.0003.jpg"]);
}

#[test]
fn one_look_goes_on_many_pictures_and_one_that_fails_does_not_stop_the_others() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(40, 30).save(at("a.png")).expect("the folder is writable");
    picture(30, 40).save(at("c.jpg")).expect("the folder is writable");
    fs::write(at("b.png"), "no picture").expect("the folder is writable");
    let to = at("made of them");
    let mut batch = Batch::new(["a.png", "b.png", "c.jpg"].map(at).to_vec(), None);
    batch.kind = Some(FileKind::Jpeg);
    (batch.choices.quality, batch.choices.scaling) = (40, Scaling::Half);
    let mut many = job(Kind::Picture, &at("a.png"), &to);
    many.more = ["b.png", "c.jpg"].map(at).to_vec();
    many.arguments.extend(batch.options().words().into_iter().map(Into::into));
    let progress = ended(many);
    let State::Partly(failures) = &progress.state else { panic!("{progress:?}") };
    assert!(matches!(failures.as_slice(), [one] if one.contains("b.png")), "{failures:?}");
    assert_eq!((progress.done, progress.total), (3.0, 3.0));
    assert_eq!(listing(&to), ["a.jpg", "c.jpg"]);
    assert_eq!(image::image_dimensions(to.join("c.jpg")).expect("a picture"), (15, 20));
    assert_eq!(coarseness(&to.join("a.jpg")), 20);
    // What is finished stays when the rest is cancelled.
    picture(1600, 1200).save(at("large.png")).expect("the folder is writable");
    let kept = at("kept");
    let mut many = job(Kind::Picture, &at("a.png"), &kept);
    many.more = ["large.png", "c.jpg"].map(at).to_vec();
    many.preset = Some(r#"{"style": "oil_paint"}"#.into());
    let mut export = Export::start(many).unwrap_or_else(|e| panic!("{e}"));
    wait_until(&export, |progress| progress.done >= 1.0);
    export.cancel();
    wait_until(&export, |progress| progress.state == State::Cancelled);
    assert!(listing(&kept).contains(&"a.png".to_owned()) && !listing(&kept).contains(&"c.jpg".to_owned()));
}
