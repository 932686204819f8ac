//! Each pixel takes the colour of those modes around it (of `local_mode`), found at a coarser level, that
//! its own colour is near: joint bilateral upsampling (Kopf, Cohen, Lischinski and Uyttendaele 2007), where colours are
//! compared with the modes themselves, so that a border lies where the picture is as near to one as to the other. Modes
//! count by a quadratic B-spline of their distance. Small things that are like none of them keep their own colours.
//!
//! Cost: nine exponentials and 13 operations for each of nine modes. Modes are spread to the pixels of a row, so that those
//! of eight pixels are read at once.

pub use crate::kernels::shaders::nearest_mode::Params;
use crate::kernels::simd::pixels::{BLOCK, Block, eight};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(nearest_mode {
    cpu: |simd, pass, params, band| run(simd, pass, &params, band),
    cost: |_| 250.0,
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-5,
        outliers: 2e-3,
        reason: "roundings of large differences are magnified where a colour is as near to one mode as to another",
    },
});

/// Options of the pass.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation of the weights in colour, in the unit of the colour: softness of the borders.
    pub softness: f32,
    /// Difference to the modes from which on small things keep their colours; from twice that in full.
    pub least: f32,
}

/// A colour in the modes of an image of a coarser level.
pub fn pass(plan: &mut PlanBuilder, [color, modes]: [ImageId; 2], options: &Options) -> ImageId {
    let level = plan.desc(color).level;
    let params = Params {
        levels: (plan.desc(modes).level - level).max(0) as u32,
        range: -0.5 * std::f32::consts::LOG2_E / (options.softness * options.softness).max(1e-9),
        inverse_least: 1.0 / options.least.max(1e-6),
    };
    let supports = [Support::Pixels(0), Support::Pixels(1)];
    plan.pass_reaching(&KERNEL, &[color, modes], &params, &[Class::Colour], &supports, level)
}

/// Weights of three pixels by the quadratic B-spline, at a share `t` of the way through the middle one.
fn spline(t: f32) -> [f32; 3] {
    [0.5 * (1.0 - t) * (1.0 - t), 0.75 - (t - 0.5) * (t - 0.5), 0.5 * t * t]
}

/// The modes of three rows, spread to the pixels of a finer one, by channel; and the weights of three columns.
#[derive(Debug, Default)]
struct Spread {
    /// The middle row; none yet.
    middle: Option<i32>,
    rows: [[Vec<f32>; 4]; 3],
    columns: [Vec<f32>; 3],
    scratch: Vec<f32>,
}

impl Spread {
    /// Weights of columns `x0..x1`.
    fn start(&mut self, levels: u32, [x0, x1]: [i32; 2]) {
        let side = 1 << levels;
        for (i, column) in self.columns.iter_mut().enumerate() {
            let weight = |x: i32| spline(((x & (side - 1)) as f32 + 0.5) / side as f32)[i];
            column.clear();
            column.extend((x0..x1 + BLOCK as i32).map(weight));
        }
    }

    /// The rows around `middle`, from a pixel of theirs before `x0` to one after `x1`.
    fn load(&mut self, view: &View<'_>, middle: i32, levels: u32, [x0, x1]: [i32; 2]) {
        if self.middle == Some(middle) {
            return;
        }
        self.middle = Some(middle);
        let side = 1 << levels;
        let (from, to) = (x0 - side, x1 + side + BLOCK as i32);
        let (first, last) = (from >> levels, ((x1 - 1) >> levels) + 2);
        for (dy, row) in self.rows.iter_mut().enumerate() {
            let source = view.padded_row(middle + dy as i32 - 1, first, last, &mut self.scratch);
            for (channel, target) in row.iter_mut().enumerate() {
                target.clear();
                // What lies beyond the last pixel fills up vectors.
                target.extend(
                    (from..to).map(|x| source[4 * ((x >> levels).min(last - 1) - first) as usize + channel]),
                );
            }
        }
    }
}

#[inline(always)]
fn run<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    let (view, modes, levels) = (&pass.inputs[0], &pass.inputs[1], params.levels);
    let columns = [window.x0, window.x1];
    let side = 1 << levels;
    let mut spread = Spread::default();
    spread.start(levels, columns);
    for y in window.y0..window.y1 {
        spread.load(modes, y >> levels, levels, columns);
        let rows = spline(((y & (side - 1)) as f32 + 0.5) / side as f32);
        for x in (window.x0..window.x1).step_by(BLOCK) {
            let block = Block::until(window.x1, x, y);
            let at = (x - window.x0) as usize;
            let pixels = near(simd, params, &spread, rows, [at, side as usize], block.read(simd, view));
            block.write(pixels, band, 0);
        }
    }
}

/// Eight pixels whose modes begin `at` in the rows held.
#[inline(always)]
fn near<S: Simd>(
    simd: S,
    params: &Params,
    spread: &Spread,
    rows: [f32; 3],
    [at, side]: [usize; 2],
    [r, g, b, alpha]: [f32x8<S>; 4],
) -> [f32x8<S>; 4] {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let (mut sum_r, mut sum_g, mut sum_b, mut norm) = (zero, zero, zero, zero);
    for y in 0..3 {
        let [reds, greens, blues, alphas] = &spread.rows[y];
        for x in 0..3 {
            let place = at + x * side;
            let dr = eight(simd, reds, place) - r;
            let dg = eight(simd, greens, place) - g;
            let db = eight(simd, blues, place) - b;
            let distance2 = db.mul_add(db, dg.mul_add(dg, dr * dr));
            let near = (distance2 * params.range).at_least(f32x8::splat(simd, -60.0)).exp2_falling();
            let domain = eight(simd, alphas, place) * eight(simd, &spread.columns[x], at) * rows[y];
            let weight = domain * near;
            sum_r = weight.mul_add(dr, sum_r);
            sum_g = weight.mul_add(dg, sum_g);
            sum_b = weight.mul_add(db, sum_b);
            norm += weight;
        }
    }
    let seen = norm.simd_gt(f32x8::splat(simd, 1e-30));
    let inverse = seen.select(one / norm, zero);
    let (dr, dg, db) = (sum_r * inverse, sum_g * inverse, sum_b * inverse);
    let length = db.mul_add(db, dg.mul_add(dg, dr * dr)).sqrt();
    let t = (length * params.inverse_least - 1.0).within(0.0, 1.0);
    let share = one - t * t * (t * -2.0 + 3.0);
    [dr.mul_add(share, r), dg.mul_add(share, g), db.mul_add(share, b), alpha]
}
