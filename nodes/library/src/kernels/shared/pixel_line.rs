//! Stream lines after Cabral and Leedom (§ 2.9.4), eight at a time: straight through each pixel, along
//! the minor eigenvector of the pixel's own tensor, to the pixel's boundary. The twin of
//! `shaders/shared/pixel_line.wgsl`.
//!
//! The pixel is kept apart from the position, in whole numbers: positions lie on boundaries exactly, and
//! the small correction of (2.191), which is to bring them inside, is not needed. Where the tensor behind
//! a boundary leads straight back, the line follows the boundary. Image and field are constant on
//! pixels, so that a Gaussian along the line is integrated exactly (2.193).
//!
//! Cost: a segment reads one tensor and takes about 60 operations; a pixel of length has up to 1.5.

use crate::kernels::shared::stream::{acos, half_length};
use crate::kernels::shared::tensor::tangent;
use crate::kernels::simd::pixels::{fetch1, fetch4, offsets};
use isophote_engine::View;
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, mask32x8, prelude::*};

/// Distance to a boundary that is not met.
const FAR: f32 = 1e6;
/// Boundaries that are met within this distance are crossed at once.
const CORNER: f32 = 1e-4;

/// Eight lines, each traced in one direction.
#[derive(Clone, Copy)]
pub struct PixelLine<S: Simd> {
    /// Positions that the lines have come to, absolute: on the boundary of the pixel, or at its centre.
    position: [f32x8<S>; 2],
    /// Corners nearest to the origin of the pixels that the lines run through next: whole numbers.
    pixel: [f32x8<S>; 2],
    /// Directions of the last segments; the next one takes the sign that turns less.
    direction: [f32x8<S>; 2],
    /// Per axis, the direction in which the last boundary was crossed: -1, 0 or 1.
    entered: [f32x8<S>; 2],
    /// Cosine of the angle between the last two directions, 0..=1.
    pub turn: f32x8<S>,
    /// Distance to the next boundary across x and across y.
    exits: [f32x8<S>; 2],
}

/// More segments than any line of length `limit` has, unless it circles a point.
pub fn most_steps(limit: f32) -> i32 {
    (4.0 * limit) as i32 + 16
}

impl<S: Simd> PixelLine<S> {
    /// Lines from the centres (x, y) of pixels towards `direction`.
    #[inline(always)]
    pub fn begin(x: f32x8<S>, y: f32x8<S>, direction: [f32x8<S>; 2]) -> Self {
        let zero = f32x8::splat(x.simd, 0.0);
        Self {
            position: [x, y],
            pixel: [x.floor(), y.floor()],
            direction,
            entered: [zero; 2],
            turn: zero + 1.0,
            exits: [zero; 2],
        }
    }

    /// Columns and rows of the pixels that the lines run through.
    #[inline(always)]
    pub fn pixels(&self) -> [i32x8<S>; 2] {
        [self.pixel[0].to_int(), self.pixel[1].to_int()]
    }

    /// Finds the directions through the current pixels of `field`, which holds tensors or as much of them
    /// as orientation needs (2.188); returns the lengths of the segments (2.190).
    #[inline(always)]
    pub fn aim(&mut self, simd: S, field: &View<'_>) -> f32x8<S> {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let [x, y] = self.pixels();
        let [tx, ty] = orientation(simd, field, x, y);
        let along = self.direction[0] * tx + self.direction[1] * ty;
        let flip = along.simd_lt(zero);
        let (tx, ty) = (flip.select(-tx, tx), flip.select(-ty, ty));
        let back_x = (self.entered[0] * tx).simd_lt(zero);
        let back_y = !back_x & (self.entered[1] * ty).simd_lt(zero);
        let unit = [one.copysign(tx), one.copysign(ty)];
        let tx = back_x.select(zero, back_y.select(unit[0], tx));
        let ty = back_y.select(zero, back_x.select(unit[1], ty));
        self.turn = along.abs().at_most(one);
        self.direction = [tx, ty];
        let exits = self.boundary();
        for axis in 0..2 {
            let t = self.direction[axis];
            let moves = t.abs().simd_gt(1e-6);
            let exit = ((exits[axis] - self.position[axis]) / moves.select(t, one)).at_least(zero);
            self.exits[axis] = moves.select(exit, f32x8::splat(simd, FAR));
        }
        self.exits[0].at_most(self.exits[1])
    }

    /// Coordinates of the boundaries that lie ahead.
    #[inline(always)]
    fn boundary(&self) -> [f32x8<S>; 2] {
        let (zero, one) = (f32x8::splat(self.turn.simd, 0.0), f32x8::splat(self.turn.simd, 1.0));
        [
            self.pixel[0] + self.direction[0].simd_gt(zero).select(one, zero),
            self.pixel[1] + self.direction[1].simd_gt(zero).select(one, zero),
        ]
    }

