//! `rest_footprint` on the CPU executor.

use isophote::kernels::shared::rest_position::NO_FOOTPRINT;
use isophote::kernels::structure::rest_footprint::*;
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Class, Image, PlanBuilder, Rect};

/// The footprints of 24 x 12 points.
fn footprints(point: impl Fn(f32, f32) -> [f32; 4]) -> Image {
    let (width, height) = (24, 12);
    let values = (0..width * height).flat_map(|i| point((i % width) as f32, (i / width) as f32));
    let points = Image::from_vec(width, height, 4, values.collect()).unwrap();
    let mut plan = PlanBuilder::new(width, height).unwrap();
    let input = plan.input("points", 4, Class::Field);
    let output = pass(&mut plan, input);
    plan.output("output", output);
    let region = Rect::of_size(width, height);
    let plan = plan.finish().unwrap();
    let inputs = [("points", &points)];
    CpuExecutor::new().run(&plan, &inputs, region, &CallingThread, Control::default()).unwrap().remove(0)
}

#[test]
fn a_footprint_is_the_mean_width_of_a_pixel() {
    let flat = footprints(|x, y| [0.25 * x, 7.0, -0.25 * y, 1.0]);
    let inclined = footprints(|x, y| [0.5 * x, 0.0, 0.25 * y, 1.0]);
    let grazing = footprints(|x, y| [8.0 * x, 0.25 * y, 0.0, 1.0]);
    for (image, mean, longest) in [(&flat, -2.0, -2.0), (&inclined, -1.5, -1.0), (&grazing, 2.0, 3.0)] {
        for pixel in image.data().chunks_exact(2) {
            assert!((pixel[0] - mean).abs() < 1e-5 && (pixel[1] - longest).abs() < 1e-5, "{pixel:?}");
        }
    }
}

#[test]
fn silhouettes_do_not_count_and_no_object_has_no_footprint() {
    // Two walls, far from each other, and nothing at the right.
    let seen = footprints(|x, y| match x as i32 {
        0..=11 => [0.5 * x, 0.5 * y, 0.0, 1.0],
        12..=19 => [0.5 * x, 0.5 * y, 900.0, 1.0],
        20..=21 => [f32::NAN, 0.0, 0.0, 1.0],
        _ => [0.0; 4],
    });
    for y in 0..12 {
        for x in 0..20 {
            assert_eq!(seen.pixel(x, y)[0], -1.0, "{x}, {y}");
        }
        for x in 20..24 {
            assert_eq!(seen.pixel(x, y), [NO_FOOTPRINT; 2], "{x}, {y}");
        }
    }
    // A background of zeros.
    let nothing = footprints(|_, _| [0.0, 0.0, 0.0, 1.0]);
    assert!(nothing.data().iter().all(|v| *v == NO_FOOTPRINT));
}
