//! Images through the C table: formats, strides, overlaps, regions, memory, bad pixels.

#![allow(unsafe_code, reason = "calls through the C table")]

use crate::c_images::{HEIGHT, Run, WIDTH, color, floats, image, picture, target};
use isophote_abi::*;
use isophote_tests::library::Loaded;
use std::ffi::c_void;
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicU32, Ordering};

#[test]
fn every_format_goes_in_and_out() {
    let library = Loaded::new();
    let run = Run::new(&library, "gaussian");
    let (data, expected) = run.pictures();
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
fn light_beyond_coverage_is_found_and_kept() {
    let library = Loaded::new();
    let mut run = Run::new(&library, "gaussian");
    let glow: Vec<f32> = (0..WIDTH * HEIGHT)
        .flat_map(|i| {
            let (x, y) = ((i % WIDTH).abs_diff(WIDTH / 2), (i / WIDTH).abs_diff(HEIGHT / 2));
            if x < 5 && y < 5 { [0.9, 0.2, 0.0, 0.0] } else { [0.0; 4] }
        })
        .collect();
    let red = |pixels: &[f32]| pixels.iter().step_by(4).sum::<f32>();
    let found = run.result(&color(floats(&glow)));
    assert!((red(&found) / red(&glow) - 1.0).abs() < 1e-3, "{} of {}", red(&found), red(&glow));
    run.request.alpha = ISOPHOTE_ALPHA_EMISSIVE;
    assert!(run.result(&color(floats(&glow))) == found, "said by the host");
    // Straight colours without coverage mean nothing.
    run.request.alpha = ISOPHOTE_ALPHA_STRAIGHT;
    assert_eq!(red(&run.result(&color(floats(&glow)))), 0.0);
}

#[test]
fn rows_may_run_upwards_and_buffers_overlap() {
    let library = Loaded::new();
    let run = Run::new(&library, "gaussian");
    let (data, expected) = run.pictures();
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
    let (data, expected) = run.pictures();
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
    assert_eq!(status, ISOPHOTE_ERROR_GEOMETRY);
    assert!(
        said.contains(&format!("{}x{} pixels at ({}, {}) is needed", part.width, part.height, w.x0, w.y0))
    );
    // A target that does not hold the region is refused.
    let (status, said, _) = run.run(&color(part), &target(IsophoteImage { x: 14, ..floats(&out) }));
    assert_eq!(status, ISOPHOTE_ERROR_GEOMETRY, "{said}");
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
        (IsophoteImage { data: null(), ..good }, ISOPHOTE_ERROR_INVALID_ARGUMENT),
        (IsophoteImage { sample: 4, ..good }, ISOPHOTE_ERROR_INVALID_ARGUMENT),
        (IsophoteImage { sample: u32::MAX, ..good }, ISOPHOTE_ERROR_INVALID_ARGUMENT),
        (IsophoteImage { channels: 0, ..good }, ISOPHOTE_ERROR_INVALID_ARGUMENT),
        (IsophoteImage { channels: 2, ..good }, ISOPHOTE_ERROR_INVALID_ARGUMENT),
        (IsophoteImage { channels: u32::MAX, ..good }, ISOPHOTE_ERROR_INVALID_ARGUMENT),
        (IsophoteImage { width: 0, ..good }, ISOPHOTE_ERROR_GEOMETRY),
        (IsophoteImage { height: 0, ..good }, ISOPHOTE_ERROR_GEOMETRY),
        (IsophoteImage { width: u32::MAX, ..good }, ISOPHOTE_ERROR_GEOMETRY),
        (IsophoteImage { height: u32::MAX, ..good }, ISOPHOTE_ERROR_GEOMETRY),
        (IsophoteImage { row_stride: 0, ..good }, ISOPHOTE_ERROR_GEOMETRY),
        (IsophoteImage { row_stride: row - 1, ..good }, ISOPHOTE_ERROR_GEOMETRY),
        (IsophoteImage { row_stride: 1 - row, ..good }, ISOPHOTE_ERROR_GEOMETRY),
        (IsophoteImage { row_stride: isize::MAX, ..good }, ISOPHOTE_ERROR_GEOMETRY),
        (IsophoteImage { row_stride: isize::MIN, ..good }, ISOPHOTE_ERROR_GEOMETRY),
        (IsophoteImage { x: i32::MAX, ..good }, ISOPHOTE_ERROR_GEOMETRY),
        (IsophoteImage { y: i32::MAX - 3, ..good }, ISOPHOTE_ERROR_GEOMETRY),
        (IsophoteImage { x: 1, ..good }, ISOPHOTE_ERROR_GEOMETRY),
        (IsophoteImage { y: -1, ..good }, ISOPHOTE_ERROR_GEOMETRY),
        (IsophoteImage { x: i32::MIN, y: i32::MIN, ..good }, ISOPHOTE_ERROR_GEOMETRY),
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
    assert!(out.iter().all(|v| *v == -7.0));
}

#[test]
fn missing_unknown_and_doubled_inputs_are_refused() {
    let library = Loaded::new();
    let run = Run::new(&library, "gaussian");
    let data = picture();
    let good = floats(&data);
    let out = vec![-7.0_f32; data.len()];
    let missing = run.run(&[], &target(floats(&out)));
    assert_eq!(missing.0, ISOPHOTE_ERROR_INPUT);
    assert!(missing.1.contains("'color' is missing; 45x31 pixels"), "{}", missing.1);
    let named = |name: &'static std::ffi::CStr| IsophoteInput { name: name.as_ptr(), image: good };
    assert_eq!(run.run(&[named(c"colour")], &target(floats(&out))).0, ISOPHOTE_ERROR_UNKNOWN);
    let twice = run.run(&[named(c"color"), named(c"color")], &target(floats(&out)));
    assert_eq!(twice.0, ISOPHOTE_ERROR_INVALID_ARGUMENT);
    let nameless = IsophoteInput { name: null(), image: good };
    assert_eq!(run.run(&[nameless], &target(floats(&out))).0, ISOPHOTE_ERROR_INVALID_ARGUMENT);
    assert!(out.iter().all(|v| *v == -7.0));
    // Unread guides are ignored, bad ones are not.
    run.result(&[named(c"color"), named(c"depth"), named(c"normal"), named(c"object_id")]);
    let tensor = Run::new(&library, "structure_tensor");
    let bytes = [0_u8; (WIDTH * HEIGHT * 3) as usize];
    let normal = image(bytes.as_ptr().cast(), ISOPHOTE_SAMPLE_U8, 3, WIDTH as isize * 3);
    let inputs = [named(c"color"), IsophoteInput { name: c"normal".as_ptr(), image: normal }];
    let (status, said, _) = tensor.run(&inputs, &target(floats(&out)));
    assert_eq!(status, ISOPHOTE_ERROR_INPUT);
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
    assert_eq!(status, ISOPHOTE_ERROR_OUT_OF_MEMORY, "{said}");
    assert!(said.contains("MiB"), "{said}");
}

/// The functions that bound memory.
fn bounds(library: &Loaded) -> &'static IsophoteMemoryApi {
    // SAFETY: the name ends with a zero; the table lives as long as the library, which is never unloaded.
    unsafe { (library.api.extension)(c"isophote.memory/1".as_ptr()).cast::<IsophoteMemoryApi>().as_ref() }
        .expect("the library bounds memory")
}

