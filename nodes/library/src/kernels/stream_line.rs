//! Stream lines of the minor eigenvectors of a tensor field (§ 2.9, Listing 2.6), eight at a time; the
//! twin of `shaders/shared/stream.wgsl`.
//!
//! Tensors are interpolated, never eigenvectors: those are defined up to sign, and opposite ones would
//! cancel. A line is traced from its centre in one direction and then in the other. Lanes whose line
//! has ended stay where they are while the others go on.
//!
//! Cost: a step samples one tensor (Euler) or two (second order), bilinearly, and finds their axes;
//! the first step saves one.

use crate::kernels::tensor_algebra::{tangent, tangent_along};
use isophote_engine::fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use isophote_engine::math::{InnerPlace, sample_inner2, sample_linear2, sample_linear4};
use isophote_engine::{Rect, View};

/// A tensor field and how its stream lines are stepped.
///
/// As long as steps are only taken up to an arc length of `radius`, every tensor is read within
/// floor(radius) + 1 pixels of the centre in x and in y.
#[derive(Clone, Copy, Debug)]
pub struct StreamField<'a> {
    /// Tensors (E, F, G, w), or as much of them as orientation needs, (E - G, F).
    pub tensors: View<'a>,
    /// Step size h in pixels.
    pub step: f32,
    /// True for the second-order Runge-Kutta method (2.182), false for Euler's (2.176, 2.177).
    pub midpoint: bool,
}

/// Eight lines, each traced in one direction.
#[derive(Clone, Copy)]
pub struct Stream<S: Simd> {
    /// Where the lines have come to, absolute.
    pub x: f32x8<S>,
    /// Where the lines have come to, absolute.
    pub y: f32x8<S>,
    /// Unit vectors of the last step; the next one takes the sign that turns less.
    pub direction: [f32x8<S>; 2],
    /// Cosine of the angle between the last two steps, 0..=1 up to rounding.
    pub turn: f32x8<S>,
    begins: bool,
}

impl<S: Simd> Stream<S> {
    /// Lines that start at (x, y) towards the unit vector `direction`, which is the tangent there or
    /// its opposite.
    #[inline(always)]
    pub fn begin(x: f32x8<S>, y: f32x8<S>, direction: [f32x8<S>; 2]) -> Self {
        Self { x, y, direction, turn: f32x8::splat(x.simd, 1.0), begins: true }
    }

    /// Both sides of lines through (x, y), where the tangent is `tangent`.
    #[inline(always)]
    pub fn both_sides(x: f32x8<S>, y: f32x8<S>, [tx, ty]: [f32x8<S>; 2]) -> [Self; 2] {
        [Self::begin(x, y, [-tx, -ty]), Self::begin(x, y, [tx, ty])]
    }

    /// Half a step of Euler's method, where the field is `here`.
    #[inline(always)]
    fn halfway(&self, here: [f32x8<S>; 2], h: f32x8<S>) -> [f32x8<S>; 2] {
        // The first direction is the tangent already.
        let [kx, ky] =
            if self.begins { self.direction } else { tangent_along(here[0], here[1], self.direction).0 };
        let half = h * 0.5;
        [half.mul_add(kx, self.x), half.mul_add(ky, self.y)]
    }

    /// A step of length `h` along the tangent of the field.
    #[inline(always)]
    fn follow(&mut self, [difference, f]: [f32x8<S>; 2], h: f32x8<S>) {
        let ([tx, ty], turn) = tangent_along(difference, f, self.direction);
        self.direction = [tx, ty];
        self.turn = turn;
        self.straight(h);
    }

    /// A step of length `h` in the direction of the last one.
    #[inline(always)]
    fn straight(&mut self, h: f32x8<S>) {
        self.x = h.mul_add(self.direction[0], self.x);
        self.y = h.mul_add(self.direction[1], self.y);
        self.begins = false;
    }
}

