//! Sequences through the C table: frames in any order, what hosts lack, what they get wrong.

#![allow(unsafe_code, reason = "calls through the C table")]

use isophote_abi::*;
use isophote_tests::library::{Loaded, text};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::{null, null_mut};

const SIZE: [usize; 2] = [41, 29];
/// Pixels that everything moves to the right from frame to frame.
const STEP: i64 = 2;

/// Frames that a host shows, and those that it was asked for.
struct Film {
    first: i64,
    last: i64,
    /// Frame whose motion is not there, and what its motion is instead.
    without_motion: Option<i64>,
    motion: [f32; 2],
    motion_width: u32,
    requests: RefCell<Vec<(String, i64)>>,
    images: RefCell<Vec<Vec<f32>>>,
    released: RefCell<usize>,
}

impl Film {
    fn new() -> Self {
        Self {
            first: 1,
            last: 8,
            without_motion: None,
            motion: [-STEP as f32, 0.0],
            motion_width: SIZE[0] as u32,
            requests: RefCell::default(),
            images: RefCell::default(),
            released: RefCell::default(),
        }
    }

    fn color(frame: i64) -> Vec<f32> {
        let at = |x: i64, y: i64| {
            let x = x - STEP * frame;
            let grain = (x * 7919 + y * 104_729 + frame * 31).rem_euclid(13) as f32 / 130.0;
            let disc = (x - 9).pow(2) + (y - 14).pow(2) < 50;
            [0.3 + 0.2 * (0.4 * x as f32).sin(), if disc { 0.9 } else { 0.4 }, 0.2 + grain, 1.0]
        };
        let [w, h] = SIZE.map(|n| n as i64);
        (0..h).flat_map(|y| (0..w).flat_map(move |x| at(x, y))).collect()
    }

    fn count(&self, input: &str) -> usize {
        self.requests.borrow().iter().filter(|(name, _)| name == input).count()
    }
}

unsafe extern "C" fn input(
    user: *mut c_void,
    name: *const c_char,
    frame: i64,
    image: *mut IsophoteImage,
) -> i32 {
    // SAFETY: the tests hand a film over that outlives the call; the name ends with a zero, and the image may be written.
    let (film, name) = unsafe { (&*user.cast::<Film>(), CStr::from_ptr(name).to_str().unwrap()) };
    film.requests.borrow_mut().push((name.into(), frame));
    if !(film.first..=film.last).contains(&frame) {
        return 0;
    }
    let (data, channels, width) = match name {
        "color" => (Film::color(frame), 4, SIZE[0] as u32),
        "motion" if film.without_motion != Some(frame) => {
            let count = film.motion_width as usize * SIZE[1];
            (std::iter::repeat_n(film.motion, count).flatten().collect::<Vec<f32>>(), 2, film.motion_width)
        }
        "motion_forward" => {
            let step = [STEP as f32, 0.0];
            (std::iter::repeat_n(step, SIZE[0] * SIZE[1]).flatten().collect(), 2, SIZE[0] as u32)
        }
        _ => return 0,
    };
    let mut images = film.images.borrow_mut();
    images.push(data);
    let data = images.last().unwrap();
    let image_of = IsophoteImage {
        data: data.as_ptr().cast(),
        row_stride: (width * channels * 4) as isize,
        sample: ISOPHOTE_SAMPLE_F32,
        channels,
        width,
        height: SIZE[1] as u32,
        x: 0,
        y: 0,
    };
    // SAFETY: as above.
    unsafe { image.write(image_of) };
    1
}

unsafe extern "C" fn release(user: *mut c_void, _: *const c_char, _: i64, _: *const IsophoteImage) {
    // SAFETY: as above.
    *unsafe { &*user.cast::<Film>() }.released.borrow_mut() += 1;
}

/// The extension with a graph of one steady style.
struct Theatre {
    library: Loaded,
    table: &'static IsophoteSequenceApi,
    graph: IsophoteGraph,
}

impl Theatre {
    fn new(steadiness: f64) -> Self {
        let library = Loaded::new();
        // SAFETY: the name ends with a zero; the table is of the type that its name says.
        let table = unsafe {
            (library.api.extension)(c"isophote.sequence/1".as_ptr()).cast::<IsophoteSequenceApi>().as_ref()
        };
        let table = table.expect("the library has sequences");
        assert_eq!(table.struct_size as usize, size_of::<IsophoteSequenceApi>());
        let mut graph = IsophoteGraph::default();
        // SAFETY: names end with zeros, places may be written.
        unsafe {
            let status = (library.api.graph_create_single)(c"cartoon".as_ptr(), null_mut(), &raw mut graph);
            assert_eq!(status, ISOPHOTE_OK);
            let value = CString::new(steadiness.to_string()).unwrap();
            let status = (library.api.graph_set_text)(graph, 0, c"steadiness".as_ptr(), value.as_ptr());
            assert_eq!(status, ISOPHOTE_OK);
        }
        Self { library, table, graph }
    }

