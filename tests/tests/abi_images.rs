//! Images through the C table: formats, strides, overlaps, regions, callbacks, threads, devices.

#![allow(unsafe_code, reason = "calls through the C table")]

use isophote_tests::library::{Loaded, contract::*, text};
use std::ffi::{CString, c_void};
use std::ptr::{null, null_mut};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};

const WIDTH: u32 = 45;
const HEIGHT: u32 = 31;

/// RGBA floats: edges, a ramp and grain.
fn picture() -> Vec<f32> {
    let pixel = |x: u32, y: u32| {
        let edge = if x * 2 + y < 50 { 0.2 } else { 0.7 };
        let grain = (x * 7919 + y * 104_729) % 97;
        [edge, x as f32 / WIDTH as f32, grain as f32 / 97.0, 1.0]
    };
    (0..HEIGHT).flat_map(|y| (0..WIDTH).flat_map(move |x| pixel(x, y))).collect()
}

fn image(data: *const c_void, sample: IsophoteSample, channels: u32, stride: isize) -> IsophoteImage {
    IsophoteImage { data, row_stride: stride, sample, channels, width: WIDTH, height: HEIGHT, x: 0, y: 0 }
}

fn floats(data: &[f32]) -> IsophoteImage {
    image(data.as_ptr().cast(), ISOPHOTE_SAMPLE_F32, 4, WIDTH as isize * 16)
}

fn target(image: IsophoteImage) -> IsophoteTarget {
    let IsophoteImage { data, row_stride, sample, channels, width, height, x, y } = image;
    IsophoteTarget { data: data.cast_mut(), row_stride, sample, channels, width, height, x, y }
}

/// A graph of one node, and how it is run.
struct Run<'a> {
    api: &'a IsophoteApi,
    graph: IsophoteGraph,
    device: IsophoteDevice,
    request: IsophoteRequest,
    region: Option<IsophoteRect>,
    control: Option<IsophoteControl>,
}

impl<'a> Run<'a> {
    fn new(library: &'a Loaded, node: &str) -> Self {
        let api = library.api;
        let mut graph = 0;
        let mut request = IsophoteRequest { width: 0, height: 0, scale: 0.0, space: 0, alpha: 0, guides: 0 };
        let id = CString::new(node).unwrap();
        // SAFETY: the text ends with a zero, the places are writable.
        unsafe {
            assert_eq!((api.graph_create_single)(id.as_ptr(), null_mut(), &raw mut graph), ISOPHOTE_OK);
            assert_eq!((api.request_init)(WIDTH, HEIGHT, &raw mut request), ISOPHOTE_OK);
        }
        Self { api, graph, device: 0, request, region: None, control: None }
    }

    /// Status, message and report of a run.
    fn run(
        &self,
        inputs: &[IsophoteInput],
        target: &IsophoteTarget,
    ) -> (IsophoteStatus, String, IsophoteReport) {
        let mut report = IsophoteReport::default();
        // SAFETY: the pointers lead to what the table asks for, or to null where they may.
        let status = unsafe {
            (self.api.process)(
                self.graph,
                self.device,
                &raw const self.request,
                inputs.as_ptr(),
                inputs.len() as u32,
                self.region.as_ref().map_or(null(), |r| &raw const *r),
                &raw const *target,
                self.control.as_ref().map_or(null(), |c| &raw const *c),
                &raw mut report,
            )
        };
        // SAFETY: the text is writable.
        let said = text(|t| unsafe { assert_eq!((self.api.graph_error)(self.graph, t), ISOPHOTE_OK) });
        (status, said, report)
    }

    /// The result as RGBA floats.
    fn result(&self, inputs: &[IsophoteInput]) -> Vec<f32> {
        let out = vec![-7.0_f32; (WIDTH * HEIGHT * 4) as usize];
        let (status, said, _) = self.run(inputs, &target(floats(&out)));
        assert_eq!(status, ISOPHOTE_OK, "{said}");
        out
    }
}

fn color(image: IsophoteImage) -> [IsophoteInput; 1] {
    [IsophoteInput { name: c"color".as_ptr(), image }]
}

