//! Hysteresis (§ 4.1): weak candidates become strong when a chain of candidates, at most a given number of
//! pixels long, joins them to a strong one.
//!
//! Growing whole components would be a matter of the whole picture and of as many passes as its longest
//! chain. A pass grows them by up to [`STEPS`] pixels instead, and a plan holds as many as the wanted reach
//! takes: both executors and every tile then come to exactly the same edges.
//! Cost: reading and writing the pixel; a step is a few operations on 64 pixels, one bit each.

pub use crate::kernels::shaders::edge_hysteresis::Params;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Rect, Support, Tolerance, View};

crate::kernel!(edge_hysteresis {
    cpu: run,
    cost: |p| 6.0 + 0.1 * f64::from(p.steps),
    tolerance: Tolerance::of_rounding(0.0, 0.0, "bits, and constants to write"),
});

/// Pixels by which one pass grows edges at most: then the eight pixels of a workgroup and what they depend
/// on make 32, a word.
pub const STEPS: u32 = 12;

/// The edge image (1 = paper, 1 - `darkness` = line) of `candidates`: strong ones, and weak ones that a
/// chain of at most `reach` pixels joins to a strong one.
pub fn pass(plan: &mut PlanBuilder, candidates: ImageId, reach: u32, darkness: f32) -> ImageId {
    let (mut image, mut left) = (candidates, reach);
    loop {
        let steps = left.min(STEPS);
        left -= steps;
        let [none, weak, strong] = if left == 0 { [1.0, 1.0, 1.0 - darkness] } else { [0.0, 1.0, 2.0] };
        let params = Params { steps, none, weak, strong };
        image = plan.pass(&KERNEL, &[image], &params, Class::Field, Support::Pixels(steps));
        if left == 0 {
            return image;
        }
    }
}

/// Rows of pixels, one bit each.
struct Bits {
    words: usize,
    rows: Vec<u64>,
}

impl Bits {
    /// The pixels of `around` whose class is at least `least`.
    fn of(view: &View<'_>, around: Rect, least: f32) -> Self {
        let words = (around.width() as usize).div_ceil(64);
        let mut rows = Vec::with_capacity(words * around.height() as usize);
        for y in around.y0..around.y1 {
            let at = view.offset(around.x0, y);
            for pixels in view.data()[at..at + around.width() as usize].chunks(64) {
                let mut word = 0;
                for (i, v) in pixels.iter().enumerate() {
                    word |= u64::from(*v >= least) << i;
                }
                rows.push(word);
            }
        }
        Self { words, rows }
    }

    fn get(&self, row: usize, column: usize) -> bool {
        self.rows[row * self.words + column / 64] >> (column % 64) & 1 != 0
    }

    /// Grows by one pixel in all eight directions, within `allowed`; false when nothing changed.
    fn grow(&mut self, allowed: &Self, scratch: &mut Vec<u64>) -> bool {
        let words = self.words;
        let height = self.rows.len() / words.max(1);
        // Rows above, each joined with its neighbours, before the new values replace them.
        scratch.clear();
        for y in 0..height {
            let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
            for w in 0..words {
                scratch.push(
                    self.rows[above * words + w] | self.rows[y * words + w] | self.rows[below * words + w],
                );
            }
        }
        let mut changed = false;
        for (y, near) in scratch.chunks_exact(words.max(1)).enumerate() {
            for w in 0..words {
                let from_left = if w > 0 { near[w - 1] >> 63 } else { 0 };
                let from_right = if w + 1 < words { near[w + 1] << 63 } else { 0 };
                let grown = near[w] | near[w] << 1 | near[w] >> 1 | from_left | from_right;
                let at = y * words + w;
                let new = grown & allowed.rows[at];
                changed |= new != self.rows[at];
                self.rows[at] = new;
            }
        }
        changed
    }
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let (view, window) = (&pass.inputs[0], band.window);
    let around = window.grown(params.steps as i32).intersection(&view.window());
    let allowed = Bits::of(view, around, 1.0);
    let mut strong = Bits::of(view, around, 2.0);
    let mut scratch = Vec::new();
    for _ in 0..params.steps {
        if !strong.grow(&allowed, &mut scratch) {
            break;
        }
    }
    for y in window.y0..window.y1 {
        let row = (y - around.y0) as usize;
        let first = (window.x0 - around.x0) as usize;
        for (i, value) in band.row_mut(0, y).iter_mut().enumerate() {
            *value = if !allowed.get(row, first + i) {
                params.none
            } else if strong.get(row, first + i) {
                params.strong
            } else {
                params.weak
            };
        }
    }
}
