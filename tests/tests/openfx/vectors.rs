//! Clips of motion vectors: what their numbers mean, in which pixels, and what there is where they say nothing.

use super::film::{self, RANGE, SIZE, STEP, connect, connect_motion, connect_vectors, render, vectors};
use super::reference::*;
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::{Described, Instance, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;
use isophote_tests::random::Random;

fn steady<'h>(host: &'h Host, binary: &Binary) -> Instance<'h> {
    let described = Described::new(host, binary.plugin("org.isophote.steady"));
    let instance = described.instance(kOfxImageEffectContextGeneral);
    plain(&instance);
    instance.set("window", 1);
    instance
}

fn floats(picture: &Picture) -> Vec<f32> {
    values(&picture.packed(), &picture.layout)
}

pub fn every_convention_means_the_same(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let instance = steady(&host, binary);
    connect(&instance, Layout::default());
    let node = isophote::registry::find("steady").unwrap();
    let wanted = film::through_the_library(&Expected { node }, 1, false, 5);
    let [w, h] = SIZE.map(|n| n as f32);
    // To the next frame, x to the right and y up.
    let [x, y] = [STEP[0], -STEP[1]];
    let none = [0.0; 2];
    for (convention, [first, second]) in [
        [[-x, -y], none],
        [[x, y], none],
        [[-x, -y], [-x, -y]],
        [[-x, y], none],
        [[0.5 + 0.5 * x, 0.5 + 0.5 * y], none],
        [[0.5 + x / w, 0.5 + y / h], none],
    ]
    .into_iter()
    .enumerate()
    {
        instance.set("motion_convention", convention as i32);
        connect_vectors(&instance, "Motion", &vectors(first, second));
        let got = floats(&render(&instance, 5));
        if convention == 5 {
            // Shares of the picture's size are rounded, which decides at its border what comes from outside.
            let apart = got.iter().zip(&wanted).filter(|(a, b)| (**a - **b).abs() > 1e-4).count();
            assert!(apart <= wanted.len() / 20, "{apart} of {}", wanted.len());
        } else {
            assert!(got == wanted, "{convention}");
        }
    }
    // Vectors to the next frame stand for those to the one before.
    instance.set("motion_convention", 0);
    instance.disconnect("Motion");
    connect_vectors(&instance, "MotionForward", &vectors([x, y], none));
    assert!(floats(&render(&instance, 5)) == wanted);
    host.no_faults();
}

pub fn unknown_vectors_leave_the_frame_alone(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let instance = steady(&host, binary);
    connect(&instance, Layout::default());
    connect_motion(&instance);
    let carried = floats(&render(&instance, 5));
    instance.set("steadiness", 0.0);
    let still = floats(&render(&instance, 5));
    instance.set("steadiness", 0.5);
    assert!(carried != still);
    connect_vectors(&instance, "Motion", &vectors([f32::NAN; 2], [0.0; 2]));
    assert!(floats(&render(&instance, 5)) == still);
    connect_vectors(&instance, "Motion", &vectors([1e6, 0.0], [0.0; 2]));
    assert!(floats(&render(&instance, 5)) == still);
    // A clip of another size: what it does not hold is unknown.
    let (half, layout) = (20, Layout::default());
    let vector = vectors([-STEP[0], STEP[1]], [0.0; 2]);
    let bytes: Vec<u8> = vector.iter().flat_map(|v| v.to_ne_bytes()).collect();
    let small = Picture::packed_in(layout, half, SIZE[1], &bytes[..(half * SIZE[1] * 16) as usize]);
    instance.connect_film("Motion", RANGE[0] as i32, vec![small; 6]);
    let got = floats(&render(&instance, 5));
    for (at, pixel) in got.chunks_exact(4).enumerate() {
        let (column, range) = (at as i32 % SIZE[0], at * 4..at * 4 + 4);
        if column >= half {
            assert!(*pixel == still[range], "{at}");
        }
    }
    let changed = got.chunks_exact(4).zip(still.chunks_exact(4)).filter(|(a, b)| a != b).count();
    assert!(changed > 300, "{changed}");
    // What cannot hold vectors is no clip of motion: they are estimated.
    instance.disconnect("Motion");
    let estimated = floats(&render(&instance, 5));
    let coverage = Layout { components: kOfxImageComponentAlpha, ..layout };
    let single =
        (RANGE[0]..=RANGE[1]).map(|_| film::picture(coverage, &vectors([1.0; 2], [1.0; 2]))).collect();
    instance.connect_film("Motion", RANGE[0] as i32, single);
    assert!(floats(&render(&instance, 5)) == estimated);
    // Frames of it that lack channels have no vectors, and are no neighbours.
    let frames = (RANGE[0]..=RANGE[1]).map(|n| if n == 5 { layout } else { coverage });
    let mixed = frames.map(|layout| film::picture(layout, &vector)).collect();
    instance.connect_film("Motion", RANGE[0] as i32, mixed);
    assert!(floats(&render(&instance, 5)) == still);
    host.no_faults();
}

