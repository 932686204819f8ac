//! `noise` on the CPU executor.

use isophote::kernels::structure::noise::*;
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Image, PlanBuilder, Rect};

fn noise(width: u32, height: u32, scale: f32, seed: u32) -> Image {
    let mut plan = PlanBuilder::new(width, height).unwrap();
    let image = pass(&mut plan, scale, [0.0; 2], seed);
    plan.output("noise", image);
    let region = Rect::of_size(width, height);
    CpuExecutor::new()
        .run(&plan.finish().unwrap(), &[], region, &CallingThread, Control::default())
        .unwrap()
        .remove(0)
}

#[test]
fn values_are_uniform_and_neighbours_independent() {
    let image = noise(257, 200, 1.0, 3);
    let value = |x: i32, y: i32| f64::from(image.pixel(x, y)[0]) - 0.5;
    let mean = |f: &dyn Fn(i32, i32) -> f64| {
        (0..199 * 256).map(|i| f(i % 256, i / 256)).sum::<f64>() / (199.0 * 256.0)
    };
    assert!(mean(&value).abs() < 0.005);
    assert!((mean(&|x, y| value(x, y).powi(2)) * 12.0 - 1.0).abs() < 0.02);
    for (dx, dy) in [(1, 0), (0, 1), (1, 1)] {
        let correlation = mean(&|x, y| value(x, y) * value(x + dx, y + dy)) * 12.0;
        assert!(correlation.abs() < 0.02, "{dx}, {dy}: {correlation}");
    }
    assert!(image != noise(257, 200, 1.0, 4));
}

#[test]
fn a_proxy_shows_the_full_picture_made_smaller() {
    let full = noise(96, 96, 1.0, 0);
    for n in [2_i32, 3, 6] {
        let proxy = noise(96 / n as u32, 96 / n as u32, 1.0 / n as f32, 0);
        for (x, y) in (0..96 / n).flat_map(|y| (0..96 / n).map(move |x| (x, y))) {
            let grains = (0..n * n).map(|i| full.pixel(n * x + i % n, n * y + i / n)[0]);
            let mean = grains.sum::<f32>() / (n * n) as f32;
            assert!((proxy.pixel(x, y)[0] - mean).abs() < 1e-4, "{n}: {x}, {y}");
        }
    }
    // However small, it is the mean of many.
    let tiny = noise(16, 16, 1.0 / 1024.0, 0);
    assert!(tiny.data().chunks_exact(4).all(|p| (p[0] - 0.5).abs() < 0.2));
}