#[test]
fn every_format_goes_in_and_out() {
    let library = Loaded::new();
    let run = Run::new(&library, "gaussian");
    let data = picture();
    let expected = run.result(&color(floats(&data)));
    for (sample, size, step) in [
        (ISOPHOTE_SAMPLE_U8, 1, 1.0 / 255.0),
        (ISOPHOTE_SAMPLE_U16, 2, 1.0 / 65535.0),
        (ISOPHOTE_SAMPLE_F16, 2, 1.0 / 1024.0),
        (ISOPHOTE_SAMPLE_F32, 4, 0.0),
    ] {
        for channels in [1, 3, 4] {
            let row = WIDTH as usize * channels * size;
            // Rows apart by an odd number of bytes, the first at an odd address: nothing is aligned.
            let stride = row + 3;
            let mut bytes = vec![0xab_u8; stride * HEIGHT as usize + 1];
            let out = image(bytes[1..].as_mut_ptr().cast(), sample, channels as u32, stride as isize);
            let (status, said, _) = run.run(&color(floats(&data)), &target(out));
            assert_eq!(status, ISOPHOTE_OK, "{said}");
            // Into the same format and back to floats.
            let copy = Run::new(&library, "gaussian");
            // SAFETY: the text ends with a zero.
            unsafe {
                (copy.api.graph_set_float)(copy.graph, 0, c"mix".as_ptr(), 0.0);
            }
            let back = copy.result(&color(out));
            for (found, wanted) in back.chunks_exact(4).zip(expected.chunks_exact(4)) {
                let grey = [wanted[0]; 3];
                let wanted = if channels == 1 { &grey[..] } else { &wanted[..3] };
                for (a, b) in found.iter().zip(wanted) {
                    assert!((a - b).abs() <= step * 0.51 + 3e-6, "{sample}x{channels}: {a} for {b}");
                }
            }
            // Between the rows nothing was written.
            for y in 0..HEIGHT as usize {
                assert!(bytes[1 + y * stride + row..].iter().take(3).all(|b| *b == 0xab));
            }
        }
    }
}

#[test]
fn rows_may_run_upwards_and_buffers_overlap() {
    let library = Loaded::new();
    let run = Run::new(&library, "gaussian");
    let data = picture();
    let expected = run.result(&color(floats(&data)));
    let row = WIDTH as usize * 4;

    let flipped: Vec<f32> = data.chunks_exact(row).rev().flatten().copied().collect();
    let top = flipped[row * (HEIGHT as usize - 1)..].as_ptr();
    let upwards = image(top.cast(), ISOPHOTE_SAMPLE_F32, 4, -(row as isize) * 4);
    assert_eq!(run.result(&color(upwards)), expected);

    let mut out = vec![0.0_f32; data.len()];
    let top = out[row * (HEIGHT as usize - 1)..].as_mut_ptr();
    let up = image(top.cast(), ISOPHOTE_SAMPLE_F32, 4, -(row as isize) * 4);
    let (status, said, _) = run.run(&color(floats(&data)), &target(up));
    assert_eq!(status, ISOPHOTE_OK, "{said}");
    assert_eq!(out.chunks_exact(row).rev().flatten().copied().collect::<Vec<_>>(), expected);

    // In place, and one row lower in the same memory.
    let mut memory = data.clone();
    memory.resize(data.len() + row, -1.0);
    let input = floats(&memory);
    let lower = floats(&memory[row..]);
    let (status, said, _) = run.run(&color(input), &target(lower));
    assert_eq!(status, ISOPHOTE_OK, "{said}");
    assert_eq!(memory[..row], data[..row]);
    assert_eq!(memory[row..], expected);
    memory[..data.len()].copy_from_slice(&data);
    let both = floats(&memory);
    assert_eq!(run.run(&color(both), &target(both)).0, ISOPHOTE_OK);
    assert_eq!(memory[..data.len()], expected);
}

