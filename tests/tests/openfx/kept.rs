//! What is kept from one render to the next: memory, and what neighbouring frames have in common. Each test has a process
//! of its own.

use isophote_abi::openfx::*;
use isophote_loader::{AsImage, AsTarget, Control, Image, Input, Library, Sample, Target};
use isophote_tests::library;
use isophote_tests::ofx::effect::{Described, Instance, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::{Binary, Plugin};
use isophote_tests::ofx::state::Behaviour;
use std::ffi::CString;
use std::ptr::null_mut;
use std::time::Instant;

/// A frame of a film, moved a pixel to the right for each.
fn frame([width, height]: [i32; 2], number: i32) -> Picture {
    let value = |x: i32, y: i32, c: i32| {
        let (x, y) = ((x - number) as f32, y as f32);
        if c == 3 { 1.0 } else { 0.5 + 0.3 * (0.11 * x + 0.07 * y + c as f32).sin() }
    };
    let row = |y: i32| (0..width * 4).map(move |i| value(i / 4, y, i % 4));
    let bytes: Vec<u8> = (0..height).flat_map(row).flat_map(f32::to_ne_bytes).collect();
    Picture::packed_in(Layout::default(), width, height, &bytes)
}

/// A frame of the film, of which a row from the bottom is dark.
fn frame_with(size: [i32; 2], number: i32, dark: Option<i32>) -> Picture {
    let whole = frame(size, number);
    let Some(dark) = dark else { return whole };
    let mut bytes = whole.packed();
    let row = size[0] as usize * 16;
    // Packed rows begin at the top.
    let at = (size[1] - 1 - dark) as usize * row;
    bytes[at..at + row]
        .copy_from_slice(&[0.1_f32; 4].map(f32::to_ne_bytes).concat().repeat(size[0] as usize));
    Picture::packed_in(Layout::default(), size[0], size[1], &bytes)
}

/// Frames of a film.
const FRAMES: i32 = 8;

/// An instance that is steadied by clips of motion, with a film for its source.
fn steadied<'h>(described: &Described<'h>, size: [i32; 2]) -> Instance<'h> {
    let instance = described.instance(kOfxImageEffectContextGeneral);
    instance.set("steadiness", 0.5);
    instance.set("window", 2);
    instance.set("motion_from", 1);
    instance.connect_film("Source", 0, (0..FRAMES).map(|n| frame(size, n)).collect());
    instance.connect_film("Motion", 0, (0..FRAMES).map(|_| vectors(size)).collect());
    instance
}

/// An instance of which no segment reads much of another.
fn segmented<'h>(described: &Described<'h>, size: [i32; 2]) -> Instance<'h> {
    let instance = steadied(described, size);
    instance.set("window", 1);
    // What is around lines, and areas, reach from one segment into the other.
    instance.set("inhibition", 0.0);
    instance.set("steps", 0);
    instance
}

/// The motion of the film.
fn vectors(size: [i32; 2]) -> Picture {
    let vectors: Vec<u8> =
        (0..size[0] * size[1]).flat_map(|_| [-1.0, 0.0, 0.0, 1.0_f32]).flat_map(f32::to_ne_bytes).collect();
    Picture::packed_in(Layout::default(), size[0], size[1], &vectors)
}

fn render(instance: &Instance<'_>, size: [i32; 2], time: i32) -> Vec<u8> {
    let wanted = Wanted { time: time.into(), ..Wanted::new([0, 0, size[0], size[1]]) };
    let (status, picture) = instance.try_render(Layout::default(), size, &wanted);
    assert_eq!(status, kOfxStatOK);
    picture.packed()
}

fn purge(plugin: Plugin) {
    assert_eq!(plugin.act(kOfxActionPurgeCaches, null_mut(), None, None), kOfxStatOK);
}

/// Images that were computed for several frames, told in a file.
struct Computed(tempfile::TempDir);

impl Computed {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        // SAFETY: no other test runs in this process, and no other thread reads the environment now.
        unsafe { std::env::set_var("ISOPHOTE_OFX_COMPUTED", folder.path().join("computed")) };
        Self(folder)
    }

    /// Images since the last question.
    fn now(&self) -> usize {
        let path = self.0.path().join("computed");
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let _ = std::fs::remove_file(&path);
        text.lines().map(|line| line.parse::<usize>().unwrap()).sum::<usize>()
    }
}