impl StreamField<'_> {
    /// Unit minor eigenvectors at (x, y), of either sign.
    #[inline(always)]
    pub fn tangent<S: Simd>(&self, simd: S, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 2] {
        if self.tensors.channels() == 2 {
            let [difference, f] = sample_linear2(simd, &self.tensors, x, y);
            return tangent(difference, f, f32x8::splat(simd, 0.0));
        }
        let [e, f, g, _] = sample_linear4(simd, &self.tensors, x, y);
        tangent(e, f, g)
    }

    /// (E - G, F) at (x, y), which is all that orientation needs.
    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 2] {
        if self.tensors.channels() == 2 {
            return sample_linear2(simd, &self.tensors, x, y);
        }
        let [e, f, g, _] = sample_linear4(simd, &self.tensors, x, y);
        [e - g, f]
    }

    /// Moves the `active` lanes by one step.
    #[inline(always)]
    pub fn advance<S: Simd>(&self, simd: S, line: &mut Stream<S>, active: mask32x8<S>) {
        let h = self.steps(simd, active);
        let begins = line.begins;
        let mut field = [h; 2];
        if !begins {
            field = self.at(simd, line.x, line.y);
        }
        if self.midpoint {
            let [x, y] = line.halfway(field, h);
            line.follow(self.at(simd, x, y), h);
        } else if begins {
            line.straight(h);
        } else {
            line.follow(field, h);
        }
    }

    /// Moves both sides of eight lines by one step.
    ///
    /// A step is a long chain of operations that wait for each other; two independent ones, side by
    /// side, take little longer than one.
    #[inline(always)]
    pub fn advance_both<S: Simd>(&self, simd: S, lines: &mut [Stream<S>; 2], active: [mask32x8<S>; 2]) {
        let h = [self.steps(simd, active[0]), self.steps(simd, active[1])];
        let begins = lines[0].begins;
        let mut field = [h; 2];
        if !begins {
            field = [self.at(simd, lines[0].x, lines[0].y), self.at(simd, lines[1].x, lines[1].y)];
        }
        if self.midpoint {
            let [x0, y0] = lines[0].halfway(field[0], h[0]);
            let [x1, y1] = lines[1].halfway(field[1], h[1]);
            field = [self.at(simd, x0, y0), self.at(simd, x1, y1)];
        } else if begins {
            lines[0].straight(h[0]);
            lines[1].straight(h[1]);
            return;
        }
        lines[0].follow(field[0], h[0]);
        lines[1].follow(field[1], h[1]);
    }

    /// Moves all lanes of `N` times eight lines by one step, from places where the field is `here`; what
    /// is there does not matter for the first step.
    ///
    /// The lines are inner ones, which stay off the picture's edges, and the field is (E - G, F). The
    /// arithmetic is that of [`StreamField::advance_both`] without what the edges ask for; whoever takes
    /// samples at the new positions asks for the field there with [`StreamField::at_inner`] as well,
    /// so that both share the place and the wait.
    #[inline(always)]
    pub fn advance_inner<S: Simd, const N: usize>(
        &self,
        simd: S,
        lines: &mut [Stream<S>; N],
        here: &[[f32x8<S>; 2]; N],
    ) {
        let h = f32x8::splat(simd, self.step);
        let begins = lines[0].begins;
        if self.midpoint {
            // In stages: what waits in one line is filled by the same of the others.
            let mut middle = *here;
            for i in 0..N {
                middle[i] = lines[i].halfway(here[i], h);
            }
            for i in 0..N {
                middle[i] = self.at_inner(simd, &InnerPlace::new(middle[i][0], middle[i][1]));
            }
            for i in 0..N {
                lines[i].follow(middle[i], h);
            }
        } else {
            for i in 0..N {
                if begins {
                    lines[i].straight(h);
                } else {
                    lines[i].follow(here[i], h);
                }
            }
        }
    }

    /// (E - G, F) at an inner place of a field of these two.
    #[inline(always)]
    pub fn at_inner<S: Simd>(&self, simd: S, place: &InnerPlace<S>) -> [f32x8<S>; 2] {
        sample_inner2(simd, &self.tensors, place)
    }

    /// True when lines of length `radius` through `len` pixels from (x, y) on stay off the edges.
    #[inline(always)]
    pub fn is_inner(&self, x: i32, y: i32, len: i32, radius: i32) -> bool {
        let inner = self.inner(radius);
        x >= inner.x0 && y >= inner.y0 && x + len <= inner.x1 && y < inner.y1
    }

    /// The pixels through which lines of length `radius` stay off the edges; empty (x1 below x0) when there
    /// are none, or when the field holds more than (E - G, F).
    #[inline(always)]
    pub fn inner(&self, radius: i32) -> Rect {
        let ([w, h], margin) = (self.tensors.full(), radius + 2);
        if self.tensors.channels() != 2 {
            return Rect { x0: 0, y0: 0, x1: 0, y1: 0 };
        }
        Rect { x0: margin, y0: margin, x1: w - margin, y1: h - margin }
    }

    #[inline(always)]
    fn steps<S: Simd>(&self, simd: S, active: mask32x8<S>) -> f32x8<S> {
        active.select(f32x8::splat(simd, self.step), f32x8::splat(simd, 0.0))
    }

    /// Lanes whose line lies inside the picture.
    #[inline(always)]
    pub fn inside<S: Simd>(&self, simd: S, line: &Stream<S>) -> mask32x8<S> {
        self.holds(simd, line.x, line.y)
    }

    /// Lanes whose position lies inside the picture.
    #[inline(always)]
    pub fn holds<S: Simd>(&self, simd: S, x: f32x8<S>, y: f32x8<S>) -> mask32x8<S> {
        let [w, h] = self.tensors.full();
        let (w, h) = (f32x8::splat(simd, w as f32), f32x8::splat(simd, h as f32));
        let zero = f32x8::splat(simd, 0.0);
        x.simd_ge(zero) & x.simd_lt(w) & y.simd_ge(zero) & y.simd_lt(h)
    }
}

