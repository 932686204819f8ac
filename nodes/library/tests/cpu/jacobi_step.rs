//! `jacobi_step` on the CPU executor.

use isophote::kernels::structure::jacobi_step::*;
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Class, Image, ImageId, PlanBuilder, Rect};

const SIZE: [u32; 2] = [37, 29];

/// Known are two columns and a spot.
fn valid(x: u32, y: u32) -> bool {
    x == 3 || x == 33 || (x == 20 && (8..20).contains(&y))
}

/// Values between 0 and 4 where known, and large ones, which must not shine through, elsewhere.
fn known() -> Image {
    let [w, h] = SIZE;
    let value = |x: u32, y: u32, c: u32| match (c, valid(x, y)) {
        (3, valid) => f32::from(u8::from(valid)),
        (_, false) => (100 + 37 * x + 11 * y + c) as f32,
        (0, _) => 1.0 + x as f32 / 10.0,
        (1, _) => 0.5 - y as f32 / 40.0,
        _ => {
            if x == 20 {
                4.0
            } else {
                1.0
            }
        }
    };
    let values = (0..4 * w * h).map(|i| value(i / 4 % w, i / 4 / w, i % 4));
    Image::from_vec(w, h, 4, values.collect()).unwrap()
}

fn field(describe: impl Fn(&mut PlanBuilder, ImageId) -> ImageId) -> Image {
    let mut plan = PlanBuilder::new(SIZE[0], SIZE[1]).unwrap();
    let tensor = plan.input("tensor", 4, Class::Field);
    let tensor = describe(&mut plan, tensor);
    plan.output("tensor", tensor);
    let (plan, region) = (plan.finish().unwrap(), Rect::of_size(SIZE[0], SIZE[1]));
    CpuExecutor::new()
        .run(&plan, &[("tensor", &known())], region, &CallingThread, Control::default())
        .unwrap()
        .remove(0)
}

/// The converged solution, in double precision.
fn solution() -> Vec<[f64; 3]> {
    let ([w, h], known) = (SIZE, known());
    let mut values = vec![[0.0f64; 3]; (w * h) as usize];
    for _ in 0..20_000 {
        for i in 0..w * h {
            let (x, y) = (i % w, i / w);
            let at = |x: u32, y: u32| values[(y.min(h - 1) * w + x.min(w - 1)) as usize];
            let (left, up) = (x.saturating_sub(1), y.saturating_sub(1));
            let around = [at(x + 1, y), at(left, y), at(x, y + 1), at(x, up)];
            values[i as usize] = std::array::from_fn(|c| {
                if valid(x, y) {
                    f64::from(known.pixel(x as i32, y as i32)[c])
                } else {
                    around.iter().map(|v| v[c]).sum::<f64>() / 4.0
                }
            });
        }
    }
    values
}

#[test]
fn relaxation_comes_close_to_the_solution_of_laplaces_equation() {
    let solution = solution();
    let error = |got: &Image| {
        let pixels = got.data().chunks_exact(4).zip(&solution);
        let squares = pixels.flat_map(|(g, s)| (0..3).map(move |c| (f64::from(g[c]) - s[c]).powi(2)));
        (squares.sum::<f64>() / (3 * solution.len()) as f64).sqrt()
    };
    let [one, three] = [1, 3].map(|steps| field(|plan, tensor| relax(plan, tensor, steps)));
    // The known values span 4.
    assert!(error(&one) < 0.06 * 4.0 && error(&three) < 0.03 * 4.0, "{} {}", error(&one), error(&three));
    for (got, known) in one.data().chunks_exact(4).zip(known().data().chunks_exact(4)) {
        assert!(if known[3] > 0.0 { got == known } else { got[3] == 0.0 });
    }
}

#[test]
fn many_steps_converge_to_the_solution() {
    let got = field(|plan, tensor| (0..1500).fold(relax(plan, tensor, 1), |t, _| pass(plan, t)));
    for (got, want) in got.data().chunks_exact(4).zip(solution()) {
        assert!((0..3).all(|c| (f64::from(got[c]) - want[c]).abs() < 2e-3), "{got:?} for {want:?}");
    }
}
