//! The highest peak of noise in each cell of a pyramid's level, where a stroke may begin. Noise that belongs to things carries
//! its peaks along, so that strokes move with what they paint.
//!
//! Cost: four comparisons.

pub use crate::kernels::shaders::stroke_peaks::Params;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(stroke_peaks {
    cpu: run,
    cost: |_| 20.0,
    tolerance: Tolerance::of_rounding(1e-6, 1e-6, "a product; peaks are compared in the same order"),
});

/// Noise, and cells in which it has peaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peaks {
    /// Standard deviation of the noise.
    pub deviation: f32,
    /// Level of the cells, from 1 on.
    pub level: i8,
    /// Where the picture stands in the canonical one, pixels: cells are those of that one.
    pub origin: [f32; 2],
}

/// Adds the passes: (x, y, height in standard deviations) of the highest peak of the first channel of `noise` in each cell.
pub fn pass(plan: &mut PlanBuilder, noise: ImageId, peaks: &Peaks) -> ImageId {
    let params = |level: i8| Params {
        shift: offset(peaks.origin, level).map(|o| (o as i32) >> (level - 1)),
        gain: 1.0 / peaks.deviation.max(1e-6),
        begin: (level == 1).into(),
    };
    let mut found = noise;
    for level in 1..=peaks.level {
        found = plan.pass_at(&KERNEL, &[found], &params(level), &[Class::Field], Support::Pixels(1), level);
    }
    found
}

/// Pixels by which cells of a level, 2^level wide, begin before a picture that stands at `origin`.
pub fn offset(origin: [f32; 2], level: i8) -> [f32; 2] {
    let cell = (1 << level.clamp(0, 24)) as f32;
    origin.map(|o| o.floor().rem_euclid(cell))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let view = &pass.inputs[0];
    let [width, height] = view.full();
    let window = band.window;
    for y in window.y0..window.y1 {
        let row = band.row_mut(0, y);
        for (x, target) in (window.x0..window.x1).zip(row.chunks_exact_mut(4)) {
            let mut best = [0.0, 0.0, -1e30, 0.0];
            // At the borders some children do not exist.
            for j in (2 * y - params.shift[1]).max(0)..(2 * y - params.shift[1] + 2).min(height) {
                for i in (2 * x - params.shift[0]).max(0)..(2 * x - params.shift[0] + 2).min(width) {
                    let mut peak = view.pixel4(i, j);
                    if params.begin != 0 {
                        let v = (peak[0] - 0.5) * params.gain;
                        peak = [i as f32 + 0.5, j as f32 + 0.5, v, 0.0];
                    }
                    if peak[2] > best[2] {
                        best = peak;
                    }
                }
            }
            target.copy_from_slice(&best);
        }
    }
}