/// Centres of the eight pixels from column `x` of row `y` on. Columns past `last`, the last one to be
/// computed, repeat it, so that a short block reads nothing that was not promised.
#[inline(always)]
pub fn centres<S: Simd>(simd: S, x: i32, y: i32, last: i32) -> [f32x8<S>; 2] {
    let columns = f32x8::from_fn(simd, |lane| (x + lane as i32).min(last) as f32 + 0.5);
    [columns, f32x8::splat(simd, y as f32 + 0.5)]
}

/// Angle of a cosine in 0..=1, error below 7e-5 (Abramowitz and Stegun 4.4.45).
#[inline(always)]
pub fn acos<S: Simd>(cosine: f32x8<S>) -> f32x8<S> {
    let x = cosine.min(f32x8::splat(cosine.simd, 1.0));
    let p = f32x8::splat(cosine.simd, -0.018_729_3).mul_add(x, f32x8::splat(cosine.simd, 0.074_261_0));
    let p = p.mul_add(x, f32x8::splat(cosine.simd, -0.212_114_4));
    let p = p.mul_add(x, f32x8::splat(cosine.simd, 1.570_728_8));
    (f32x8::splat(cosine.simd, 1.0) - x).sqrt() * p
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::Image;
    use isophote_engine::fearless_simd::{Level, dispatch};

    const SIDE: u32 = 96;

    /// Tensors whose tangents run around the picture's middle.
    fn circles() -> Image {
        let middle = SIDE as f32 / 2.0;
        let mut image = Image::new(SIDE, SIDE, 4).unwrap();
        for (i, t) in image.data_mut().chunks_exact_mut(4).enumerate() {
            let x = (i as u32 % SIDE) as f32 + 0.5 - middle;
            let y = (i as u32 / SIDE) as f32 + 0.5 - middle;
            t.copy_from_slice(&[x * x, x * y, y * y, 1.0]);
        }
        image
    }

    /// By how much lines of `steps` steps leave their circles, summed over eight radii.
    fn drift(midpoint: bool, steps: usize) -> f32 {
        let image = circles();
        let tensors = View::new(&image, [SIDE as i32; 2]);
        let field = StreamField { tensors, step: 1.0, midpoint };
        let middle = SIDE as f32 / 2.0;
        dispatch!(Level::new(), simd => {
            let start = f32x8::from_fn(simd, |lane| 10.0 + 3.0 * lane as f32);
            let (x, y) = (start + middle, f32x8::splat(simd, middle));
            let mut line = Stream::begin(x, y, field.tangent(simd, x, y));
            for _ in 0..steps {
                field.advance(simd, &mut line, mask32x8::splat(simd, true));
            }
            let (x, y) = (line.x - middle, line.y - middle);
            let off = (x * x + y * y).sqrt() - start;
            off.to_array().iter().sum()
        })
    }

    #[test]
    fn euler_drifts_outwards_and_the_midpoint_method_ten_times_less() {
        let (euler, midpoint) = (drift(false, 30), drift(true, 30));
        assert!(euler > 2.0, "Euler drifts by {euler}");
        assert!(midpoint.abs() * 10.0 < euler, "the midpoint method drifts by {midpoint}, Euler by {euler}");
    }

    #[test]
    fn ended_lanes_stay_where_they_are() {
        let image = circles();
        let field = StreamField { tensors: View::new(&image, [SIDE as i32; 2]), step: 1.0, midpoint: true };
        dispatch!(Level::new(), simd => {
            let at = centres(simd, 40, 9, 90);
            let mut line = Stream::begin(at[0], at[1], field.tangent(simd, at[0], at[1]));
            let active = line.x.simd_lt(f32x8::splat(simd, 44.0));
            for _ in 0..3 {
                field.advance(simd, &mut line, active);
            }
            let moved = ((line.x - at[0]) * (line.x - at[0]) + (line.y - at[1]) * (line.y - at[1])).sqrt();
            assert!(moved.to_array()[..4].iter().all(|m| (2.8..=3.0001).contains(m)));
            assert_eq!(moved.to_array()[4..], [0.0; 4]);
        });
    }

    #[test]
    fn the_angle_of_a_cosine_is_close() {
        dispatch!(Level::new(), simd => {
            for i in 0..=125 {
                let x = f32x8::from_fn(simd, |lane| (i * 8 + lane) as f32 / 1007.0);
                let got = acos(x);
                for lane in 0..8 {
                    assert!((got[lane] - x[lane].min(1.0).acos()).abs() < 7e-5);
                }
            }
        });
    }
}
