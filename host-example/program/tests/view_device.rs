//! The window in this process, on a display without a screen: its device is lost, and counted is what it makes.
#![cfg(target_os = "linux")]

mod directed;
mod laid;
mod named;
mod ruled;

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::rc::Rc;
use std::time::{Duration, Instant};

use isophote_finishing::apply::backend::Backend;
use isophote_finishing::stylize::value::Value;
use isophote_loader::Library;
use isophote_pictures::transfer::srgb_decode;
use isophote_render::gpu::Gpu;
use isophote_scene::Scene;
use isophote_window::app::{App, Event};
use isophote_window::jobs::document::{Document, Options};
use isophote_window::state::look::EditedLook;
use isophote_window::state::scenery::{Scenery, Staging};
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;
use winit::application::ApplicationHandler;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::platform::x11::EventLoopBuilderExtX11;
use winit::window::WindowId;

use crate::support;
use crate::support::window::{Display, Part, screen};

/// This only ends a test that hangs.
const PATIENCE: Duration = Duration::from_secs(600);
const TICK: Duration = Duration::from_millis(2);
/// Names the folder of the screen to the process that has the window.
const FOLDER: &str = "ISOPHOTE_TEST_SCREEN";
const SIZE: (u32, u32) = (700, 420);
/// A window that is drawn soon, for what is done many times.
const SMALL: (u32, u32) = (320, 240);
/// The canvas, above what is said at its lower border.
const CANVAS: Part = [0, 60, 340, 250];

/// Something that is done in the window, or waited for, until it says that it is over.
type Step = Box<dyn FnMut(&mut App) -> bool>;

/// The window, and what is done in it.
struct Script {
    app: App,
    steps: Vec<(&'static str, Step)>,
    at: usize,
    since: Instant,
}

impl Script {
    /// Opens a window of a size, does all steps, and closes it; returns what it was then.
    fn run(session: Session, size: (u32, u32), steps: Vec<(&'static str, Step)>) -> App {
        let mut builder = EventLoop::<Event>::with_user_event();
        let event_loop = builder.with_x11().with_any_thread(true).build().unwrap();
        let app = App::new(session, Some(size), event_loop.create_proxy()).unwrap();
        let mut script = Self { app, steps, at: 0, since: Instant::now() };
        event_loop.run_app(&mut script).unwrap();
        script.app
    }
}

impl ApplicationHandler<Event> for Script {
    fn new_events(&mut self, event_loop: &ActiveEventLoop, cause: StartCause) {
        self.app.new_events(event_loop, cause);
    }

    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        self.app.resumed(event_loop);
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, event: Event) {
        self.app.user_event(event_loop, event);
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, id: WindowId, event: WindowEvent) {
        self.app.window_event(event_loop, id, event);
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        self.app.about_to_wait(event_loop);
        let Some((what, step)) = self.steps.get_mut(self.at) else { return event_loop.exit() };
        assert!(self.since.elapsed() < PATIENCE, "waited too long for {what}");
        if step(&mut self.app) {
            (self.at, self.since) = (self.at + 1, Instant::now());
        }
        if event_loop.control_flow() != ControlFlow::Poll {
            event_loop.set_control_flow(ControlFlow::WaitUntil(Instant::now() + TICK));
        }
    }