pub fn what_frames_have_in_common_is_computed_once() {
    if !cfg!(debug_assertions) {
        return;
    }
    let counter = Computed::new();
    let computed = || counter.now();
    let size = [96, 64];
    let binary = Binary::open(library::path());
    let host = Host::new(Behaviour::default());
    let plugin = binary.plugin("org.isophote.cartoon");
    let described = Described::new(&host, plugin);
    let instances = [steadied(&described, size), steadied(&described, size)];
    let first = render(&instances[0], size, 3);
    let all = computed();
    assert!(all > 0 && all.is_multiple_of(5), "{all} of five frames");
    let each = all / 5;
    let second = render(&instances[0], size, 4);
    assert_eq!(computed(), each, "one frame is new");
    assert!(render(&instances[1], size, 3) == first && render(&instances[1], size, 4) == second);
    assert_eq!(computed(), 0, "instances share what they have in common");
    purge(plugin);
    std::thread::scope(|scope| {
        for instance in &instances {
            let first = &first;
            scope.spawn(move || assert!(render(instance, size, 3) == *first));
        }
    });
    assert_eq!(computed(), all, "two threads compute each once");
    assert!(render(&instances[0], size, 4) == second && render(&instances[0], size, 3) == first);
    assert_eq!(computed(), each);
    // A frame that became another one without a word from the host.
    let frames = |changed| (0..FRAMES).map(move |n| frame(size, if n == 2 { changed } else { n }));
    instances[0].connect_film("Source", 0, frames(70).collect());
    let other = render(&instances[0], size, 3);
    assert!(computed() > 0 && other != first);
    purge(plugin);
    assert!(render(&instances[0], size, 3) == other);
    assert_eq!(computed(), all, "nothing is left after a purge");
    instances[0].connect_film("Source", 0, frames(2).collect());
    assert!(render(&instances[0], size, 3) == first);
    computed();
    // Other values are other images, unless they change nothing that is kept.
    instances[0].set("steadiness", 0.9);
    assert!(render(&instances[0], size, 3) != first);
    assert_eq!(computed(), 0);
    drop(instances);
    host.no_faults();
}

pub fn strips_share_what_frames_have_in_common() {
    if !cfg!(debug_assertions) {
        return;
    }
    // Two segments, in each of which the same is shared.
    let size = [64, 1100];
    let counter = Computed::new();
    let binary = Binary::open(library::path());
    let host = Host::new(Behaviour::default());
    let plugin = binary.plugin("org.isophote.cartoon");
    let described = Described::new(&host, plugin);
    let film = || segmented(&described, size);
    let (whole, strips) = (film(), film());
    let pictures =
        [(0..FRAMES).map(|n| frame(size, n)).collect::<Vec<_>>(), vec![vectors(size); FRAMES as usize]];
    let frames = [2, 3].map(|time| render(&whole, size, time));
    let all = counter.now();
    assert!(all.is_multiple_of(4), "{all} of four frames");
    let each = all / 4;
    purge(plugin);
    let packed = |time: usize| Picture::packed_in(Layout::default(), size[0], size[1], &frames[time - 2]);
    for (time, new) in [(2, 3 * each), (3, each)] {
        let full = packed(time);
        for (index, y) in (0..size[1]).step_by(50).enumerate() {
            let window = [0, y, size[0], y + 50];
            let wanted = Wanted { time: time as f64, ..Wanted::new(window) };
            // The host gives what it was asked for, and no more.
            for (name, pictures) in ["Source", "Motion"].into_iter().zip(&pictures) {
                let region = [0.0, f64::from(y), f64::from(size[0]), f64::from(y + 50)];
                let asked = strips.regions_at(time as f64, region, 1.0).expect("regions");
                let asked = asked.numbers(&CString::new(format!("{}{name}", ROI_PREFIX)).unwrap());
                let asked = [0, 1, 2, 3].map(|side| asked[side] as i32);
                assert!(asked[3] - asked[1] < size[1], "{name}: {asked:?} is no part");
                strips.connect_film(name, 0, pictures.iter().map(|whole| whole.crop(asked)).collect());
            }
            let (status, strip) = strips.try_render(Layout::default(), size, &wanted);
            assert_eq!(status, kOfxStatOK);
            assert!(strip.crop(window).packed() == full.crop(window).packed(), "{window:?} at {time}");
            // The result of a segment is computed with its first strip, too.
            let expected = if [0, 11].contains(&index) { new + 1 } else { 0 };
            assert_eq!(counter.now(), expected, "{window:?} at {time}");
        }
    }
    drop((whole, strips));
    host.no_faults();
}