    /// Leads the `active` lanes to the next pixels, `h` away. Returns those whose pixel lies inside the
    /// picture of `field`; the others stay where they are.
    #[inline(always)]
    pub fn cross(&mut self, field: &View<'_>, h: f32x8<S>, active: mask32x8<S>) -> mask32x8<S> {
        let (zero, one) = (f32x8::splat(h.simd, 0.0), f32x8::splat(h.simd, 1.0));
        let boundary = self.boundary();
        let (mut pixel, mut position, mut entered) = (self.pixel, self.position, self.entered);
        let mut inside = active;
        for axis in 0..2 {
            let t = self.direction[axis];
            let crossed = self.exits[axis].simd_le(h + CORNER);
            entered[axis] = crossed.select(t.simd_gt(zero).select(one, -one), zero);
            position[axis] = crossed.select(boundary[axis], h.mul_add(t, position[axis]));
            pixel[axis] += entered[axis];
            let full = f32x8::splat(h.simd, field.full()[axis] as f32);
            inside &= pixel[axis].simd_ge(zero) & pixel[axis].simd_lt(full);
        }
        for axis in 0..2 {
            self.pixel[axis] = inside.select(pixel[axis], self.pixel[axis]);
            self.position[axis] = inside.select(position[axis], self.position[axis]);
            self.entered[axis] = inside.select(entered[axis], self.entered[axis]);
        }
        inside
    }
}

/// Lines with a Gaussian over their arc length, which is integrated over each segment (2.193).
#[derive(Clone, Copy)]
pub struct GaussianLines<S: Simd> {
    /// Standard deviation, pixels.
    pub sigma: f32x8<S>,
    /// Length of each side.
    pub limit: f32x8<S>,
    /// Most segments of a side.
    pub most_steps: i32,
    /// A side ends at a boundary where it turns by more than the angle of this cosine.
    pub least_turn: f32,
    /// The arc length runs faster where lines turn (§ 6.3.2).
    pub turns_count: bool,
}

impl<S: Simd> GaussianLines<S> {
    /// Lines of the same length L = floor(2 sigma) wherever they turn.
    #[inline(always)]
    pub fn new(simd: S, sigma: f32) -> Self {
        let limit = half_length(sigma);
        Self {
            sigma: f32x8::splat(simd, sigma),
            limit: f32x8::splat(simd, limit),
            most_steps: most_steps(limit),
            least_turn: -1.0,
            turns_count: false,
        }
    }

    /// Follows one side of the lines through the centres (x, y) of pixels, towards `direction`: `visit` is called
    /// with the columns and rows of the pixels that they run through, and the weights of these.
    #[inline(always)]
    pub fn trace(
        &self,
        simd: S,
        field: &View<'_>,
        [x, y]: [f32x8<S>; 2],
        direction: [f32x8<S>; 2],
        mut visit: impl FnMut([i32x8<S>; 2], f32x8<S>),
    ) {
        let zero = f32x8::splat(simd, 0.0);
        // 1 / (sigma sqrt 2).
        let inverse = f32x8::splat(simd, std::f32::consts::FRAC_1_SQRT_2) / self.sigma.at_least(1e-3);
        let mut line = PixelLine::begin(x, y, direction);
        let (mut u, mut passed) = (zero, zero);
        let mut active = u.simd_lt(self.limit);
        for _ in 0..self.most_steps {
            if !active.any_true() {
                break;
            }
            let h = line.aim(simd, field);
            active &= line.turn.simd_ge(self.least_turn);
            if self.turns_count {
                // What the turn adds to the arc length lies between two segments.
                u += (acos(line.turn) * self.limit / std::f32::consts::PI - h).at_least(zero);
                passed = error_function(u * inverse);
            }
            let end = (u + h).at_most(self.limit);
            let reached = error_function(end * inverse);
            visit(line.pixels(), active.select((reached - passed).at_least(zero), zero));
            (u, passed) = (end, reached);
            active &= u.simd_lt(self.limit);
            active = line.cross(field, h, active);
        }
    }
}

/// Unit minor eigenvectors of pixels, of either sign.
#[inline(always)]
fn orientation<S: Simd>(simd: S, field: &View<'_>, x: i32x8<S>, y: i32x8<S>) -> [f32x8<S>; 2] {
    let at = offsets(field, x, y);
    if field.channels() == 2 {
        let difference = fetch1(simd, field, at);
        let f = fetch1(simd, field, at + i32x8::splat(simd, 1));
        return tangent(difference, f, f32x8::splat(simd, 0.0));
    }
    let [e, f, g, _] = fetch4(simd, field, at);
    tangent(e, f, g)
}

