//! Stream lines of the minor eigenvectors of a tensor field (§ 2.9, Listing 2.6), eight at a time; the
//! twin of `shaders/shared/stream.wgsl`.
//!
//! Tensors are interpolated, never eigenvectors: those are defined up to sign, and opposite ones would
//! cancel. A line is traced from its centre in one direction and then in the other. Lanes whose line
//! has ended stay where they are while the others go on.
//!
//! [`trace`](crate::kernels::trace) follows them.
//!
//! Cost: a step samples one tensor (Euler, two-step) or two (midpoint), bilinearly, and finds their axes; the
//! first step of Euler's method and of the midpoint method saves one.

use crate::kernels::shared::sampling::{sample_linear2, sample_linear4};
use crate::kernels::shared::tensor::{tangent, tangent_along};
use isophote_engine::View;
use isophote_engine::fearless_simd::{Simd, f32x8, mask32x8, prelude::*};

crate::declare::choice::numbered! {
    /// Step of a stream line to its next point.
    pub enum Integrator {
        /// Euler's method, first order (2.176, 2.177).
        Euler = 0,
        /// The midpoint method, a second-order Runge-Kutta method (2.182).
        Midpoint = 1,
        /// The midpoint method with the tangent here extrapolated from those halfway through the last two steps:
        /// only where the next one is taken depends on it, so that the method is of second order too, with one
        /// sample of the field a step instead of two. Its first step is the midpoint method's.
        TwoStep = 2,
    }
}

impl Integrator {
    /// True where a step depends on the field where it starts; the tangent at a line's beginning is known.
    #[inline(always)]
    fn reads_start(self, begins: bool) -> bool {
        !begins && self != Self::TwoStep
    }
}

/// Factor by which [`few_steps`] may stretch the steps of lines where somebody asks for it.
pub const STRETCH: f32 = 2.5;

/// Lines of no more steps to a side keep theirs.
pub const FEW_STEPS: f32 = 3.0;

/// The number of steps, stretched by up to `stretch`, that take the place of `steps` steps to one side of a
/// line; no fewer for `stretch` 1.
///
/// A line of n steps of length h to both sides stands for 2n + 1 rectangles of width h (2.187): as many as there
/// are now fill the same length, and steps are longer by [`stretched`]. That is faster and smooths less: on photographs
/// the coherence-enhancing filter comes 3 to 4 dB less near to steps of a quarter of a pixel than in steps of one, and
/// noise keeps a quarter more of its deviation. So it is a choice, never the default of a node.
#[inline(always)]
pub fn few_steps<S: Simd>(steps: f32x8<S>, stretch: f32) -> f32x8<S> {
    // A last bit must not add a step.
    (steps * stretch.recip() - 1e-3).ceil().at_least(steps.at_most(f32x8::splat(steps.simd, FEW_STEPS)))
}

/// By how much steps are longer when `few` of them take the place of `steps`.
#[inline(always)]
pub fn stretched<S: Simd>(steps: f32x8<S>, few: f32x8<S>) -> f32x8<S> {
    (steps + steps + 1.0) / (few + few + 1.0)
}

/// L = floor(2 sigma), the length of a side of a line whose weights are a Gaussian (§ 2.9.3); a last bit must not
/// decide whether a whole number is reached.
pub fn half_length(sigma: f32) -> f32 {
    (2.0 * sigma + 1e-3).floor()
}

/// An orientation field, as stream lines read it.
pub trait Field<S: Simd> {
    /// Eight positions, ready for reading there.
    type Place: Copy;

    /// The places of the absolute positions (x, y).
    fn place(&self, x: f32x8<S>, y: f32x8<S>) -> Self::Place;

    /// (E - G, F) at a place, which is all that orientation needs.
    fn at(&self, simd: S, place: &Self::Place) -> [f32x8<S>; 2];

    /// Lanes whose line lies inside the picture; all of them where none can have left it.
    fn inside(&self, line: &Stream<S>) -> mask32x8<S>;

    /// The lengths of the next steps, of which only the `active` lanes count.
    fn lengths(&self, length: f32x8<S>, active: mask32x8<S>) -> f32x8<S>;
}

