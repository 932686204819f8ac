//! Runs through the C table: progress, cancelling, threads, objects destroyed meanwhile, devices.

#![allow(unsafe_code, reason = "calls through the C table")]

use crate::c_images::{Run, color, floats, picture, target};
use isophote_abi::*;
use isophote_tests::library::{Loaded, text};
use std::ffi::c_void;
use std::ptr::{null, null_mut};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};

/// State that the callbacks below see.
#[derive(Default)]
struct Watch {
    calls: AtomicU32,
    stop_after: u32,
    reported: Mutex<Vec<f32>>,
    batches: AtomicU32,
}

unsafe extern "C" fn ask(user: *mut c_void) -> u32 {
    // SAFETY: every test hands a `Watch` over that outlives the call.
    let watch = unsafe { &*user.cast::<Watch>() };
    u32::from(watch.calls.fetch_add(1, Ordering::Relaxed) >= watch.stop_after)
}

unsafe extern "C" fn tell(user: *mut c_void, done: f32) {
    // SAFETY: as above.
    unsafe { &*user.cast::<Watch>() }.reported.lock().unwrap().push(done);
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
fn a_run_reports_progress_and_stops_when_asked() {
    let library = Loaded::new();
    let mut run = Run::new(&library, "gaussian");
    let (data, expected) = run.pictures();
    let patient = Watch { stop_after: u32::MAX, ..Watch::default() };
    run.control = Some(control(&patient));
    assert_eq!(run.result(&color(floats(&data))), expected);
    let reported = patient.reported.lock().unwrap();
    assert!(reported.is_sorted() && reported.last() == Some(&1.0), "{reported:?}");
    // Stopped at any question at all, the target is as it was.
    for stop_after in 0..patient.calls.load(Ordering::Relaxed) {
        let watch = Watch { stop_after, ..Watch::default() };
        run.control = Some(IsophoteControl { threads: 1, ..control(&watch) });
        let out = vec![-7.0_f32; data.len()];
        let (status, said, _) = run.run(&color(floats(&data)), &target(floats(&out)));
        if status == ISOPHOTE_ERROR_CANCELLED {
            assert_eq!(said, "cancelled");
            assert!(out.iter().all(|v| *v == -7.0), "stopped at question {stop_after}");
        } else {
            // One thread may ask less often than several.
            assert!(watch.calls.load(Ordering::Relaxed) <= stop_after);
        }
    }
    run.control = None;
    assert_eq!(run.result(&color(floats(&data))), expected);
}

#[test]
fn the_number_and_the_owner_of_threads_change_nothing() {
    let library = Loaded::new();
    let mut run = Run::new(&library, "gaussian");
    let (data, expected) = run.pictures();
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
    assert_eq!(status, ISOPHOTE_ERROR_OUT_OF_RANGE, "{said}");
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
    let (data, expected) = run.pictures();
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
            IsophoteDevice::default(),
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
    assert_eq!(unsafe { (run.api.graph_destroy)(run.graph) }, ISOPHOTE_ERROR_INVALID_HANDLE);
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
    let (data, expected) = run.pictures();
    let mut status = 0;
    // SAFETY: the texts end with zeros, the places are writable.
    unsafe {
        let said = text(|t| {
            status = (run.api.device_create)(c"no such adapter".as_ptr(), t, &raw mut run.device);
        });
        assert_eq!((status, run.device.id), (ISOPHOTE_ERROR_NO_DEVICE, 0));
        assert!(said.contains("adapter") && said.lines().count() == 1, "{said}");
        let said = text(|t| status = (run.api.device_create)(null(), t, &raw mut run.device));
        if status == ISOPHOTE_ERROR_NO_DEVICE && std::env::var("CI").is_err() {
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
        assert_eq!((run.api.device_destroy)(run.device), ISOPHOTE_ERROR_INVALID_HANDLE);
    }
    let out = vec![-7.0_f32; data.len()];
    let (status, said, _) = run.run(&color(floats(&data)), &target(floats(&out)));
    assert_eq!(status, ISOPHOTE_ERROR_INVALID_HANDLE);
    assert!(said.contains("device"), "{said}");
    run.device = IsophoteDevice::default();
    assert_eq!(run.result(&color(floats(&data))), expected);
}