/// Rendered pixels that everything moves to the right and downwards from frame to frame.
const MOVES: [i32; 2] = [2, -1];

/// A frame of strong texture that moves, and that with noise of its own.
fn noisy(number: i32) -> [Vec<f32>; 2] {
    let mut random = Random::new(number as u64 + 1);
    let mut frames = [Vec::new(), Vec::new()];
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let (u, v) = ((x - MOVES[0] * number) as f32, (y - MOVES[1] * number) as f32);
            let clean = 0.5 + 0.2 * (0.7 * u).sin() + 0.2 * (0.6 * v + 0.2 * u).cos();
            frames[0].extend([clean, clean, clean, 1.0]);
            let grain = [0; 3].map(|_| clean + random.range(-0.04, 0.04));
            frames[1].extend([grain[0], grain[1], grain[2], 1.0]);
        }
    }
    frames
}

/// The mean distance from the clean frame, of what a host of such pixels sees, with and without its neighbours.
fn distances(instance: &Instance<'_>, scale: f64, aspect: f64) -> [f32; 2] {
    let layout = Layout { scale, aspect, ..Layout::default() };
    let source = (4..=6).map(|n| film::picture(layout, &noisy(n)[1])).collect();
    instance.connect_film("Source", 4, source);
    // In pixels of the full size, y up.
    let [x, y] = MOVES.map(|n| n as f32 / scale as f32);
    let motion = film::picture(layout, &vectors([-x, y], [0.0; 2]));
    instance.connect_film("Motion", 4, vec![motion; 3]);
    let clean = noisy(5).into_iter().next().unwrap();
    [0.0, 1.0].map(|steadiness| {
        instance.set("steadiness", steadiness);
        let wanted = Wanted { time: 5.0, scale, ..Wanted::new([0, 0, SIZE[0], SIZE[1]]) };
        let (status, got) = instance.try_render(layout, SIZE, &wanted);
        assert_eq!(status, kOfxStatOK);
        let apart = floats(&got).iter().zip(&clean).map(|(a, b)| (a - b).abs()).sum::<f32>();
        apart / clean.len() as f32
    })
}

pub fn vectors_are_in_pixels_of_the_full_size(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let instance = steady(&host, binary);
    // Whatever is carried counts, so that wrong places show.
    instance.set("color_agreement", 200.0);
    for (scale, aspect) in [(1.0, 1.0), (0.5, 1.0), (0.25, 1.0), (1.0, 2.0), (0.5, 2.0), (1.0, 0.5)] {
        let [alone, carried] = distances(&instance, scale, aspect);
        println!("scale {scale}, aspect {aspect}: {alone:.4} alone, {carried:.4} carried");
        assert!(carried < 0.75 * alone, "scale {scale}, aspect {aspect}");
    }
    host.no_faults();
}
