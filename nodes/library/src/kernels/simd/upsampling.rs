//! Rows of a coarser pyramid level, interpolated bilinearly at the pixels of the finer one.

use isophote_engine::View;

/// Two rows of the coarser level at the columns of the finer one, kept while they serve: for one view, and the same
/// columns in all calls.
#[derive(Debug, Default)]
pub struct Upsampling {
    above: Stretched,
    below: Stretched,
    scratch: Vec<f32>,
    values: Vec<f32>,
}

impl Upsampling {
    /// Columns `x0..x1` of row `y` of the finer level, `N` values a pixel, and eight pixels more for readers of whole
    /// vectors; colours times their coverage when `covered`.
    pub fn row<const N: usize>(
        &mut self,
        coarse: &View<'_>,
        y: i32,
        columns: [i32; 2],
        covered: bool,
    ) -> &[f32] {
        let first = before(y);
        if self.below.is(first) {
            std::mem::swap(&mut self.above, &mut self.below);
        }
        for (row, y) in [(&mut self.above, first), (&mut self.below, first + 1)] {
            if !row.is(y) {
                row.fill::<N>(coarse, y, columns, covered, &mut self.scratch);
            }
        }
        let share = share(y);
        let ends = self.above.values.iter().zip(&self.below.values);
        self.values.clear();
        self.values.extend(ends.map(|(top, bottom)| top + (bottom - top) * share));
        self.values.resize(self.values.len() + 8 * N, 0.0);
        &self.values
    }
}

/// A row of the coarser level, interpolated at the columns of the finer one.
#[derive(Debug, Default)]
struct Stretched {
    y: Option<i32>,
    values: Vec<f32>,
}

impl Stretched {
    fn is(&self, y: i32) -> bool {
        self.y == Some(y)
    }

    fn fill<const N: usize>(
        &mut self,
        coarse: &View<'_>,
        y: i32,
        [x0, x1]: [i32; 2],
        covered: bool,
        scratch: &mut Vec<f32>,
    ) {
        let first = before(x0);
        let row = coarse.padded_row(y, first, before(x1 - 1) + 2, scratch);
        self.y = Some(y);
        self.values.clear();
        self.values.resize((x1 - x0) as usize * N, 0.0);
        for (x, value) in (x0..x1).zip(self.values.chunks_exact_mut(N)) {
            let ends = &row[(before(x) - first) as usize * N..][..2 * N];
            let (left, right) = ends.split_at(N);
            // Colours count by their coverage, the last of four values.
            let by = |pixel: &[f32], c: usize| {
                if covered && c + 1 < N { pixel[c] * pixel[N - 1] } else { pixel[c] }
            };
            let share = share(x);
            for c in 0..N {
                let (left, right) = (by(left, c), by(right, c));
                value[c] = left + (right - left) * share;
            }
        }
    }
}

/// The coarse pixel before position (x + 1/2) / 2.
fn before(x: i32) -> i32 {
    (x - 1) >> 1
}

/// The way from the centre of that pixel to the position, and so the share of the next one.
fn share(x: i32) -> f32 {
    if x & 1 == 0 { 0.75 } else { 0.25 }
}
