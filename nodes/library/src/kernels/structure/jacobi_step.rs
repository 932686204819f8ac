//! One Jacobi step of Laplace's equation (2.166) on tensors: those that are not valid become the mean
//! of their four neighbours, valid ones stay (2.171, Listing 2.3). Beyond the border the field goes
//! on unchanged.
//!
//! Cost: 4 additions on four channels where a tensor is not valid.

use super::{tensor_interpolate, tensor_restrict};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x4, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(jacobi_step {
    cpu: run,
    cost: |_| 16.0,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 2e-6,
        outliers: 0.0,
        reason: "three additions in the same order",
    },
});

/// Adds the pass.
pub fn pass(plan: &mut PlanBuilder, tensor: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[tensor], &(), Class::Field, Support::Pixels(1))
}

/// Replaces tensors that are not valid (w = 0) by a membrane spanned over the valid ones (2.165): a
/// pyramid of means up to one pixel, and down again with `steps` Jacobi steps on each level (§ 2.7.3).
/// Where no tensor is valid the field is 0.
pub fn relax(plan: &mut PlanBuilder, tensor: ImageId, steps: i32) -> ImageId {
    if plan.level_size(plan.desc(tensor).level) == [1, 1] {
        return tensor;
    }
    let coarse = tensor_restrict::pass(plan, tensor);
    let coarse = relax(plan, coarse, steps);
    let mut filled = tensor_interpolate::pass(plan, tensor, coarse);
    for _ in 0..steps {
        filled = pass(plan, filled);
    }
    filled
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    dispatch!(pass.level, simd => average(simd, pass, band));
}

#[inline(always)]
fn average<S: Simd>(simd: S, pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let window = band.window;
    let view = &pass.inputs[0];
    let mut scratch = Vec::new();
    let len = 4 * window.width() as usize;
    for y in window.y0..window.y1 {
        let row = |y: i32| {
            let at = view.offset(window.x0, y);
            &view.data()[at..at + len]
        };
        let (above, below) = (row(y - 1), row(y + 1));
        let centre = view.padded_row(y, window.x0 - 1, window.x1 + 1, &mut scratch);
        for (x, target) in band.row_mut(0, y).chunks_exact_mut(4).enumerate() {
            if centre[4 * x + 7] >= 1.0 {
                load(simd, centre, x + 1).store_slice(target);
                continue;
            }
            let across = load(simd, centre, x + 2) + load(simd, centre, x);
            let along = load(simd, below, x) + load(simd, above, x);
            ((across + along) * 0.25).store_slice(target);
            target[3] = 0.0;
        }
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, row: &[f32], x: usize) -> f32x4<S> {
    f32x4::from_slice(simd, &row[4 * x..4 * x + 4])
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
    use isophote_engine::{Image, Rect};

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
}
