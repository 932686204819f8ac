//! `edge_detector` on the CPU executor.

use isophote::{Graph, Planned, Request};
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Image, Rect};

/// The edges of a grey picture.
fn edges(params: &[(&str, &str)], size: [u32; 2], grey: impl Fn(f32, f32) -> f32) -> Image {
    let [width, height] = size;
    let pixels = (0..width * height).flat_map(|i| {
        let v = grey((i % width) as f32, (i / width) as f32);
        [v, v, v, 1.0]
    });
    let picture = Image::from_vec(width, height, 4, pixels.collect()).unwrap();
    let mut graph = Graph::single("edge_detector").unwrap();
    let node = graph.node(0).unwrap();
    for (param, value) in params {
        graph.set_text(node, param, value).unwrap();
    }
    let planned = Planned::new(&graph, Request::new(width, height)).unwrap();
    let region = Rect::of_size(width, height);
    CpuExecutor::new()
        .run(planned.plan(), &[("color", &picture)], region, &CallingThread, Control::default())
        .unwrap()
        .remove(0)
}

fn drawn(row: &[f32]) -> usize {
    row.iter().filter(|v| **v < 0.5).count()
}

#[test]
fn a_step_is_one_line_one_pixel_wide_at_every_scale() {
    for method in ["canny", "log_zero_crossing"] {
        for sigma in ["0", "1.4", "4"] {
            let params = [("method", method), ("sigma", sigma)];
            // Straight, and slanted.
            for slope in [0.0, 0.35] {
                let step = |x: f32, y: f32| if x + slope * y < 30.0 { 0.2 } else { 0.7 };
                let out = edges(&params, [64, 48], step);
                for y in 20..28 {
                    let count = drawn(out.row(y));
                    let wanted = 1..=if slope == 0.0 { 1 } else { 2 };
                    assert!(wanted.contains(&count), "{method}, sigma {sigma}, slope {slope}: {count}");
                }
            }
        }
    }
}

#[test]
fn thresholds_are_the_heights_of_steps() {
    // Lightness 41 and 63: a step of 22.
    let step = |x: f32, _: f32| if x < 20.0 { 0.38 } else { 0.6 };
    for method in ["canny", "log_zero_crossing"] {
        for sigma in ["0", "1.4", "3"] {
            let found = |high: &str| {
                let params = [("method", method), ("sigma", sigma), ("high", high)];
                edges(&params, [40, 8], step).data().iter().any(|v| *v < 0.5)
            };
            assert!(found("18") && !found("26"), "{method}, sigma {sigma}");
        }
    }
}

#[test]
fn a_weak_end_is_drawn_as_far_as_the_reach() {
    // A step whose height falls from 60 to 0.
    let fading = |x: f32, y: f32| if y < 10.0 { 0.2 } else { 0.2 + 0.5 * (1.0 - x / 200.0) };
    let length = |params: &[(&str, &str)]| drawn(edges(params, [200, 20], fading).row(9));
    let (strong, all) = (length(&[("reach", "0")]), length(&[]));
    let some = length(&[("reach", "20")]);
    assert!(strong > 40 && all > strong + 30, "{strong}, {some}, {all}");
    assert_eq!(some, strong + 20);
    assert_eq!(all, length(&[("reach", "600")]));
    assert_eq!(all, length(&[("high", "10")]));
}