/// Rows of a picture that is high against what a Gaussian reads.
const TALL: u32 = 12 * HEIGHT;

fn tall_picture() -> Vec<f32> {
    picture().repeat(12)
}

fn tall(data: &[f32]) -> IsophoteImage {
    IsophoteImage { height: TALL, ..floats(data) }
}

/// Bytes that the images of a run take when they may take `most`.
fn takes(library: &Loaded, run: &Run<'_>, most: u64) -> u64 {
    let (memory, mut bytes) = (bounds(library), 0);
    let region = run.region.as_ref().map_or(null(), |region| &raw const *region);
    // SAFETY: the handle is that of a graph, and the pointers lead to what the table asks for, or to null where they may.
    unsafe {
        assert_eq!((memory.graph_set_memory)(run.graph, most), ISOPHOTE_OK);
        let status = (memory.graph_memory)(run.graph, &raw const run.request, region, &raw mut bytes);
        assert_eq!(status, ISOPHOTE_OK);
    }
    bytes
}

#[test]
fn little_memory_gives_the_same_bits() {
    let library = Loaded::new();
    let mut data = tall_picture();
    data[400] = f32::NAN;
    // Light without coverage far down, which is looked for in rows as well.
    let glow = (TALL as usize - 40) * WIDTH as usize * 4;
    data[glow..glow + 4].copy_from_slice(&[0.9, 0.2, 0.1, 0.0]);
    for node in ["gaussian", "halftone", "flow_dog"] {
        let mut run = Run::new(&library, node);
        run.request.height = TALL;
        for alpha in [ISOPHOTE_ALPHA_STRAIGHT, ISOPHOTE_ALPHA_PREMULTIPLIED] {
            run.request.alpha = alpha;
            for region in [None, Some(IsophoteRect { x0: 4, y0: 3, x1: 44, y1: TALL as i32 - 2 })] {
                run.region = region;
                let of = |most: u64| {
                    let bytes = takes(&library, &run, most);
                    let out = vec![-7.0_f32; data.len()];
                    let (status, said, report) = run.run(&color(tall(&data)), &target(tall(&out)));
                    assert_eq!((status, report.replaced), (ISOPHOTE_OK, 1), "{said}");
                    (bytes, out)
                };
                let ((whole, expected), (least, found)) = (of(0), of(1));
                assert!(2 * least < whole, "{node}: {least} of {whole}");
                assert!(found == expected, "{node} {alpha} {region:?}");
                // In place.
                let memory = data.clone();
                let both = tall(&memory);
                assert_eq!(run.run(&color(both), &target(both)).0, ISOPHOTE_OK);
                assert!(memory.iter().zip(&data).zip(&expected).all(|((found, source), wanted)| {
                    if *wanted == -7.0 { found.to_bits() == source.to_bits() } else { found == wanted }
                }));
            }
        }
        // Bytes, packed as the target has them.
        run.region = None;
        let bytes = |most: u64| {
            takes(&library, &run, most);
            let mut out = vec![0_u8; (WIDTH * TALL * 3) as usize];
            let image = image(out.as_mut_ptr().cast(), ISOPHOTE_SAMPLE_U8, 3, WIDTH as isize * 3);
            let (status, said, _) =
                run.run(&color(tall(&data)), &target(IsophoteImage { height: TALL, ..image }));
            assert_eq!(status, ISOPHOTE_OK, "{said}");
            out
        };
        assert!(bytes(1) == bytes(0), "{node} as bytes");
    }
}

