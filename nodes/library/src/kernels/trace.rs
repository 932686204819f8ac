//! Following stream lines from every pixel of a band: the loops that all kernels along lines share (§ 2.9.3).
//!
//! A kernel says where its lines begin, how long their steps are and what it does at each point; [`Lines`]
//! steps several lines side by side, ends those that leave the picture, and stops when none goes on.
//! [`along_lines`] runs a kernel over a band: tile by tile through copies of what lies around each tile, where
//! every position can be read without a comparison, or in the picture itself where lines reach too far for that.

pub mod tile_copy;

use crate::kernels::shared::coverage::Covered;
use crate::kernels::shared::stream::{Field, FieldView, Integrator, Stream, in_bounds, step};
use crate::kernels::simd::pixels::{BLOCK, Block, for_blocks_in_tiles, write};
use isophote_engine::dispatch::at_most_avx2;
use isophote_engine::fearless_simd::{Level, Simd, dispatch, f32x8, mask32x8, prelude::*};
use isophote_engine::{Band, View};
use tile_copy::{FOUR, Frame, Place, TWO, TileCopy};

/// `N` times eight lines on their way: both sides of each block's, one after the other.
pub struct Lines<S: Simd, F: Field<S>, const N: usize> {
    integrator: Integrator,
    streams: [Stream<S>; N],
    places: [F::Place; N],
    active: [mask32x8<S>; N],
}

/// A point of eight lines.
#[derive(Clone, Copy)]
pub struct Point<S: Simd, P> {
    /// Position, direction and turn.
    pub line: Stream<S>,
    /// The position, ready for reading.
    pub place: P,
    /// Lanes whose line has come here.
    pub active: mask32x8<S>,
}

/// Both sides of the lines through a block, where the tangent is `tangent`.
#[inline(always)]
pub fn both_sides<S: Simd>(simd: S, block: &Block, [tx, ty]: [f32x8<S>; 2]) -> [Stream<S>; 2] {
    let [x, y] = block.centres(simd);
    [Stream::begin(x, y, [-tx, -ty]), Stream::begin(x, y, [tx, ty])]
}

impl<S: Simd, F: Field<S>, const N: usize> Lines<S, F, N> {
    /// Lines that begin as `streams`.
    #[inline(always)]
    pub fn new(simd: S, field: &F, integrator: Integrator, streams: [Stream<S>; N]) -> Self {
        // No place counts before the first step: the tangent there is known.
        let places = [field.place(streams[0].x, streams[0].y); N];
        Self { integrator, streams, places, active: [mask32x8::splat(simd, true); N] }
    }

    /// The same with lanes that do not begin at all.
    #[inline(always)]
    pub fn only(mut self, active: [mask32x8<S>; N]) -> Self {
        self.active = active;
        self
    }

    /// True while some line goes on.
    #[inline(always)]
    pub fn go_on(&self) -> bool {
        let mut any = self.active[0];
        for i in 1..N {
            any |= self.active[i];
        }
        any.any_true()
    }

    /// Follows the lines for up to `steps` steps of `lengths` pixels. At step k, 0 the first, `visit` is called for line i of the
    /// `N` with (k, i, point), and says which lanes go on; those that left the picture have ended.
    #[inline(always)]
    pub fn trace(
        &mut self,
        simd: S,
        field: &F,
        lengths: [f32x8<S>; N],
        steps: usize,
        mut visit: impl FnMut(usize, usize, &Point<S, F::Place>) -> mask32x8<S>,
    ) {
        self.trace_beyond(
            simd,
            field,
            lengths,
            steps,
            #[inline(always)]
            |k, i, point| {
                let active = point.active & field.inside(&point.line);
                visit(k, i, &Point { active, ..*point })
            },
        );
    }

    /// [`trace`](Self::trace) for kernels that look elsewhere than at the points, and so decide themselves
    /// where a line ends.
    #[inline(always)]
    pub fn trace_beyond(
        &mut self,
        simd: S,
        field: &F,
        lengths: [f32x8<S>; N],
        steps: usize,
        mut visit: impl FnMut(usize, usize, &Point<S, F::Place>) -> mask32x8<S>,
    ) {
        for k in 0..steps {
            if !self.go_on() {
                break;
            }
            let mut h = lengths;
            for i in 0..N {
                h[i] = field.lengths(lengths[i], self.active[i]);
            }
            step(simd, field, self.integrator, &mut self.streams, &self.places, h);
            for i in 0..N {
                let line = self.streams[i];
                let place = field.place(line.x, line.y);
                self.places[i] = place;
                self.active[i] = visit(k, i, &Point { line, place, active: self.active[i] });
            }
        }
    }
}