pub fn strips_are_made_anew_where_what_they_are_made_from_changes() {
    if !cfg!(debug_assertions) {
        return;
    }
    let size = [64, 1100];
    let counter = Computed::new();
    let binary = Binary::open(library::path());
    let host = Host::new(Behaviour::default());
    let plugin = binary.plugin("org.isophote.cartoon");
    let described = Described::new(&host, plugin);
    let film = || segmented(&described, size);
    let strip = |film: &Instance<'_>, y: i32| {
        let window = [0, y, size[0], y + 20];
        let wanted = Wanted { time: 3.0, ..Wanted::new(window) };
        let (status, picture) = film.try_render(Layout::default(), size, &wanted);
        assert_eq!(status, kOfxStatOK);
        picture.crop(window).packed()
    };
    // The film, in which a row of one frame is another.
    let pictures = |changed: Option<(i32, i32)>| -> Vec<Picture> {
        let row_of = |number: i32| changed.filter(|(of, _)| *of == number).map(|(_, row)| row);
        (0..FRAMES).map(|n| frame_with(size, n, row_of(n))).collect()
    };
    let strips = film();
    let row = 300;
    let first = strip(&strips, row);
    assert!(counter.now() > 0);
    assert!(strip(&strips, row) == first && strip(&strips, row + 20) != first);
    assert_eq!(counter.now(), 0, "strips of a segment are copies");
    for (number, changed, counts) in [(4, 60, false), (3, 60, false), (4, row + 30, true), (2, row + 5, true)]
    {
        strips.connect_film("Source", 0, pictures(Some((number, changed))));
        let now = strip(&strips, row);
        assert_eq!(counter.now() > 0, counts, "row {changed} of frame {number}");
        let whole = film();
        whole.connect_film("Source", 0, pictures(Some((number, changed))));
        purge(plugin);
        assert!(strip(&whole, row) == now, "row {changed} of frame {number}");
        purge(plugin);
        strips.connect_film("Source", 0, pictures(None));
        assert!(strip(&strips, row) == first);
        counter.now();
    }
    drop(strips);
    host.no_faults();
}

/// Bytes of this process that are in memory.
fn resident() -> i64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    text.split_whitespace().nth(1).and_then(|pages| pages.parse::<i64>().ok()).unwrap_or(0) * 4096
}

pub fn memory_is_given_back_when_caches_are_purged() {
    if !cfg!(target_os = "linux") {
        return;
    }
    let size = [2200, 2000];
    let bytes = i64::from(size[0]) * i64::from(size[1]) * 16;
    let binary = Binary::open(library::path());
    let host = Host::new(Behaviour::default());
    let plugin = binary.plugin("org.isophote.gaussian");
    let instance = Described::new(&host, plugin).instance(kOfxImageEffectContextFilter);
    instance.connect("Source", frame(size, 0));
    for action in [kOfxActionPurgeCaches, kOfxActionUnload] {
        drop(instance.render(Layout::default(), size));
        let kept = resident();
        assert_eq!(plugin.act(action, null_mut(), None, None), kOfxStatOK);
        let given = kept - resident();
        println!("{given} bytes given back, {bytes} in a picture");
        assert!(given > bytes * 9 / 10 && given <= 512 << 20, "{given} bytes after {action:?}");
    }
}

/// Pages that this process was given so far.
fn pages() -> u64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = text.rsplit_once(") ").map_or("", |(_, fields)| fields);
    fields.split_whitespace().nth(7).and_then(|n| n.parse().ok()).unwrap_or(0)
}

/// Hundredths of seconds that processors have spent in this process: what else runs on the machine does not count.
fn ticks() -> u64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = text.rsplit_once(") ").map_or("", |(_, fields)| fields);
    fields.split_whitespace().skip(11).take(2).filter_map(|n| n.parse::<u64>().ok()).sum()
}

/// Milliseconds of a render, and those that processors spent in it.
fn timed(render: impl FnOnce()) -> [f64; 2] {
    let (before, started) = (ticks(), Instant::now());
    render();
    [started.elapsed().as_secs_f64() * 1e3, (ticks() - before) as f64 * 10.0]
}

/// The least pages and milliseconds of some renders.
fn least(mut render: impl FnMut()) -> (u64, [f64; 2]) {
    let mut all = (u64::MAX, [f64::MAX; 2]);
    for _ in 0..7 {
        let before = pages();
        let times = timed(&mut render);
        all.0 = all.0.min(pages() - before);
        all.1 = [0, 1].map(|at| times[at].min(all.1[at]));
    }
    all
}

/// Pixels of four floats, and the size of their picture.
struct Floats(Vec<u8>, (u32, u32));

impl AsImage for Floats {
    fn image(&self) -> Image<'_> {
        Image::new(&self.0, self.1, 4, Sample::F32).unwrap()
    }
}

impl AsTarget for Floats {
    fn target(&mut self) -> Target<'_> {
        Target::new(&mut self.0, self.1, 4, Sample::F32).unwrap()
    }
}