/// A field that is read in the picture itself.
///
/// As long as steps are only taken up to an arc length of `radius`, every tensor is read within
/// floor(radius) + 1 pixels of the centre in x and in y.
#[derive(Clone, Copy, Debug)]
pub struct FieldView<'a> {
    /// Tensors (E, F, G, w), or as much of them as orientation needs, (E - G, F).
    pub tensors: View<'a>,
    /// Takes the tensor of the nearest pixel instead of interpolating between four.
    pub nearest: bool,
}

impl<'a> FieldView<'a> {
    /// A field that is interpolated.
    pub fn new(tensors: View<'a>) -> Self {
        Self { tensors, nearest: false }
    }

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
}

impl<S: Simd> Field<S> for FieldView<'_> {
    type Place = [f32x8<S>; 2];

    #[inline(always)]
    fn place(&self, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 2] {
        [x, y]
    }

    #[inline(always)]
    fn at(&self, simd: S, place: &[f32x8<S>; 2]) -> [f32x8<S>; 2] {
        // At the centre of a pixel nothing is interpolated.
        let [x, y] = if self.nearest { [place[0].floor() + 0.5, place[1].floor() + 0.5] } else { *place };
        if self.tensors.channels() == 2 {
            return sample_linear2(simd, &self.tensors, x, y);
        }
        let [e, f, g, _] = sample_linear4(simd, &self.tensors, x, y);
        [e - g, f]
    }

    #[inline(always)]
    fn inside(&self, line: &Stream<S>) -> mask32x8<S> {
        in_bounds(self.tensors.full(), line.x, line.y)
    }

    /// Lines that have ended stay: what lies beyond their ends may not be there to be read.
    #[inline(always)]
    fn lengths(&self, length: f32x8<S>, active: mask32x8<S>) -> f32x8<S> {
        active.select(length, f32x8::splat(length.simd, 0.0))
    }
}

/// Eight lines, each traced in one direction.
#[derive(Clone, Copy)]
pub struct Stream<S: Simd> {
    /// Columns that the lines have come to, absolute.
    pub x: f32x8<S>,
    /// Rows that the lines have come to, absolute.
    pub y: f32x8<S>,
    /// Unit vectors of the last step; the next one takes the sign that turns less.
    pub direction: [f32x8<S>; 2],
    /// Cosine of the angle between the last two steps, 0..=1 up to rounding.
    pub turn: f32x8<S>,
    /// The tangent at the end of the last step, extrapolated by the two-step method.
    ahead: [f32x8<S>; 2],
    begins: bool,
}

impl<S: Simd> Stream<S> {
    /// Lines that start at (x, y) towards the unit vector `direction`, which is the tangent there or
    /// its opposite.
    #[inline(always)]
    pub fn begin(x: f32x8<S>, y: f32x8<S>, direction: [f32x8<S>; 2]) -> Self {
        Self { x, y, direction, turn: f32x8::splat(x.simd, 1.0), ahead: direction, begins: true }
    }