    fn sequence(&self, memory: u64) -> IsophoteSequence {
        let mut sequence = IsophoteSequence::default();
        // SAFETY: the place may be written.
        let status = unsafe { (self.table.create)(memory, 0.0, null_mut(), &raw mut sequence) };
        assert_eq!(status, ISOPHOTE_OK);
        sequence
    }

    fn request(&self, frame: i64) -> IsophoteRequest {
        let mut request = std::mem::MaybeUninit::uninit();
        // SAFETY: the request may be written, and is then.
        let request = unsafe {
            let status =
                (self.library.api.request_init)(SIZE[0] as u32, SIZE[1] as u32, request.as_mut_ptr());
            assert_eq!(status, ISOPHOTE_OK);
            request.assume_init()
        };
        let guides = ISOPHOTE_GUIDE_MOTION | ISOPHOTE_GUIDE_MOTION_FORWARD;
        IsophoteRequest { guides, frame, ..request }
    }

    /// A frame, or the status and the message.
    fn frame(&self, sequence: IsophoteSequence, film: &Film, frame: i64) -> Result<Vec<f32>, (u32, String)> {
        let frames = IsophoteFrames {
            user: (&raw const *film).cast_mut().cast(),
            input: Some(input),
            release: Some(release),
        };
        let request = self.request(frame);
        let mut out = vec![-7.0_f32; 4 * SIZE[0] * SIZE[1]];
        let target = IsophoteTarget {
            data: out.as_mut_ptr().cast(),
            row_stride: (SIZE[0] * 16) as isize,
            sample: ISOPHOTE_SAMPLE_F32,
            channels: 4,
            width: SIZE[0] as u32,
            height: SIZE[1] as u32,
            x: 0,
            y: 0,
        };
        // SAFETY: handles are the tests' own, and everything pointed to lives during the call.
        let status = unsafe {
            (self.table.process)(
                sequence,
                self.graph,
                IsophoteDevice::default(),
                &raw const request,
                &raw const frames,
                null(),
                &raw const target,
                null(),
                null_mut(),
            )
        };
        if status == ISOPHOTE_OK {
            return Ok(out);
        }
        assert!(out.iter().all(|v| *v == -7.0), "a failed call leaves the target as it was");
        let said = text(|t| {
            // SAFETY: as above.
            let _ = unsafe { (self.table.error)(sequence, t) };
        });
        Err((status, said))
    }
}

#[test]
fn every_order_and_every_memory_gives_the_same_frames() {
    let theatre = Theatre::new(0.5);
    let (mut past, mut future) = (9, 9);
    // SAFETY: both places may be written.
    let status = unsafe { (theatre.table.frames)(theatre.graph, &raw mut past, &raw mut future) };
    assert_eq!((status, past, future), (ISOPHOTE_OK, 2, 2));
    let film = Film::new();
    let roomy = theatre.sequence(1 << 26);
    let in_order: Vec<_> = (1..=8).map(|n| theatre.frame(roomy, &film, n).unwrap()).collect();
    assert_eq!(*film.released.borrow(), film.images.borrow().len(), "every image is given back");
    let roomy_reads = film.count("color");
    for memory in [0, 1 << 15, 1 << 26] {
        let (film, sequence) = (Film::new(), theatre.sequence(memory));
        for frame in [5, 2, 8, 1, 7, 3, 6, 4] {
            let shown = theatre.frame(sequence, &film, frame).unwrap();
            assert!(shown == in_order[frame as usize - 1], "frame {frame} with {memory} bytes");
        }
        // SAFETY: the handle is not used again.
        assert_eq!(unsafe { (theatre.table.destroy)(sequence) }, ISOPHOTE_OK);
    }
    let film = Film::new();
    let forgetful = theatre.sequence(0);
    (1..=8).for_each(|n| drop(theatre.frame(forgetful, &film, n).unwrap()));
    assert!(roomy_reads < film.count("color"), "stages that are kept need no colour");
    // SAFETY: the handle is the tests' own.
    assert_eq!(unsafe { (theatre.table.forget)(roomy) }, ISOPHOTE_OK);
    assert!(theatre.frame(roomy, &film, 4).unwrap() == in_order[3]);
}

#[test]
fn hosts_with_one_frame_or_only_the_past_get_theirs() {
    let theatre = Theatre::new(0.5);
    let sequence = theatre.sequence(1 << 26);
    let lonely = Film { first: 4, last: 4, ..Film::new() };
    let alone = theatre.frame(sequence, &lonely, 4).unwrap();
    let still = Theatre::new(0.0);
    let film = Film::new();
    let unsteady = still.frame(still.sequence(0), &film, 4).unwrap();
    assert!(alone == unsteady, "one frame is the still");
    assert_eq!(film.count("motion"), 0, "stills read no motion");
    let past = Film { last: 4, ..Film::new() };
    let known = theatre.frame(theatre.sequence(1 << 26), &past, 4).unwrap();
    assert!(known != alone, "frames before count");
    let both = theatre.frame(theatre.sequence(1 << 26), &film, 4).unwrap();
    assert!(known != both, "and so do frames after");
}