#[test]
fn a_region_is_the_same_part_of_the_whole_and_leaves_the_rest() {
    let library = Loaded::new();
    let mut run = Run::new(&library, "gaussian");
    let data = picture();
    let expected = run.result(&color(floats(&data)));
    let region = IsophoteRect { x0: 13, y0: 9, x1: 22, y1: 16 };
    run.region = Some(region);
    let mut support = IsophoteSupport::default();
    // SAFETY: the pointers lead to what the table asks for.
    let status = unsafe {
        (run.api.graph_support)(
            run.graph,
            &raw const run.request,
            &raw const region,
            c"color".as_ptr(),
            &raw mut support,
        )
    };
    assert_eq!((status, support.global), (ISOPHOTE_OK, 0));
    let w = support.window;
    assert!(support.halo > 0 && w.x0 < region.x0 && w.x0 > 0, "{support:?}");

    // Only what is said to be needed is given.
    let at = |x: i32, y: i32| (y as usize * WIDTH as usize + x as usize) * 4;
    let part = IsophoteImage {
        data: data[at(w.x0, w.y0)..].as_ptr().cast(),
        width: (w.x1 - w.x0) as u32,
        height: (w.y1 - w.y0) as u32,
        x: w.x0,
        y: w.y0,
        ..floats(&data)
    };
    let tile = run.result(&color(part));
    for y in 0..HEIGHT as i32 {
        for x in 0..WIDTH as i32 {
            let inside = x >= region.x0 && x < region.x1 && y >= region.y0 && y < region.y1;
            let (found, i) = (&tile[at(x, y)..at(x, y) + 4], at(x, y));
            assert_eq!(found, if inside { &expected[i..i + 4] } else { &[-7.0; 4] }, "({x}, {y})");
        }
    }
    // One column less is too little, and is said.
    let narrow = IsophoteImage { width: part.width - 1, ..part };
    let out = vec![-7.0_f32; data.len()];
    let (status, said, _) = run.run(&color(narrow), &target(floats(&out)));
    assert_eq!(status, ISOPHOTE_GEOMETRY);
    assert!(
        said.contains(&format!("{}x{} pixels at ({}, {}) is needed", part.width, part.height, w.x0, w.y0))
    );
    // A target that does not hold the region is refused.
    let (status, said, _) = run.run(&color(part), &target(IsophoteImage { x: 14, ..floats(&out) }));
    assert_eq!(status, ISOPHOTE_GEOMETRY, "{said}");
    assert!(out.iter().all(|v| *v == -7.0));
}

#[test]
fn impossible_images_are_refused_and_nothing_is_written() {
    let library = Loaded::new();
    let run = Run::new(&library, "gaussian");
    let data = picture();
    let good = floats(&data);
    let row = WIDTH as isize * 16;
    let bad = [
        (IsophoteImage { data: null(), ..good }, ISOPHOTE_INVALID_ARGUMENT),
        (IsophoteImage { sample: 4, ..good }, ISOPHOTE_INVALID_ARGUMENT),
        (IsophoteImage { sample: u32::MAX, ..good }, ISOPHOTE_INVALID_ARGUMENT),
        (IsophoteImage { channels: 0, ..good }, ISOPHOTE_INVALID_ARGUMENT),
        (IsophoteImage { channels: 2, ..good }, ISOPHOTE_INVALID_ARGUMENT),
        (IsophoteImage { channels: u32::MAX, ..good }, ISOPHOTE_INVALID_ARGUMENT),
        (IsophoteImage { width: 0, ..good }, ISOPHOTE_GEOMETRY),
        (IsophoteImage { height: 0, ..good }, ISOPHOTE_GEOMETRY),
        (IsophoteImage { width: u32::MAX, ..good }, ISOPHOTE_GEOMETRY),
        (IsophoteImage { height: u32::MAX, ..good }, ISOPHOTE_GEOMETRY),
        (IsophoteImage { row_stride: 0, ..good }, ISOPHOTE_GEOMETRY),
        (IsophoteImage { row_stride: row - 1, ..good }, ISOPHOTE_GEOMETRY),
        (IsophoteImage { row_stride: 1 - row, ..good }, ISOPHOTE_GEOMETRY),
        (IsophoteImage { row_stride: isize::MAX, ..good }, ISOPHOTE_GEOMETRY),
        (IsophoteImage { row_stride: isize::MIN, ..good }, ISOPHOTE_GEOMETRY),
        (IsophoteImage { x: i32::MAX, ..good }, ISOPHOTE_GEOMETRY),
        (IsophoteImage { y: i32::MAX - 3, ..good }, ISOPHOTE_GEOMETRY),
        (IsophoteImage { x: 1, ..good }, ISOPHOTE_GEOMETRY),
        (IsophoteImage { y: -1, ..good }, ISOPHOTE_GEOMETRY),
        (IsophoteImage { x: i32::MIN, y: i32::MIN, ..good }, ISOPHOTE_GEOMETRY),
    ];
    let out = vec![-7.0_f32; data.len()];
    for (image, expected) in bad {
        let (status, said, _) = run.run(&color(image), &target(floats(&out)));
        assert_eq!(status, expected, "{image:?}: {said}");
        assert!(said.contains("input image 'color'") && said.lines().count() == 1, "{said}");
        // The same for a target, whose memory is never touched.
        let as_target = IsophoteTarget {
            data: if image.data.is_null() { null_mut() } else { target(floats(&out)).data },
            ..target(image)
        };
        let (status, said, _) = run.run(&color(good), &as_target);
        assert_eq!(status, expected, "{as_target:?}: {said}");
        assert!(said.contains("the target image"), "{said}");
    }
    let missing = run.run(&[], &target(floats(&out)));
    assert_eq!(missing.0, ISOPHOTE_INPUT);
    assert!(missing.1.contains("'color' is missing; 45x31 pixels"), "{}", missing.1);
    let named = |name: &'static std::ffi::CStr| IsophoteInput { name: name.as_ptr(), image: good };
    assert_eq!(run.run(&[named(c"colour")], &target(floats(&out))).0, ISOPHOTE_UNKNOWN);
    let twice = run.run(&[named(c"color"), named(c"color")], &target(floats(&out)));
    assert_eq!(twice.0, ISOPHOTE_INVALID_ARGUMENT);
    let nameless = IsophoteInput { name: null(), image: good };
    assert_eq!(run.run(&[nameless], &target(floats(&out))).0, ISOPHOTE_INVALID_ARGUMENT);
    assert!(out.iter().all(|v| *v == -7.0));
    // Unread guides are ignored, bad ones are not.
    run.result(&[named(c"color"), named(c"depth"), named(c"normal"), named(c"object_id")]);
    let tensor = Run::new(&library, "structure_tensor");
    let bytes = [0_u8; (WIDTH * HEIGHT * 3) as usize];
    let normal = image(bytes.as_ptr().cast(), ISOPHOTE_SAMPLE_U8, 3, WIDTH as isize * 3);
    let inputs = [named(c"color"), IsophoteInput { name: c"normal".as_ptr(), image: normal }];
    let (status, said, _) = tensor.run(&inputs, &target(floats(&out)));
    assert_eq!(status, ISOPHOTE_INPUT);
    assert!(said.contains("f16 or f32"), "{said}");
}

