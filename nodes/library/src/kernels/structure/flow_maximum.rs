//! One level of a pyramid of maxima up; its last one is the largest gradient of the picture, t_max of
//! the edge tangent flow (2.135).
//!
//! Cost: 3 comparisons.

pub use crate::kernels::shaders::flow_maximum::Params;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(flow_maximum {
    cpu: run,
    cost: |_| 4.0,
    tolerance: Tolerance::of_rounding(0.0, 0.0, "comparisons only"),
});

/// Adds passes up to an image of one pixel, the largest value of the last channel of `image`.
pub fn pass(plan: &mut PlanBuilder, image: ImageId) -> ImageId {
    let desc = plan.desc(image);
    if desc.channels == 1 && plan.level_size(desc.level) == [1, 1] {
        return image;
    }
    let params = Params { channel: desc.channels - 1 };
    let half = plan.pass_at(&KERNEL, &[image], &params, &[Class::Field], Support::Pixels(0), desc.level + 1);
    pass(plan, half)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let window = band.window;
    let view = &pass.inputs[0];
    let (channels, channel) = (view.channels(), params.channel as usize);
    let [width, height] = view.full();
    let len = channels * ((2 * window.x1).min(width) - 2 * window.x0) as usize;
    for y in window.y0..window.y1 {
        let row = |y: i32| {
            let at = view.offset(2 * window.x0, y);
            view.data()[at..at + len].chunks(2 * channels)
        };
        let children = row(2 * y).zip(row((2 * y + 1).min(height - 1)));
        for ((upper, lower), target) in children.zip(band.row_mut(0, y)) {
            let values = upper.chunks_exact(channels).chain(lower.chunks_exact(channels));
            *target = values.map(|v| v[channel]).fold(f32::NEG_INFINITY, f32::max);
        }
    }
}