/// A field that is read in a copy of what lies around a tile.
#[derive(Clone, Copy, Debug)]
pub struct FieldCopy<'a> {
    frame: &'a Frame,
    /// (E - G, F).
    tensors: &'a TileCopy<TWO>,
    /// Size of the picture, where lines can leave it.
    edges: Option<[i32; 2]>,
}

impl<S: Simd> Field<S> for FieldCopy<'_> {
    type Place = Place<S>;

    #[inline(always)]
    fn place(&self, x: f32x8<S>, y: f32x8<S>) -> Place<S> {
        Place::new(self.frame, x, y)
    }

    #[inline(always)]
    fn at(&self, simd: S, place: &Place<S>) -> [f32x8<S>; 2] {
        self.tensors.sample(simd, place)
    }

    #[inline(always)]
    fn inside(&self, line: &Stream<S>) -> mask32x8<S> {
        match self.edges {
            Some(full) => in_bounds(full, line.x, line.y),
            None => mask32x8::splat(line.x.simd, true),
        }
    }

    /// Lines that have ended may go on: every place can be read, and what they come to does not count.
    #[inline(always)]
    fn lengths(&self, length: f32x8<S>, _: mask32x8<S>) -> f32x8<S> {
        length
    }
}

/// Images that [`along_lines`] follows lines through.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    /// Image that is looked at along the lines, two or four channels; colours count by their alpha.
    pub source: View<'a>,
    /// (E - G, F).
    pub field: View<'a>,
    /// Integrator by which lines are stepped.
    pub integrator: Integrator,
    /// Takes the tensors of the nearest pixels instead of interpolating.
    pub nearest: bool,
    /// The most pixels that are read to any side.
    pub reach: i32,
}

/// A kernel that sums up its source along stream lines; `VALUES` is [`TWO`] or [`FOUR`], as the source has
/// channels, and `OUT` the number of channels of its output.
pub trait AlongLines<const VALUES: usize, const OUT: usize> {
    /// Two blocks in a tile, from copies of what lies around it.
    fn near<S: Simd>(
        &mut self,
        simd: S,
        field: &FieldCopy<'_>,
        integrator: Integrator,
        source: &TileCopy<VALUES>,
        blocks: &[Block; 2],
    ) -> [[f32x8<S>; OUT]; 2];

    /// One block, from the picture; `source` are colours times coverage.
    fn far<S: Simd>(
        &mut self,
        simd: S,
        field: &FieldView<'_>,
        integrator: Integrator,
        source: &View<'_>,
        block: &Block,
    ) -> [f32x8<S>; OUT];
}

/// Runs a kernel over a band.
pub fn along_lines<const VALUES: usize, const OUT: usize>(
    level: Level,
    inputs: &Inputs<'_>,
    kernel: &mut impl AlongLines<VALUES, OUT>,
    band: &mut Band<'_>,
) {
    // Which of two ways is taken depends on the parameters alone, not on where a pixel's tile lies.
    if inputs.nearest || !Frame::suits(inputs.reach) {
        return far(level, inputs, kernel, band);
    }
    let (mut source, mut tensors) = (TileCopy::default(), TileCopy::default());
    for frame in Frame::tiles(band.window, inputs.reach) {
        source.load_covered(&inputs.source, &frame);
        tensors.load(&inputs.field, &frame);
        let full = inputs.field.full();
        let edges = frame.meets_edges(full).then_some(full);
        let field = |edges| FieldCopy { frame: &frame, tensors: &tensors, edges };
        // Known to the compiler, the usual one has no part in its loops for what others need, and neither have tiles
        // that no line leaves the picture from.
        match (inputs.integrator, edges) {
            (Integrator::TwoStep, None) => {
                dispatch!(level, simd => near(simd, &field(None), Integrator::TwoStep, &source, kernel, band));
            }
            (Integrator::TwoStep, edges) => {
                dispatch!(level, simd => near(simd, &field(edges), Integrator::TwoStep, &source, kernel, band));
            }
            // With a sample of the field to wait for before each step, lines are slower by AVX-512.
            (other, None) => {
                let level = at_most_avx2(level);
                dispatch!(level, simd => near(simd, &field(None), other, &source, kernel, band))
            }
            (other, edges) => {
                let level = at_most_avx2(level);
                dispatch!(level, simd => near(simd, &field(edges), other, &source, kernel, band))
            }
        }
    }
}