#[test]
fn more_memory_than_there_is_is_a_status() {
    if std::fs::read_to_string("/proc/sys/vm/overcommit_memory").is_ok_and(|v| v.trim() == "1") {
        eprintln!("\n*** SKIPPED: this machine promises any amount of memory ***\n");
        return;
    }
    let library = Loaded::new();
    let mut run = Run::new(&library, "gaussian");
    (run.request.width, run.request.height) = (65536, 65536);
    let data = picture();
    // The sizes fit together; that so much memory is not there must be noticed before it is read.
    let huge = IsophoteImage { width: 65536, height: 65536, row_stride: 65536 * 16, ..floats(&data) };
    let (status, said, _) = run.run(&color(huge), &target(huge));
    assert_eq!(status, ISOPHOTE_OUT_OF_MEMORY, "{said}");
    assert!(said.contains("MiB"), "{said}");
}

#[test]
fn bad_pixels_are_mended_and_counted() {
    let library = Loaded::new();
    let run = Run::new(&library, "gaussian");
    let mut data = picture();
    data[400] = f32::NAN;
    data[801] = f32::INFINITY;
    data[1202] = f32::NEG_INFINITY;
    let out = vec![0.0_f32; data.len()];
    let (status, said, report) = run.run(&color(floats(&data)), &target(floats(&out)));
    assert_eq!((status, report.mended), (ISOPHOTE_OK, 3), "{said}");
    assert!(report.seconds > 0.0);
    assert!(out.iter().all(|v| v.is_finite()));
}

/// What the callbacks below see.
#[derive(Default)]
struct Watch {
    asked: AtomicU32,
    stop_after: u32,
    told: Mutex<Vec<f32>>,
    batches: AtomicU32,
}

unsafe extern "C" fn ask(user: *mut c_void) -> u32 {
    // SAFETY: every test hands a `Watch` over that outlives the call.
    let watch = unsafe { &*user.cast::<Watch>() };
    u32::from(watch.asked.fetch_add(1, Ordering::Relaxed) >= watch.stop_after)
}

