//! Memory that runs out: every call answers with a status, whatever it is that is refused, and works again when
//! there is memory.

#![cfg(target_os = "linux")]
#![allow(unsafe_code, reason = "limiting the process, and calls through the C table")]

use isophote_abi::openfx::*;
use isophote_abi::*;
use isophote_tests::library::{self, Loaded, text};
use isophote_tests::ofx::effect::{Described, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;
use std::ffi::CStr;
use std::process::Command;
use std::ptr::{null, null_mut};

/// Names the test that this process is for.
const TEST: &str = "ISOPHOTE_MEMORY_TEST";
/// Pixels along a side of the pictures.
const SIDE: usize = 512;
/// Limits that are tried: this many, so many bytes apart.
const LIMITS: u64 = 32;
const STEP: u64 = 1_300_000;

/// Runs `test` in a process of its own, whose memory it may limit.
fn in_a_process(name: &str, test: impl FnOnce()) {
    if std::env::var(TEST).is_ok_and(|wanted| wanted == name) {
        return test();
    }
    let mut command = Command::new(std::env::current_exe().unwrap());
    command
        .args(["--exact", &format!("memory::{name}"), "--nocapture"])
        .env(TEST, name)
        .env("ISOPHOTE_LIBRARY", library::path());
    // Otherwise the GNU C library keeps addresses for each thread, and gives them when the system does not.
    command.env("MALLOC_ARENA_MAX", "1");
    let run = command.output().unwrap();
    let printed = [run.stdout, run.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    print!("{printed}");
    assert!(run.status.success(), "{}\n{printed}", run.status);
}

/// Lets `call` take so many bytes of addresses beyond those that the process has.
fn within<T>(more: u64, call: impl FnOnce() -> T) -> T {
    const ADDRESSES: i32 = 9;
    unsafe extern "C" {
        fn getrlimit(resource: i32, limits: *mut [u64; 2]) -> i32;
        fn setrlimit(resource: i32, limits: *const [u64; 2]) -> i32;
    }
    // The caller's side of the call needs some as well. The last block keeps what is freed from the system.
    let mut blocks: Vec<Vec<u8>> = (0..512).map(|_| vec![1; 4096]).collect();
    let last = blocks.pop();
    drop(blocks);
    let mut before = [0; 2];
    // SAFETY: two numbers, as the system writes them.
    assert_eq!(unsafe { getrlimit(ADDRESSES, &raw mut before) }, 0);
    let pages = std::fs::read_to_string("/proc/self/statm").unwrap();
    let now = pages.split_whitespace().next().unwrap().parse::<u64>().unwrap() * 4096;
    let limits = [now + more, before[1]];
    // SAFETY: two numbers, as the system reads them.
    assert_eq!(unsafe { setrlimit(ADDRESSES, &raw const limits) }, 0);
    let result = call();
    // SAFETY: as before.
    assert_eq!(unsafe { setrlimit(ADDRESSES, &raw const before) }, 0);
    drop(last);
    result
}

/// Calls with more and more memory, and then without a limit.
fn statuses<T: Copy + PartialEq + std::fmt::Debug>(ok: T, refused: T, mut call: impl FnMut() -> T) {
    let found: Vec<T> = (0..LIMITS).map(|step| within(step * STEP, &mut call)).collect();
    println!("{found:?}");
    assert!(found.iter().all(|status| [ok, refused].contains(status)), "{found:?}");
    assert_eq!(found[0], refused, "no memory was needed");
    assert_eq!(call(), ok);
}

/// Calls three times with as little memory as one call needs: what is enough once is enough again, whatever is kept
/// from call to call.
fn repeated<T: Copy + PartialEq + std::fmt::Debug>(ok: T, mut call: impl FnMut() -> T) {
    let calls = (0..LIMITS).map(|step| within(step * STEP, || [call(), call(), call()]));
    let enough: Vec<[T; 3]> = calls.filter(|[first, ..]| *first == ok).take(1).collect();
    assert_eq!(enough, [[ok; 3]]);
}

/// Tries calls of `process` for a node on so many threads, 0 for one per core.
fn node_on_threads(
    name: &str,
    node: &CStr,
    threads: u32,
    test: impl FnOnce(&mut dyn FnMut() -> IsophoteStatus),
) {
    in_a_process(name, || {
        let library = Loaded::new();
        let api = library.api;
        let mut graph = IsophoteGraph::default();
        // SAFETY: the pointers lead to what the table asks for.
        let made = unsafe { (api.graph_create_single)(node.as_ptr(), null_mut(), &raw mut graph) };
        assert_eq!(made, ISOPHOTE_OK);
        test(&mut || process(api, graph, threads));
        // SAFETY: the handle was made above.
        unsafe { (api.graph_destroy)(graph) };
    });
}

fn node_answers(name: &str, node: &CStr, threads: u32) {
    node_on_threads(name, node, threads, |call| statuses(ISOPHOTE_OK, ISOPHOTE_ERROR_OUT_OF_MEMORY, call));
}

#[test]
fn process_answers_with_a_status() {
    node_answers("process_answers_with_a_status", c"cartoon", 0);
}

#[test]
fn process_on_more_threads_answers_with_a_status() {
    node_answers("process_on_more_threads_answers_with_a_status", c"generalized_kuwahara", 24);
}

#[test]
fn process_on_the_calling_thread_answers_with_a_status() {
    node_answers("process_on_the_calling_thread_answers_with_a_status", c"coherence_enhancing", 1);
}

#[test]
fn memory_that_was_enough_is_enough_again() {
    node_on_threads("memory_that_was_enough_is_enough_again", c"coherence_enhancing", 1, |call| {
        repeated(ISOPHOTE_OK, call)
    });
}

fn process(api: &IsophoteApi, graph: IsophoteGraph, threads: u32) -> IsophoteStatus {
    static mut PIXELS: [u8; SIDE * SIDE * 3] = [100; SIDE * SIDE * 3];
    let data = (&raw mut PIXELS).cast();
    let (width, height) = (SIDE as u32, SIDE as u32);
    let image = IsophoteImage {
        data,
        row_stride: (SIDE * 3) as isize,
        sample: ISOPHOTE_SAMPLE_U8,
        channels: 3,
        width,
        height,
        x: 0,
        y: 0,
    };
    let target = IsophoteTarget {
        data: data.cast(),
        row_stride: image.row_stride,
        sample: image.sample,
        channels: 3,
        width,
        height,
        x: 0,
        y: 0,
    };
    let input = IsophoteInput { name: c"color".as_ptr(), image };
    let control = IsophoteControl {
        user: null_mut(),
        run: None,
        progress: None,
        cancelled: None,
        measured: None,
        threads,
    };
    // SAFETY: the pointers lead to what the table asks for, which writes the request; the pixels are used by this
    // call alone.
    unsafe {
        let mut request: IsophoteRequest = std::mem::zeroed();
        assert_eq!((api.request_init)(width, height, &raw mut request), ISOPHOTE_OK);
        let status = (api.process)(
            graph,
            std::mem::zeroed(),
            &raw const request,
            &raw const input,
            1,
            null(),
            &raw const target,
            &raw const control,
            null_mut(),
        );
        if status != ISOPHOTE_OK {
            let why = text(|t| assert_eq!((api.graph_error)(graph, t), ISOPHOTE_OK));
            assert!(why.contains("memory") || why.contains("MiB"), "{why}");
        }
        status
    }
}

#[test]
fn an_effect_answers_with_a_status() {
    in_a_process("an_effect_answers_with_a_status", || {
        let binary = Binary::open(library::path());
        let host = Host::new(Behaviour::default());
        let layout = Layout::default();
        let effect = binary.plugin("org.isophote.cartoon");
        let instance = Described::new(&host, effect).instance(kOfxImageEffectContextFilter);
        let pixels = std::iter::repeat_n([0.5_f32, 0.25, 0.75, 1.0], SIDE * SIDE).flatten();
        let source: Vec<u8> = pixels.flat_map(f32::to_ne_bytes).collect();
        let side = SIDE as i32;
        instance.connect("Source", Picture::packed_in(layout, side, side, &source));
        instance.connect("Output", Picture::new(layout, side, side));
        let wanted = Wanted::new([0, 0, side, side]);
        statuses(kOfxStatOK, kOfxStatErrMemory, || instance.render_connected(&wanted));
    });
}