/// One tile.
#[inline(always)]
fn near<S: Simd, const VALUES: usize, const OUT: usize>(
    simd: S,
    field: &FieldCopy<'_>,
    integrator: Integrator,
    source: &TileCopy<VALUES>,
    kernel: &mut impl AlongLines<VALUES, OUT>,
    band: &mut Band<'_>,
) {
    let (tile, window) = (field.frame.tile, band.window);
    let (start, end) = ((tile.x0 - window.x0) as usize, (tile.x1 - window.x0) as usize);
    for y in tile.y0..tile.y1 {
        let row = &mut band.row_mut(0, y)[OUT * start..OUT * end];
        let mut at = 0;
        while at < end - start {
            let (x, rest) = (tile.x0 + at as i32, end - start - at);
            let first = Block { x, y, len: rest.min(BLOCK) };
            // A block behind the end of the row does the first one's work again.
            let second = if rest > BLOCK {
                Block { x: x + BLOCK as i32, y, len: (rest - BLOCK).min(BLOCK) }
            } else {
                first
            };
            let [a, b] = kernel.near(simd, field, integrator, source, &[first, second]);
            write(a, &mut row[OUT * at..OUT * (at + first.len)]);
            if rest > BLOCK {
                write(b, &mut row[OUT * (at + BLOCK)..OUT * (at + BLOCK + second.len)]);
            }
            at += 2 * BLOCK;
        }
    }
}

/// A band whose lines reach too far for copies of what is around tiles, or read the field as copies do not.
fn far<const VALUES: usize, const OUT: usize>(
    level: Level,
    inputs: &Inputs<'_>,
    kernel: &mut impl AlongLines<VALUES, OUT>,
    band: &mut Band<'_>,
) {
    let covered = (VALUES == FOUR).then(|| Covered::new(&inputs.source, band, inputs.reach));
    let source = covered.as_ref().map_or(inputs.source, |c| c.view(&inputs.source));
    let field = FieldView { tensors: inputs.field, nearest: inputs.nearest };
    dispatch!(level, simd => for_blocks_in_tiles::<OUT>(band, #[inline(always)] |block, target| {
        write(kernel.far(simd, &field, inputs.integrator, &source, &block), target);
    }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::Image;

    #[test]
    fn ended_lanes_stay_where_they_are() {
        // Tangents run along the rows.
        let image = Image::from_vec(96, 20, 2, [-1.0, 0.0].repeat(96 * 20)).unwrap();
        let field = FieldView::new(View::new(&image, [96, 20]));
        dispatch!(Level::new(), simd => {
            let [x, y] = Block { x: 40, y: 9, len: 8 }.centres(simd);
            let begin = [Stream::begin(x, y, field.tangent(simd, x, y))];
            let mut lines = Lines::new(simd, &field, Integrator::Midpoint, begin)
                .only([x.simd_lt(f32x8::splat(simd, 44.0))]);
            lines.trace(simd, &field, [f32x8::splat(simd, 1.0)], 3, |_, _, point| point.active);
            let moved = (lines.streams[0].x - x).abs().to_array();
            assert!(moved[..4].iter().all(|m| (2.8..=3.0001).contains(m)), "{moved:?}");
            assert_eq!(moved[4..], [0.0; 4]);
        });
    }

    #[test]
    fn lines_end_where_they_leave_the_picture() {
        let image = Image::from_vec(16, 8, 2, [-1.0, 0.0].repeat(16 * 8)).unwrap();
        let field = FieldView::new(View::new(&image, [16, 8]));
        dispatch!(Level::new(), simd => {
            let block = Block { x: 8, y: 4, len: 8 };
            let [x, y] = block.centres(simd);
            let begin = both_sides(simd, &block, field.tangent(simd, x, y));
            let one = f32x8::splat(simd, 1.0);
            let mut lines = Lines::new(simd, &field, Integrator::Euler, begin);
            let mut points = [[0; 8]; 2];
            lines.trace(simd, &field, [one; 2], 100, |_, i, point| {
                for (lane, count) in points[i].iter_mut().enumerate() {
                    *count += point.active.select(one, one - one)[lane] as i32;
                }
                point.active
            });
            assert!(!lines.go_on());
            points.sort_unstable();
            assert_eq!(points, [[7, 6, 5, 4, 3, 2, 1, 0], [8, 9, 10, 11, 12, 13, 14, 15]]);
        });
    }
}