#[test]
fn a_run_by_rows_that_ends_early_writes_nothing() {
    unsafe extern "C" fn later(calls: *mut c_void) -> u32 {
        // SAFETY: the test gave a number that threads may share.
        let calls = unsafe { &*calls.cast::<AtomicU32>() };
        u32::from(calls.fetch_add(1, Ordering::Relaxed) > 30)
    }
    let library = Loaded::new();
    let mut run = Run::new(&library, "gaussian");
    run.request.height = TALL;
    takes(&library, &run, 1);
    let calls = AtomicU32::new(0);
    run.control = Some(IsophoteControl {
        user: (&raw const calls).cast_mut().cast(),
        cancelled: Some(later),
        run: None,
        progress: None,
        measured: None,
        threads: 1,
    });
    let (data, out) = (tall_picture(), vec![-7.0_f32; (WIDTH * TALL * 4) as usize]);
    let (status, said, _) = run.run(&color(tall(&data)), &target(tall(&out)));
    assert_eq!(status, ISOPHOTE_ERROR_CANCELLED, "{said}");
    assert!(out.iter().all(|value| *value == -7.0));
    run.control = None;
    assert_eq!(run.run(&color(tall(&data)), &target(tall(&out))).0, ISOPHOTE_OK);
    assert!(out.iter().all(|value| *value != -7.0));
}

#[test]
fn bad_pixels_are_replaced_and_counted() {
    let library = Loaded::new();
    let run = Run::new(&library, "gaussian");
    let mut data = picture();
    data[400] = f32::NAN;
    data[801] = f32::INFINITY;
    data[1202] = f32::NEG_INFINITY;
    let out = vec![0.0_f32; data.len()];
    let (status, said, report) = run.run(&color(floats(&data)), &target(floats(&out)));
    assert_eq!((status, report.replaced), (ISOPHOTE_OK, 3), "{said}");
    assert!(report.seconds > 0.0);
    assert!(out.iter().all(|v| v.is_finite()));
}