unsafe extern "C" fn tell(user: *mut c_void, done: f32) {
    // SAFETY: as above.
    unsafe { &*user.cast::<Watch>() }.told.lock().unwrap().push(done);
}

/// The jobs in reverse on threads of the test's own.
unsafe extern "C" fn on_our_threads(user: *mut c_void, jobs: u32, job: IsophoteJob, batch: u64) {
    // SAFETY: as above.
    unsafe { &*user.cast::<Watch>() }.batches.fetch_add(1, Ordering::Relaxed);
    let job = job.unwrap();
    std::thread::scope(|scope| {
        for first in 0..3 {
            scope.spawn(move || {
                for index in (first..jobs).step_by(3).collect::<Vec<_>>().into_iter().rev() {
                    // SAFETY: a job may be called on any thread while its batch is run.
                    unsafe { job(batch, index) };
                }
            });
        }
    });
}

fn control(watch: &Watch) -> IsophoteControl {
    let user = (&raw const *watch).cast_mut().cast();
    IsophoteControl {
        user,
        run: None,
        progress: Some(tell),
        cancelled: Some(ask),
        measured: None,
        threads: 0,
    }
}

#[test]
fn a_run_reports_progress_and_stops_when_told() {
    let library = Loaded::new();
    let mut run = Run::new(&library, "gaussian");
    let data = picture();
    let expected = run.result(&color(floats(&data)));
    let patient = Watch { stop_after: u32::MAX, ..Watch::default() };
    run.control = Some(control(&patient));
    assert_eq!(run.result(&color(floats(&data))), expected);
    let told = patient.told.lock().unwrap();
    assert!(told.is_sorted() && told.last() == Some(&1.0), "{told:?}");
    // Stopped at any question at all, the target is as it was.
    for stop_after in 0..patient.asked.load(Ordering::Relaxed) {
        let watch = Watch { stop_after, ..Watch::default() };
        run.control = Some(IsophoteControl { threads: 1, ..control(&watch) });
        let out = vec![-7.0_f32; data.len()];
        let (status, said, _) = run.run(&color(floats(&data)), &target(floats(&out)));
        if status == ISOPHOTE_CANCELLED {
            assert_eq!(said, "cancelled");
            assert!(out.iter().all(|v| *v == -7.0), "stopped at question {stop_after}");
        } else {
            // One thread may ask less often than several.
            assert!(watch.asked.load(Ordering::Relaxed) <= stop_after);
        }
    }
    run.control = None;
    assert_eq!(run.result(&color(floats(&data))), expected);
}

#[test]
fn the_number_and_the_owner_of_threads_change_nothing() {
    let library = Loaded::new();
    let mut run = Run::new(&library, "gaussian");
    let data = picture();
    let expected = run.result(&color(floats(&data)));
    let watch = Watch { stop_after: u32::MAX, ..Watch::default() };
    for threads in [0, 1, 2, 3, 7] {
        run.control = Some(IsophoteControl { threads, ..control(&watch) });
        assert_eq!(run.result(&color(floats(&data))), expected, "{threads} threads");
        run.control = Some(IsophoteControl { threads, run: Some(on_our_threads), ..control(&watch) });
        assert_eq!(run.result(&color(floats(&data))), expected, "{threads} of our threads");
    }
    assert!(watch.batches.load(Ordering::Relaxed) > 0);
    run.control = Some(IsophoteControl { threads: 1025, ..control(&watch) });
    let out = vec![-7.0_f32; data.len()];
    let (status, said, _) = run.run(&color(floats(&data)), &target(floats(&out)));
    assert_eq!(status, ISOPHOTE_OUT_OF_RANGE, "{said}");
}

#[test]
fn several_threads_use_several_graphs_and_one() {
    let library = Loaded::new();
    let data = picture();
    let shared = Run::new(&library, "gaussian");
    let (shared_graph, expected) = (shared.graph, shared.result(&color(floats(&data))));
    std::thread::scope(|scope| {
        for index in 0..4 {
            let (library, data, expected) = (&library, &data, &expected);
            scope.spawn(move || {
                for round in 0..12 {
                    let mut own = Run::new(library, "gaussian");
                    let handle = own.graph;
                    assert_eq!(own.result(&color(floats(data))), *expected);
                    // Breaking the rule of one thread per object must not break anything else.
                    own.graph = shared_graph;
                    assert_eq!(own.result(&color(floats(data))), *expected);
                    // SAFETY: these take any handle.
                    unsafe {
                        assert_eq!((own.api.graph_destroy)(handle), ISOPHOTE_OK);
                        if index == 0 && round % 4 == 0 {
                            (own.api.trim)();
                        }
                    }
                }
            });
        }
    });
}

