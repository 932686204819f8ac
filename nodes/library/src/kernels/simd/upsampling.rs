//! Rows of a coarser pyramid level, interpolated bilinearly at the pixels of the finer one.

use isophote_engine::View;

/// Two rows of the coarser level, kept while they serve.
#[derive(Debug, Default)]
pub struct Upsampling {
    rows: [Vec<f32>; 2],
    scratch: Vec<f32>,
    values: Vec<f32>,
}

impl Upsampling {
    /// Columns `x0..x1` of row `y` of the finer level, `N` values a pixel; colours times their coverage
    /// when `covered`.
    pub fn row<const N: usize>(
        &mut self,
        coarse: &View<'_>,
        y: i32,
        [x0, x1]: [i32; 2],
        covered: bool,
    ) -> &[f32] {
        // The coarse pixel before position (x + 1/2) / 2, and how far beyond its centre that lies.
        let corner = |x: i32| (x - 1) >> 1;
        let fraction = |x: i32| if x & 1 == 0 { 0.75f32 } else { 0.25 };
        let (first, last) = (corner(x0), corner(x1 - 1) + 2);
        for (i, row) in self.rows.iter_mut().enumerate() {
            let source = coarse.padded_row(corner(y) + i as i32, first, last, &mut self.scratch);
            row.clear();
            row.extend_from_slice(source);
            if covered {
                for p in row.chunks_exact_mut(4) {
                    for c in 0..3 {
                        p[c] *= p[3];
                    }
                }
            }
        }
        let fy = fraction(y);
        let [above, below] = &self.rows;
        // Readers take whole vectors.
        self.values.clear();
        self.values.resize((x1 - x0) as usize * N + 8 * N, 0.0);
        for (x, value) in (x0..x1).zip(self.values.chunks_exact_mut(N)) {
            let at = (corner(x) - first) as usize * N;
            let fx = fraction(x);
            let (upper, lower) = (&above[at..at + 2 * N], &below[at..at + 2 * N]);
            for c in 0..N {
                let top = upper[c] + (upper[N + c] - upper[c]) * fx;
                let bottom = lower[c] + (lower[N + c] - lower[c]) * fx;
                value[c] = top + (bottom - top) * fy;
            }
        }
        &self.values
    }
}
