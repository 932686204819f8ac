//! Blend of two pictures, by coverage: the `mix` parameter of every colour node.
//!
//! Cost: eight multiply-adds and a division per pixel.

pub use crate::kernels::shaders::mix::Params;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(mix {
    cpu: run,
    cost: |_| 12.0,
    tolerance: Tolerance { absolute: 1e-6, relative: 2e-6, outliers: 0.0, reason: "a dozen roundings" },
});

/// (1 - amount) first + amount second.
pub fn pass(plan: &mut PlanBuilder, first: ImageId, second: ImageId, amount: f32) -> ImageId {
    plan.pass(&KERNEL, &[first, second], &Params { amount }, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let amount = pass.params::<Params>().amount;
    let (first, second) = (&pass.inputs[0], &pass.inputs[1]);
    let window = band.window;
    for y in window.y0..window.y1 {
        let target = band.row_mut(0, y);
        let row = |view: &isophote_engine::View<'_>| view.offset(window.x0, y);
        let (a, b) = (&first.data()[row(first)..], &second.data()[row(second)..]);
        let pixels = a.chunks_exact(4).zip(b.chunks_exact(4)).zip(target.chunks_exact_mut(4));
        for ((a, b), t) in pixels {
            let (wa, wb) = ((1.0 - amount) * a[3], amount * b[3]);
            let alpha = wa + wb;
            for c in 0..3 {
                t[c] = if alpha > 1e-6 { (wa * a[c] + wb * b[c]) / alpha } else { 0.0 };
            }
            t[3] = alpha;
        }
    }
}