/// Destroys the graph that is being run.
unsafe extern "C" fn destroy(user: *mut c_void, _: f32) {
    // SAFETY: the test hands the table and the handle over.
    let (api, graph) = unsafe { *user.cast::<(&IsophoteApi, IsophoteGraph)>() };
    // SAFETY: it takes any handle.
    unsafe { (api.graph_destroy)(graph) };
}

#[test]
fn a_graph_may_be_destroyed_while_it_runs() {
    let library = Loaded::new();
    let mut run = Run::new(&library, "gaussian");
    let data = picture();
    let expected = run.result(&color(floats(&data)));
    let mut pair = (run.api, run.graph);
    let user = (&raw mut pair).cast();
    run.control = Some(IsophoteControl {
        user,
        run: None,
        progress: Some(destroy),
        cancelled: None,
        measured: None,
        threads: 0,
    });
    let out = vec![-7.0_f32; data.len()];
    let whole = target(floats(&out));
    // SAFETY: the pointers lead to what the table asks for.
    let status = unsafe {
        (run.api.process)(
            run.graph,
            0,
            &raw const run.request,
            color(floats(&data)).as_ptr(),
            1,
            null(),
            &raw const whole,
            &raw const *run.control.as_ref().unwrap(),
            null_mut(),
        )
    };
    assert_eq!((status, out), (ISOPHOTE_OK, expected));
    // SAFETY: it takes any handle.
    assert_eq!(unsafe { (run.api.graph_destroy)(run.graph) }, ISOPHOTE_INVALID_HANDLE);
}

#[test]
fn the_library_can_be_unloaded_and_loaded_again() {
    let data = picture();
    let mut expected = None;
    for _ in 0..5 {
        let library = Loaded::new();
        let run = Run::new(&library, "gaussian");
        let result = run.result(&color(floats(&data)));
        assert_eq!(*expected.get_or_insert_with(|| result.clone()), result);
        // Worker threads are alive, a graph is left behind, and the library goes.
        drop(library);
    }
}

#[test]
fn a_device_of_the_librarys_own_gives_the_same_picture() {
    let library = Loaded::new();
    let mut run = Run::new(&library, "gaussian");
    let data = picture();
    let expected = run.result(&color(floats(&data)));
    let mut status = 0;
    // SAFETY: the texts end with zeros, the places are writable.
    unsafe {
        let said = text(|t| {
            status = (run.api.device_create)(c"no such adapter".as_ptr(), t, &raw mut run.device);
        });
        assert_eq!((status, run.device), (ISOPHOTE_NO_DEVICE, 0));
        assert!(said.contains("adapter") && said.lines().count() == 1, "{said}");
        let said = text(|t| status = (run.api.device_create)(null(), t, &raw mut run.device));
        if status == ISOPHOTE_NO_DEVICE && std::env::var("CI").is_err() {
            eprintln!("\n*** SKIPPED: no graphics device: {said} ***\n");
            return;
        }
        assert_eq!(status, ISOPHOTE_OK, "{said}");
        let mut software = 9;
        let name = text(|t| {
            assert_eq!((run.api.device_name)(run.device, t, &raw mut software), ISOPHOTE_OK);
        });
        assert!(!name.is_empty() && software <= 1);
    }
    for _ in 0..2 {
        let result = run.result(&color(floats(&data)));
        let worst = result.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 1e-4, "the device differs by {worst}");
    }
    // SAFETY: these take any handle.
    unsafe {
        assert_eq!((run.api.device_destroy)(run.device), ISOPHOTE_OK);
        assert_eq!((run.api.device_destroy)(run.device), ISOPHOTE_INVALID_HANDLE);
    }
    let out = vec![-7.0_f32; data.len()];
    let (status, said, _) = run.run(&color(floats(&data)), &target(floats(&out)));
    assert_eq!(status, ISOPHOTE_INVALID_HANDLE);
    assert!(said.contains("device"), "{said}");
    run.device = 0;
    assert_eq!(run.result(&color(floats(&data))), expected);
}