    fn exiting(&mut self, event_loop: &ActiveEventLoop) {
        self.app.exiting(event_loop);
    }
}

/// Runs a test of this file in a process of its own, whose display is one without a screen: a process has one event loop.
fn alone(name: &str, test: impl FnOnce(&Path)) {
    if let Some(folder) = std::env::var_os(FOLDER) {
        return test(Path::new(&folder));
    }
    let Some(display) = Display::open("800x600") else { return };
    let mut command = Command::new(std::env::current_exe().unwrap());
    command
        .args(["--exact", &format!("view_device::{name}"), "--nocapture"])
        .env("DISPLAY", &display.name)
        .env("XDG_RUNTIME_DIR", display.folder())
        .env(FOLDER, display.folder())
        .env_remove("WAYLAND_DISPLAY");
    assert!(command.status().unwrap().success());
}

/// A session of some styles with a picture, all on the device.
fn session(folder: &Path, styles: &[&str], size: (u32, u32)) -> Session {
    let library = Library::from_file(support::library()).unwrap();
    let looks = styles.iter().map(|name| EditedLook::open(&library, name.as_ref()).unwrap()).collect();
    let mut session = Session::new(library, looks, Settings::default()).unwrap();
    session.backend = Backend::Gpu;
    let file = folder.join("photo.png");
    support::picture(size.0, size.1).save(&file).unwrap();
    let document = Document::open(&file, &Options::default()).unwrap();
    session.show_playback(document.playback().unwrap());
    session
}

/// Pictures that have been shown.
fn frames(app: &App) -> usize {
    app.session().record.shown()
}

fn is_at_rest(app: &mut App) -> bool {
    app.is_idle() && frames(app) > 0
}

/// Gives a parameter a value, as a slider does.
fn set(app: &mut App, name: &str, value: f32) {
    let session = app.session_mut();
    let parameter =
        session.looks.parameters().iter().find(|parameter| parameter.name == name).unwrap().clone();
    session.set(&parameter, &Value::Float(value));
}

/// Destroys the device; returns how many there were so far.
fn lose(app: &App) -> usize {
    app.gpu().unwrap().device.destroy();
    app.devices()
}

/// State in which a device was lost: how many devices there had been, what was to be seen, pictures shown.
type Loss = Rc<RefCell<(usize, Vec<u8>, usize)>>;

/// A picture whose look is edited, loses its device, and has it again.
fn lost_at_rest(folder: &Path, loss: &Loss) -> Vec<(&'static str, Step)> {
    let folder = folder.to_owned();
    let see = move || screen(&folder, CANVAS);
    let (see_before, see_after, lost, again) = (see.clone(), see, Rc::clone(loss), Rc::clone(loss));
    let edit = |app: &mut App| {
        set(app, "line_amount", 0.9);
        app.session_mut().let_go();
        true
    };
    let lose = move |app: &mut App| {
        *lost.borrow_mut() = (lose(app), see_before(), frames(app));
        // Something is to be drawn: who shows nothing new needs no device.
        set(app, "line_amount", 0.8);
        app.session_mut().undo();
        true
    };
    let recover = move |app: &mut App| {
        let (lost, picture, before) = &*again.borrow();
        if app.devices() == *lost || !is_at_rest(app) || frames(app) <= *before {
            return false;
        }
        let session = app.session();
        let parameter =
            session.looks.parameters().iter().find(|parameter| parameter.name == "line_amount").unwrap();
        assert_eq!(session.look().value(parameter), Value::Float(0.9));
        assert_eq!((session.open.name(), session.can()), ("photo.png", [true, true]));
        see_after() == *picture
    };
    vec![
        ("the picture", Box::new(is_at_rest)),
        ("an edit", Box::new(edit)),
        ("the picture after it", Box::new(is_at_rest)),
        ("a moment", Box::new(pause(Duration::from_millis(700)))),
        ("the loss", Box::new(lose)),
        ("another device", Box::new(recover)),
    ]
}

/// A scene that plays loses its device, and plays on.
fn lost_while_it_plays(scene: PathBuf, loss: &Loss) -> Vec<(&'static str, Step)> {
    let (playing, played) = (Rc::clone(loss), Rc::clone(loss));
    let open = move |app: &mut App| {
        let session = app.session_mut();
        session.undo();
        assert!(!session.look().is_changed());
        let scene = Scene::load(&scene, None).unwrap();
        session.show_scene(Scenery::new(scene, Staging::default(), 1.5), None, "scene".into());
        true
    };
    let lose = move |app: &mut App| {
        *playing.borrow_mut() = (lose(app), Vec::new(), frames(app));
        true
    };
    let plays_on = move |app: &mut App| {
        let (lost, _, before) = &*played.borrow();
        app.devices() > *lost && frames(app) > *before + 5
    };
    vec![
        ("undo, and a scene that plays", Box::new(open)),
        ("frames", Box::new(|app| app.session().open.name() == "scene" && frames(app) > 5)),
        ("the loss while it plays", Box::new(lose)),
        ("more frames", Box::new(plays_on)),
    ]
}

#[test]
fn a_device_that_is_lost_is_replaced_and_nothing_else_is_lost() {
    alone("a_device_that_is_lost_is_replaced_and_nothing_else_is_lost", |folder| {
        let session = session(folder, &["cartoon"], (120, 80));
        let loss = Loss::default();
        let mut steps = lost_at_rest(folder, &loss);
        steps.extend(lost_while_it_plays(support::turning_triangle(folder), &loss));
        let app = Script::run(session, SIZE, steps);
        assert!(app.failure.is_none(), "{:?}", app.failure);
    });
}

/// Waits for so long.
fn pause(long: Duration) -> impl FnMut(&mut App) -> bool {
    let mut since = None;
    move |_| since.get_or_insert_with(Instant::now).elapsed() > long
}

#[test]
fn a_device_that_is_lost_at_once_again_and_again_ends_the_window_with_the_reason() {
    alone("a_device_that_is_lost_at_once_again_and_again_ends_the_window_with_the_reason", |folder| {
        let session = session(folder, &["cartoon"], (120, 80));
        let mut lost = 0;
        let mut losses = 0;
        let spoil: Step = Box::new(move |app| {
            // Something is to be drawn: who shows nothing new needs no device.
            app.session_mut();
            if app.devices() > lost {
                lost = lose(app);
                losses += 1;
            }
            assert!(losses < 20, "the window goes on for ever");
            if losses == 6 {
                assert!(!app.session().open.has_picture(), "what is open is put away first");
            }
            false
        });
        let app = Script::run(session, SIZE, vec![("the picture", Box::new(is_at_rest)), ("the end", spoil)]);
        let failure = app.failure.expect("a reason").to_string();
        assert!(failure.contains("the graphics device was lost"), "{failure}");
    });
}

/// Moves the pointer to a place of the window.
fn point(x: f32, y: f32) -> impl FnMut(&mut App) -> bool {
    move |_| {
        let place = [x, y].map(|v| format!("{v:.0}"));
        Command::new("xdotool").arg("mousemove").args(&place).status().unwrap().success()
    }
}

/// What is shown at rest, and then what is found under the pointer.
fn pointed(is_found: impl FnMut(&mut App) -> bool + 'static) -> Vec<(&'static str, Step)> {
    vec![
        ("the picture", Box::new(is_at_rest)),
        ("a moment", Box::new(pause(Duration::from_millis(500)))),
        ("the pointer on it", Box::new(point(176.0, 200.0))),
        ("the pixel", Box::new(is_found)),
    ]
}

#[test]
fn a_scene_is_shaded_by_its_own_light() {
    alone("a_scene_is_shaded_by_its_own_light", |folder| {
        let mut session = session(folder, &["toon_shading"], SIZE);
        let scene = Scene::load(&support::cube(folder), None).unwrap();
        session.show_scene(Scenery::new(scene, Staging::default(), 1.0), None, "scene".into());
        let steps = session.looks.parameters().iter().find(|parameter| parameter.name == "steps").cloned();
        session.set(&steps.unwrap(), &Value::Int(1));
        let is_shaded = |app: &mut App| {
            let Some(probed) = app.session().probed else { return false };
            // Its colours times that of the only step, #8a8ab0.
            let expected =
                [(0.9, 138), (0.3, 138), (0.1, 176)].map(|(v, b)| v * srgb_decode(b as f32 / 255.0));
            let shown = probed.shown.expect("the pixel of the look");
            assert!((0..3).all(|k| (shown[k] - expected[k]).abs() < 0.002), "{shown:?}, not {expected:?}");
            true
        };
        let app = Script::run(session, SIZE, pointed(is_shaded));
        assert!(app.failure.is_none(), "{:?}", app.failure);
    });
}

#[test]
fn the_pixel_under_the_pointer_is_that_of_the_file_and_there_is_none_beside_the_picture() {
    let name = "the_pixel_under_the_pointer_is_that_of_the_file_and_there_is_none_beside_the_picture";
    alone(name, |folder| {
        let size = (120, 80);
        let session = session(folder, &["cartoon"], size);
        let is_probed = move |app: &mut App| {
            let session = app.session();
            let Some(probed) = session.probed else { return false };
            let [x, y] = probed.at;
            assert_eq!(session.viewport.pixel(size, [176.0, 200.0]), Some((x, y)));
            let expected = support::picture(size.0, size.1).get_pixel(x, y).0;
            let bytes = probed.original.map(|value| (value * 255.0).round() as u8);
            assert_eq!(bytes[..3], expected[..3], "at {x}, {y}");
            let shown = probed.shown.expect("the pixel of the look");
            assert!(shown != probed.original && shown.iter().all(|value| (0.0..=1.0).contains(value)));
            let numbers = expected[..3].iter().map(u8::to_string).collect::<Vec<_>>().join(" ");
            let start = format!("{x}, {y}   original {numbers}   look ");
            assert!(probed.lines(true)[0].starts_with(&start), "{}", probed.lines(true)[0]);
            true
        };
        let mut steps = pointed(is_probed);
        steps.push(("the pointer above the picture", Box::new(point(176.0, 50.0))));
        steps.push(("no pixel", Box::new(|app| app.session().probed.is_none())));
        let app = Script::run(session, SIZE, steps);
        assert!(app.failure.is_none(), "{:?}", app.failure);
    });
}

/// Number of objects on the device, kind by kind.
fn objects(gpu: &Gpu) -> Vec<(&'static str, usize)> {
    let report = gpu.instance.generate_report().unwrap();
    let hub = report.hub_report();
    [
        ("bind groups", &hub.bind_groups),
        ("buffers", &hub.buffers),
        ("textures", &hub.textures),
        ("views", &hub.texture_views),
        ("samplers", &hub.samplers),
        ("compute pipelines", &hub.compute_pipelines),
        ("render pipelines", &hub.render_pipelines),
        ("shader modules", &hub.shader_modules),
        ("layouts", &hub.bind_group_layouts),
        ("pipeline layouts", &hub.pipeline_layouts),
    ]
    .map(|(name, kind)| (name, kind.num_allocated))
    .into()
}

/// Bytes of memory that the process holds.
fn resident() -> u64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = text.lines().find(|line| line.starts_with("VmRSS:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap() << 10
}

/// Memory and objects that the process and the device hold at a moment.
struct Usage {
    memory: u64,
    objects: Vec<(&'static str, usize)>,
    made: u64,
    uploads: u64,
}

impl Usage {
    fn now(app: &App) -> Self {
        let counts = app.counts().unwrap();
        let gpu = app.gpu().unwrap();
        Self { memory: resident(), objects: objects(gpu), made: counts.objects, uploads: counts.uploads }
    }

    /// Bytes of memory more than before.
    fn grown_since(&self, before: &Self, what: &str) -> u64 {
        let grown = self.memory.saturating_sub(before.memory);
        eprintln!("{what}: {} KiB more of {} MiB", grown >> 10, self.memory >> 20);
        grown
    }
}

/// When something is done again.
#[derive(Clone, Copy, PartialEq)]
enum Pause {
    /// As soon as a picture has been shown, as while a slider is dragged.
    Frame,
    /// When nothing is left to be done.
    Rest,
}

/// Does something in the window so many times, and hands over what was held after the first ones, and what is held at the
/// end, both at rest.
fn repeat(
    pause: Pause,
    times: usize,
    first: usize,
    mut act: impl FnMut(&mut App, usize) + 'static,
    mut compare: impl FnMut(Usage, Usage) + 'static,
) -> Step {
    let mut done = 0;
    let mut drawn = 0;
    let mut warm = None;
    Box::new(move |app| {
        let is_looked_at = done == first || done == times;
        let rests = pause == Pause::Rest || is_looked_at;
        if done > 0 && (frames(app) == drawn || rests && !app.is_idle()) {
            return false;
        }
        if done == first {
            warm = Some(Usage::now(app));
        }
        if done == times {
            compare(warm.take().expect("there are more than the first ones"), Usage::now(app));
            return true;
        }
        drawn = frames(app);
        act(app, done);
        done += 1;
        false
    })
}

/// Bytes that a move may leave behind in the mean. Software drivers keep some kilobytes of every pass that they have
/// recorded, also where the same picture is drawn again and again; a picture of this size has 96 KiB, and its plan a
/// texture or more.
const OF_A_MOVE: u64 = 40 << 10;
/// Bytes that a switch may leave behind in the mean, of styles with ten times as many passes and textures of 96 KiB
/// each.
const OF_A_SWITCH: u64 = 400 << 10;

#[test]
fn three_hundred_moves_of_a_slider_only_rewrite_uniform_bytes() {
    alone("three_hundred_moves_of_a_slider_only_rewrite_uniform_bytes", |folder| {
        let session = session(folder, &["gaussian"], (96, 64));
        // All of these need the same number of taps.
        let moves = repeat(
            Pause::Frame,
            300,
            60,
            |app, step| set(app, "sigma", 2.01 + (step % 50) as f32 / 100.0),
            |warm, end| {
                let (made, uploads) = (end.made - warm.made, end.uploads - warm.uploads);
                eprintln!("240 moves: {made} objects, {uploads} uploads");
                assert!(uploads >= 200, "{uploads} uploads");
                // Where the machine stalls, the picture is smaller for a while: once for each size, its look is built.
                assert!(made < 60, "{made} objects are made");
                let is_kept = |((_, warm), (_, end)): (&(_, usize), &(_, usize))| *end < warm + 60;
                assert!(warm.objects.iter().zip(&end.objects).all(is_kept), "{:?}", end.objects);
                assert!(end.grown_since(&warm, "300 moves") < 240 * OF_A_MOVE);
            },
        );
        let app = Script::run(
            session,
            SMALL,
            vec![("the picture", Box::new(is_at_rest) as Step), ("moves", moves)],
        );
        assert!(app.failure.is_none(), "{:?}", app.failure);
    });
}

#[test]
fn moves_that_change_the_passes_and_a_hundred_switches_of_the_style_leave_nothing_behind() {
    let name = "moves_that_change_the_passes_and_a_hundred_switches_of_the_style_leave_nothing_behind";
    alone(name, |folder| {
        let session = session(folder, &["gaussian", "cartoon", "blueprint", "ink"], (96, 64));
        let moves = repeat(
            Pause::Rest,
            120,
            40,
            |app, step| set(app, "mix", 0.2 + (step % 50) as f32 / 100.0),
            |warm, end| {
                let kept = "what a move has made anew takes the place of what was";
                assert_eq!(warm.objects, end.objects, "{kept}");
                assert!(end.grown_since(&warm, "120 moves") < 80 * OF_A_MOVE);
            },
        );
        let switches = repeat(
            Pause::Rest,
            100,
            12,
            |app, _| app.session_mut().choose_next(),
            |warm, end| {
                assert!(end.grown_since(&warm, "100 switches") < 88 * OF_A_SWITCH);
                for ((kind, warm), (_, end)) in warm.objects.iter().zip(&end.objects) {
                    // The styles have different numbers of them, which are 88 switches apart.
                    assert!(*end < warm + 88, "{kind}: {warm} to {end}");
                }
            },
        );
        let steps =
            vec![("the picture", Box::new(is_at_rest) as Step), ("moves", moves), ("switches", switches)];
        let app = Script::run(session, SMALL, steps);
        assert!(app.failure.is_none(), "{:?}", app.failure);
    });
}
