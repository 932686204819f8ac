//! `edge_tangent_flow` on the CPU executor.

use isophote::kernels::shared::tensor::scalar;
use isophote::kernels::structure::edge_tangent_flow::*;
use isophote::kernels::structure::flow_maximum;
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Class, Image, PlanBuilder, Rect};

const SIDE: u32 = 23;

/// Tangents and magnitudes that vary at random, none in one corner.
fn flow() -> Vec<([f64; 2], f64)> {
    let mut state = 5u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / 16_777_216.0
    };
    (0..SIDE * SIDE)
        .map(|i| {
            let (angle, magnitude) = (next() * std::f64::consts::PI, next());
            if i % SIDE < 4 && i / SIDE < 4 {
                ([0.0; 2], 0.0)
            } else {
                ([angle.cos(), angle.sin()], magnitude)
            }
        })
        .collect()
}

/// (2.134) to (2.136) as they stand, at one pixel.
fn as_printed(flow: &[([f64; 2], f64)], x: i32, y: i32, radius: f64, window: Window) -> [f64; 2] {
    let at = |x: i32, y: i32| {
        let last = SIDE as i32 - 1;
        flow[(y.clamp(0, last) * SIDE as i32 + x.clamp(0, last)) as usize]
    };
    let top = flow.iter().fold(0.0f64, |m, f| m.max(f.1));
    let (t, magnitude) = at(x, y);
    let mut sum = [0.0; 2];
    for j in -20..=20i32 {
        for i in -20..=20i32 {
            let r2 = f64::from(i * i + j * j);
            if r2 >= radius * radius {
                continue;
            }
            let (s, m) = at(x + i, y + j);
            let spatial = match window {
                Window::Box => 1.0,
                Window::Gaussian => (-r2 / (2.0 * (radius / 3.0).powi(2))).exp(),
            };
            let w = spatial * 0.5 * ((m - magnitude) / top + 1.0) * (s[0] * t[0] + s[1] * t[1]);
            sum = [sum[0] + w * s[0], sum[1] + w * s[1]];
        }
    }
    sum
}

#[test]
fn a_pass_on_tensors_is_the_sum_over_vectors() {
    let flow = flow();
    // Tensors of the normals (-y, x).
    let values = flow.iter().flat_map(|([x, y], m)| [y * y, -x * y, x * x, *m].map(|v| v as f32));
    let image = Image::from_vec(SIDE, SIDE, 4, values.collect()).unwrap();
    for (radius, window) in [(5.0, Window::Box), (3.4, Window::Box), (6.0, Window::Gaussian)] {
        let mut plan = PlanBuilder::new(SIDE, SIDE).unwrap();
        let input = plan.input("flow", 4, Class::Field);
        let largest = flow_maximum::pass(&mut plan, input);
        let options = Options { radius, window, neighbours: Neighbours::Disc, last: true };
        let result = pass(&mut plan, input, largest, &options);
        plan.output("tensor", result);
        let region = Rect::of_size(SIDE, SIDE);
        let got = CpuExecutor::new()
            .run(&plan.finish().unwrap(), &[("flow", &image)], region, &CallingThread, Control::default())
            .unwrap()
            .remove(0);
        for (x, y) in [(11, 11), (4, 2), (22, 22), (0, 17), (15, 6)] {
            let want = as_printed(&flow, x, y, f64::from(radius), window);
            let t = got.pixel(x, y);
            let [tx, ty] = scalar::tangent(t[0], t[1], t[2]).map(f64::from);
            let off = (tx * want[1] - ty * want[0]).abs() / want[0].hypot(want[1]);
            assert!(off < 1e-4 && (t[0] + t[2] - 1.0).abs() < 1e-5 && t[3] == 1.0, "{x} {y}: {off}");
        }
        // Where there was no gradient, there is an orientation now.
        assert!((got.pixel(3, 3)[0] + got.pixel(3, 3)[2] - 1.0).abs() < 1e-5);
    }
}