    /// Half a step of length `h` in the direction (kx, ky).
    #[inline(always)]
    fn halfway(&self, [kx, ky]: [f32x8<S>; 2], h: f32x8<S>) -> [f32x8<S>; 2] {
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

    /// Extrapolates the tangent to the end of a step before which `last` was the direction: the tangent of the
    /// beginning for the first step, and of halfway through the step before for others.
    #[inline(always)]
    fn extrapolate(&mut self, last: [f32x8<S>; 2], first: bool) {
        let share = if first { 1.0 } else { 0.5 };
        let [x, y] = self.direction;
        self.ahead = [(x - last[0]).mul_add(share, x), (y - last[1]).mul_add(share, y)];
    }

    /// A step of length `h` in the direction of the last one.
    #[inline(always)]
    fn straight(&mut self, h: f32x8<S>) {
        self.x = h.mul_add(self.direction[0], self.x);
        self.y = h.mul_add(self.direction[1], self.y);
        self.begins = false;
    }
}

/// Moves `N` times eight lines, which are at `places`, by one step of length `h`.
///
/// A step is a long chain of operations that wait for each other; independent ones, side by side, take little
/// longer than one. So it goes in stages, and in loops short enough to be unrolled.
#[inline(always)]
pub fn step<S: Simd, F: Field<S>, const N: usize>(
    simd: S,
    field: &F,
    integrator: Integrator,
    lines: &mut [Stream<S>; N],
    places: &[F::Place; N],
    h: [f32x8<S>; N],
) {
    let begins = lines[0].begins;
    let mut read = [[h[0]; 2]; N];
    if integrator.reads_start(begins) {
        for i in 0..N {
            read[i] = field.at(simd, &places[i]);
        }
    }
    if integrator != Integrator::Euler {
        let mut tangents = [[h[0]; 2]; N];
        if integrator.reads_start(begins) {
            for i in 0..N {
                tangents[i] = tangent_along(read[i][0], read[i][1], lines[i].direction).0;
            }
        } else {
            for i in 0..N {
                tangents[i] = lines[i].ahead;
            }
        }
        for i in 0..N {
            read[i] = lines[i].halfway(tangents[i], h[i]);
        }
        for i in 0..N {
            read[i] = field.at(simd, &field.place(read[i][0], read[i][1]));
        }
    }
    if begins && integrator == Integrator::Euler {
        for i in 0..N {
            lines[i].straight(h[i]);
        }
    } else if integrator == Integrator::TwoStep {
        for i in 0..N {
            let last = lines[i].direction;
            lines[i].follow(read[i], h[i]);
            lines[i].extrapolate(last, begins);
        }
    } else {
        for i in 0..N {
            lines[i].follow(read[i], h[i]);
        }
    }
}

/// Lanes whose position lies inside a picture of so many pixels.
#[inline(always)]
pub fn in_bounds<S: Simd>([w, h]: [i32; 2], x: f32x8<S>, y: f32x8<S>) -> mask32x8<S> {
    let simd = x.simd;
    let (w, h) = (f32x8::splat(simd, w as f32), f32x8::splat(simd, h as f32));
    let zero = f32x8::splat(simd, 0.0);
    x.simd_ge(zero) & x.simd_lt(w) & y.simd_ge(zero) & y.simd_lt(h)
}

/// Angle of a cosine in 0..=1, error below 7e-5 (Abramowitz and Stegun 4.4.45).
#[inline(always)]
pub fn acos<S: Simd>(cosine: f32x8<S>) -> f32x8<S> {
    let x = cosine.at_most(f32x8::splat(cosine.simd, 1.0));
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
    fn drift(integrator: Integrator, steps: usize) -> f32 {
        let image = circles();
        let field = FieldView::new(View::new(&image, [SIDE as i32; 2]));
        let middle = SIDE as f32 / 2.0;
        dispatch!(Level::new(), simd => {
            let start = f32x8::from_fn(simd, |lane| 10.0 + 3.0 * lane as f32);
            let (x, y) = (start + middle, f32x8::splat(simd, middle));
            let mut line = [Stream::begin(x, y, field.tangent(simd, x, y))];
            for _ in 0..steps {
                let place = [[line[0].x, line[0].y]];
                step(simd, &field, integrator, &mut line, &place, [f32x8::splat(simd, 1.0)]);
            }
            let (x, y) = (line[0].x - middle, line[0].y - middle);
            let off = (x * x + y * y).sqrt() - start;
            off.to_array().iter().sum()
        })
    }

    #[test]
    fn euler_drifts_outwards_and_methods_of_second_order_ten_times_less() {
        let [euler, midpoint, two_step] =
            [Integrator::Euler, Integrator::Midpoint, Integrator::TwoStep].map(|i| drift(i, 30));
        assert!(euler > 2.0, "Euler drifts by {euler}");
        for (method, drift) in [("midpoint", midpoint), ("two-step", two_step)] {
            assert!(drift.abs() * 10.0 < euler, "the {method} method drifts by {drift}, Euler by {euler}");
        }
    }

    #[test]
    fn few_stretched_steps_fill_the_length_of_many() {
        dispatch!(Level::new(), simd => {
            for steps in 0..200 {
                let all = f32x8::splat(simd, steps as f32);
                assert_eq!(few_steps(all, 1.0)[0], steps as f32, "unstretched");
                assert_eq!(stretched(all, all)[0], 1.0);
                let few = few_steps(all, STRETCH);
                let (n, h) = (few[0], stretched(all, few)[0]);
                assert!((1.0..=STRETCH).contains(&h), "{steps} steps become {n} that are {h} times as long");
                assert!(n * h <= steps as f32 + 1e-4, "{n} steps of {h} lead beyond {steps}");
                assert!(steps == 0 || (n + 1.0) * h > steps as f32 + 1e-2);
                assert!((steps <= 3) == (h == 1.0));
            }
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