#[test]
fn motion_that_is_missing_unknown_or_of_another_size_does_no_harm() {
    let theatre = Theatre::new(0.5);
    let still = {
        let still = Theatre::new(0.0);
        still.frame(still.sequence(0), &Film::new(), 4).unwrap()
    };
    for motion in [[f32::NAN, 0.0], [f32::INFINITY, f32::NEG_INFINITY], [1e30, 0.0], [500.0, 3.0]] {
        let film = Film { motion, last: 4, ..Film::new() };
        let shown = theatre.frame(theatre.sequence(1 << 26), &film, 4).unwrap();
        assert!(shown == still, "{motion:?} leads nowhere");
    }
    // Without the motion of frame 3 only the frame next to 4 can be reached.
    let film = Film { without_motion: Some(3), last: 4, ..Film::new() };
    let shown = theatre.frame(theatre.sequence(1 << 26), &film, 4).unwrap();
    assert!(shown.iter().all(|v| v.is_finite()));
    let film = Film { without_motion: Some(4), ..Film::new() };
    let (status, said) = theatre.frame(theatre.sequence(1 << 26), &film, 4).unwrap_err();
    assert_eq!(status, ISOPHOTE_ERROR_INPUT);
    assert!(said.contains("'motion'") && said.contains("frame 4"), "{said}");
    let film = Film { motion_width: 20, ..Film::new() };
    let (status, said) = theatre.frame(theatre.sequence(1 << 26), &film, 4).unwrap_err();
    assert_eq!(status, ISOPHOTE_ERROR_GEOMETRY);
    assert!(said.contains("'motion'") && said.contains("frame"), "{said}");
}

#[test]
fn wrong_calls_are_answered() {
    let theatre = Theatre::new(0.5);
    let film = Film { first: 9, ..Film::new() };
    let sequence = theatre.sequence(0);
    let (status, said) = theatre.frame(sequence, &film, 4).unwrap_err();
    assert_eq!(status, ISOPHOTE_ERROR_INPUT, "{said}");
    assert!(said.contains("'color' of frame 4"), "{said}");
    let none = IsophoteSequence { id: 12345 };
    let (status, _) = theatre.frame(none, &Film::new(), 4).unwrap_err();
    assert_eq!(status, ISOPHOTE_ERROR_INVALID_HANDLE);
    let mut made = IsophoteSequence::default();
    for bad in [-1.0, f32::NAN, 1e9] {
        // SAFETY: the place may be written.
        let status = unsafe { (theatre.table.create)(0, bad, null_mut(), &raw mut made) };
        assert_eq!(status, ISOPHOTE_ERROR_INVALID_ARGUMENT, "{bad}");
    }
    // SAFETY: null is answered, and a handle that is used no more.
    unsafe {
        assert_eq!((theatre.table.create)(0, 0.0, null_mut(), null_mut()), ISOPHOTE_ERROR_INVALID_ARGUMENT);
        assert_eq!((theatre.table.destroy)(sequence), ISOPHOTE_OK);
        assert_eq!((theatre.table.destroy)(sequence), ISOPHOTE_ERROR_INVALID_HANDLE);
    }
}

#[test]
fn plans_in_order_name_what_frames_hand_on() {
    let theatre = Theatre::new(0.5);
    for (past, wanted) in [(0, 0), (1, 1), (2, 2), (9, 2)] {
        let history = IsophoteHistory { past, max_motion: 0.0 };
        let mut plan = IsophotePlan::default();
        let request = theatre.request(1);
        // SAFETY: everything pointed to lives during the call; the plan may be written.
        let status = unsafe {
            (theatre.table.plan_create)(
                theatre.graph,
                &raw const request,
                &raw const history,
                null(),
                null_mut(),
                &raw mut plan,
            )
        };
        assert_eq!(status, ISOPHOTE_OK);
        // SAFETY: as above; the list lives as long as the plan.
        let names: Vec<String> = unsafe {
            let (mut items, mut count) = (null(), 0);
            assert_eq!(
                (theatre.library.api.plan_textures)(plan, &raw mut items, &raw mut count),
                ISOPHOTE_OK
            );
            let all: &[IsophoteTexture] = std::slice::from_raw_parts(items, count as usize);
            all.iter()
                .map(|t| {
                    if t.name.is_null() {
                        String::new()
                    } else {
                        CStr::from_ptr(t.name).to_str().unwrap().into()
                    }
                })
                .collect()
        };
        let farthest = (1..=9).filter(|n| names.iter().any(|name| *name == format!("stage0@-{n}"))).max();
        assert_eq!(farthest.unwrap_or(0), wanted, "{names:?}");
        assert!(names.iter().any(|name| name == "stage0"), "{names:?}");
        // SAFETY: the plan is not used again.
        assert_eq!(unsafe { (theatre.library.api.plan_destroy)(plan) }, ISOPHOTE_OK);
    }
}