/// Prints what warm renders take of warm calls of `process`, which `isophote bench` times, and of their passes alone. Each is
/// compared with the one right before it, so that other work on the machine slows both.
fn against_process(id: &str, size: [i32; 2], render: impl Fn()) {
    let library = Library::from_file(library::path()).unwrap();
    let shape = (size[0] as u32, size[1] as u32);
    let (mut graph, request) = (library.single(id).unwrap(), library.request(shape).unwrap());
    let source = Floats(frame(size, 0).packed(), shape);
    let mut result = Floats(vec![0; source.0.len()], shape);
    let (mut calls, mut passes, mut times) = (Vec::new(), Vec::new(), Vec::new());
    for run in 0..22 {
        let mut measured = Vec::new();
        let mut control = Control { measured: Some(&mut measured), ..Control::default() };
        let inputs = [Input { name: "color", pixels: &source }];
        let report = graph.process(None, &request, &inputs, &mut result, &mut control).unwrap();
        let started = Instant::now();
        render();
        let time = started.elapsed().as_secs_f64();
        if run > 0 {
            calls.push(time / report.seconds);
            passes.push(time / measured.iter().map(|pass| pass.seconds).sum::<f64>());
            times.push(report.seconds * 1e3);
        }
    }
    for of in [&mut calls, &mut passes, &mut times] {
        of.sort_by(f64::total_cmp);
    }
    let middle = calls.len() / 2;
    println!(
        "{id}: a warm render takes {:.3} of a call of `process` (of {:.1} ms), {:.3} of its passes",
        calls[middle], times[middle], passes[middle]
    );
}

/// Rounds in which frames are compared with stills.
const ROUNDS: usize = 7;

/// The middle one of some times.
fn middle(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Prints how many stills the first frame of a sequence takes, and later ones, in the median over some sequences: those of the
/// clock, and of processors. Each sequence is compared with stills right before and after it, so that other work on the machine
/// slows both.
fn against_stills(name: &str, purge: impl Fn(), still: impl Fn(), frame: impl Fn(i32)) {
    let (mut firsts, mut others) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    let stills = || {
        // The first finds memory as frames left it.
        still();
        let times = [timed(&still), timed(&still)];
        [0, 1].map(|at| (times[0][at] + times[1][at]) / 2.0)
    };
    let mut before = stills();
    for _ in 0..ROUNDS {
        purge();
        let frames: Vec<[f64; 2]> = (2..6).map(|time| timed(|| frame(time))).collect();
        let after = stills();
        for (number, took) in frames.into_iter().enumerate() {
            let into = if number == 0 { &mut firsts } else { &mut others };
            for at in 0..2 {
                into[at].push(took[at] * 2.0 / (before[at] + after[at]));
            }
        }
        before = after;
    }
    let [first, other] = [&mut firsts, &mut others].map(|all| [middle(&mut all[0]), middle(&mut all[1])]);
    let spread = |all: &[f64]| [all[all.len() / 4], all[all.len() * 3 / 4]];
    println!(
        "{name}: the first frame takes {:.2} stills, {:.2} of processors; later ones {:.2}, {:.2} of processors (half of them {:.2?})",
        first[0],
        first[1],
        other[0],
        other[1],
        spread(&others[1])
    );
}

/// By hand: pages and times of frames of 1920 x 1080, cold and warm, and of neighbours in order. Each time comes with that of
/// processors.
pub fn times_of_warm_renders() {
    let size = [1920, 1080];
    let binary = Binary::open(library::path());
    let host = Host::new(Behaviour::default());
    let wanted = |time: i32| Wanted { time: time.into(), ..Wanted::new([0, 0, size[0], size[1]]) };
    for id in ["gaussian", "cartoon", "ink"] {
        let plugin = binary.plugin(&format!("org.isophote.{id}"));
        let described = Described::new(&host, plugin);
        let still = described.instance(kOfxImageEffectContextFilter);
        still.set("working_space", 1);
        still.connect("Source", frame(size, 0));
        still.connect("Output", Picture::new(Layout::default(), size[0], size[1]));
        let render = || assert_eq!(still.render_connected(&wanted(0)), kOfxStatOK);
        let cold = least(|| {
            purge(plugin);
            render();
        });
        let warm = least(render);
        println!("{id}: cold {} pages, {:.1?} ms; warm {} pages, {:.1?} ms", cold.0, cold.1, warm.0, warm.1);
        against_process(id, size, render);
        if id == "gaussian" {
            continue;
        }
        for (motion_from, rows, name) in
            [(1, size[1], "in order"), (1, 120, "in strips"), (2, size[1], "estimated")]
        {
            let film = steadied(&described, size);
            film.set("working_space", 1);
            film.set("motion_from", motion_from);
            film.connect("Output", Picture::new(Layout::default(), size[0], size[1]));
            let frame = |time: i32| {
                for y in (0..size[1]).step_by(rows as usize) {
                    let window = [0, y, size[0], y + rows];
                    let wanted = Wanted { time: time.into(), ..Wanted::new(window) };
                    assert_eq!(film.render_connected(&wanted), kOfxStatOK);
                }
            };
            against_stills(&format!("{id} {name}"), || purge(plugin), render, frame);
        }
    }
}