/// The error function of x >= 0, error below 2e-6 (Abramowitz and Stegun 7.1.28).
#[inline(always)]
fn error_function<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    let c = |v: f32| f32x8::splat(x.simd, v);
    let p = x.mul_add(c(0.000_043_063_8), c(0.000_276_567_2));
    let p = p.mul_add(x, c(0.000_152_014_3));
    let p = p.mul_add(x, c(0.009_270_527_2));
    let p = p.mul_add(x, c(0.042_282_012_3));
    let p = p.mul_add(x, c(0.070_523_078_4));
    let p = p.mul_add(x, c(1.0));
    let p2 = p * p;
    let p4 = p2 * p2;
    let p8 = p4 * p4;
    c(1.0) - c(1.0) / (p8 * p8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::Image;
    use isophote_engine::fearless_simd::{Level, dispatch};

    /// A field of one tensor everywhere but where `special` says otherwise.
    fn field(side: u32, tensor: impl Fn(u32, u32) -> [f32; 2]) -> Image {
        let mut image = Image::new(side, side, 4).unwrap();
        for (i, t) in image.data_mut().chunks_exact_mut(4).enumerate() {
            let [tx, ty] = tensor(i as u32 % side, i as u32 / side);
            // The gradient is across the tangent.
            t.copy_from_slice(&[ty * ty, -tx * ty, tx * tx, 1.0]);
        }
        image
    }

    /// Pixels and lengths of the segments of a line from the middle of a field.
    fn trace(image: &Image, start: [f32; 2], direction: [f32; 2], limit: f32) -> Vec<([i32; 2], f32)> {
        let view = View::new(image, [image.width() as i32, image.height() as i32]);
        dispatch!(Level::new(), simd => {
            let splat = |v: f32| f32x8::splat(simd, v);
            let (x, y) = (splat(start[0]), splat(start[1]));
            let mut line = PixelLine::begin(x, y, [splat(direction[0]), splat(direction[1])]);
            let (mut u, mut all) = (0.0, Vec::new());
            for _ in 0..most_steps(limit) {
                let h = line.aim(simd, &view);
                let [px, py] = line.pixels();
                let length = h[0].min(limit - u);
                all.push(([px[0], py[0]], length));
                u += length;
                if u >= limit || !line.cross(&view, h, mask32x8::splat(simd, true)).any_true() {
                    break;
                }
            }
            all
        })
    }

    #[test]
    fn a_straight_line_takes_every_pixel_in_turn() {
        let (sin, cos) = 0.3f32.sin_cos();
        let image = field(64, |_, _| [cos, sin]);
        let segments = trace(&image, [20.5, 20.5], [1.0, 0.0], 30.0);
        let total: f32 = segments.iter().map(|s| s.1).sum();
        assert!((total - 30.0).abs() < 1e-4);
        let mut u = 0.0;
        for (pixel, length) in &segments {
            // The middle of the segment lies in the pixel.
            let at = [20.5 + cos * (u + 0.5 * length), 20.5 + sin * (u + 0.5 * length)];
            assert_eq!(*pixel, [at[0].floor() as i32, at[1].floor() as i32], "at {u}");
            u += length;
        }
    }

    #[test]
    fn corners_are_crossed_at_once() {
        let diagonal = std::f32::consts::FRAC_1_SQRT_2;
        let image = field(32, |_, _| [diagonal, diagonal]);
        let segments = trace(&image, [4.5, 4.5], [1.0, 0.0], 10.0);
        let pixels: Vec<_> = segments.iter().map(|s| s.0).collect();
        assert!(pixels.windows(2).all(|p| p[1] == [p[0][0] + 1, p[0][1] + 1]), "{pixels:?}");
    }

    #[test]
    fn opposing_pixels_lead_along_their_boundary() {
        // Left of column 10 lines run to the right and down, from there on to the left and down.
        let image = field(32, |x, _| if x < 10 { [0.6, 0.8] } else { [-0.6, 0.8] });
        let segments = trace(&image, [9.5, 4.5], [0.6, 0.8], 12.0);
        let total: f32 = segments.iter().map(|s| s.1).sum();
        assert!((total - 12.0).abs() < 1e-4, "the line does not get stuck: {segments:?}");
        assert!(segments.iter().all(|s| s.0[0] == 9 || s.0[0] == 10));
        assert!(segments.last().unwrap().0[1] >= 15);
    }

    #[test]
    fn the_error_function_meets_its_bound() {
        // Maclaurin series in double precision.
        let exact = |x: f64| {
            let (mut term, mut sum) = (x, x);
            for n in 1..80 {
                term *= -x * x / f64::from(n);
                sum += term / f64::from(2 * n + 1);
            }
            sum * 2.0 / std::f64::consts::PI.sqrt()
        };
        dispatch!(Level::new(), simd => {
            for i in 0..64 {
                let x = f32x8::from_fn(simd, |lane| (8 * i + lane) as f32 / 200.0);
                let got = error_function(x);
                for lane in 0..8 {
                    assert!((f64::from(got[lane]) - exact(f64::from(x[lane]))).abs() < 2e-6);
                }
            }
        });
    }
}
