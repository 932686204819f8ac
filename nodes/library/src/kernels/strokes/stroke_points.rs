//! Places where strokes may begin: in each cell of the screen the highest of the points of a lattice that lie there. Points of
//! the lattice belong to rest positions, else to what motion carries, else to the screen. All that is random of a stroke comes
//! from the height of its point, which is a hash of the lattice's cell, so that strokes keep their looks as they move.
//!
//! Of rest positions the lattice has three dimensions, and a point counts that is near a surface: there its stroke begins. As
//! the camera comes closer, points of the finer one of two octaves come one after another while those of the coarser one
//! go, so that there are always as many on the screen.
//!
//! Cost: on the screen four hashes a cell; else up to 64 hashes and about 1500 operations.

pub use crate::kernels::shaders::stroke_points::Params;
use crate::kernels::shared::rest_position::NO_FOOTPRINT;
use isophote_engine::bounds::Bounds;
use isophote_engine::fearless_simd::Simd;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(stroke_points {
    cpu: |simd, pass, params, band| run(simd, pass, &params, band),
    cost: |p| if p.way == 0 { 100.0 } else { 1500.0 },
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 0.0,
        outliers: 0.02,
        reason: "the last bit of a place decides to which cell a point belongs, and which of two sides of a pixel counts",
    },
});

/// Strokes' ground: what their places belong to.
#[derive(Clone, Copy, Debug)]
pub enum Anchor {
    /// The screen.
    Screen,
    /// One of two layers that motion carries ([`mark_chain`](crate::kernels::time::mark_chain)).
    Carried {
        /// Where the pixels of both come from.
        chain: ImageId,
        /// True for the second one.
        second: bool,
        /// Number of the layer's life: each has points of its own.
        life: u32,
    },
    /// Rest positions.
    Rest {
        /// Points of the objects.
        points: ImageId,
        /// Extent of a pixel in them ([`rest_scale`](crate::kernels::structure::rest_scale)).
        scales: ImageId,
    },
}

/// Points of a layer of strokes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Points {
    /// Distance within which one of them alone becomes a stroke, pixels.
    pub apart: f32,
    /// Where the picture stands in the canonical one, pixels.
    pub origin: [f32; 2],
    /// Another number gives other points.
    pub seed: u32,
}

/// Distance of points of the lattice against that of strokes: there are two and a half for each stroke.
const DENSE: f32 = 1.12;

/// Adds the pass: (x and y from the corner of the cell, height in 0..[`HIGHEST`], size in 0..=1) of the point of each cell, at
/// the level of the pyramid whose cells are as wide as points are apart, or less. `picture` is read nowhere.
pub fn pass(plan: &mut PlanBuilder, picture: ImageId, anchor: Anchor, points: &Points) -> ImageId {
    let level = points.apart.log2().floor().clamp(1.0, 12.0) as i8;
    let spacing = (DENSE * points.apart).max(1e-3);
    let cell = 1 << level;
    let (way, inputs, life) = match anchor {
        Anchor::Screen => (0, [picture, picture], 0),
        Anchor::Carried { chain, second: false, life } => (1, [chain, chain], life),
        Anchor::Carried { chain, second: true, life } => (2, [chain, chain], life),
        Anchor::Rest { points, scales } => (3, [points, scales], 0),
    };
    let params = Params {
        offset: offset(points.origin, level),
        origin: points.origin,
        cell,
        spacing,
        level: spacing.log2(),
        life: life.wrapping_mul(0x9e37_79b9),
        decay: 1.0 / (COMMON * spacing),
        seed: points.seed,
        way,
        padding: Default::default(),
    };
    // Points are looked for from four pixels of a cell, and land in it or beside it.
    let reach = if way == 0 { 0 } else { cell as u32 + 4 };
    plan.pass_at(&KERNEL, &inputs, &params, &[Class::Field], Support::Pixels(reach), level)
}

/// Pixels by which cells of a level, 2^level wide, begin before a picture that stands at `origin`.
pub fn offset(origin: [f32; 2], level: i8) -> [f32; 2] {
    let cell = (1 << level.clamp(0, 24)) as f32;
    origin.map(|o| o.floor().rem_euclid(cell))
}

/// Height of the highest points.
pub const HIGHEST: f32 = 4.0;
/// Distance of places, against that of points, from which on carried layers have no points in common.
const COMMON: f32 = 0.3;
/// Change of the weight of an octave from a pixel to one beside a cell, at most.
const SOON: f32 = 0.2;

/// A point of the lattice: its place in it, its height, and two more numbers of its own in 0..1.
struct Point {
    place: [f32; 3],
    rank: f32,
    chance: [f32; 2],
}

const fn mixed(v: u32) -> u32 {
    let h = (v ^ (v >> 15)).wrapping_mul(0x2c1b_3c6d);
    let h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    h ^ (h >> 15)
}

impl Point {
    #[inline(always)]
    fn of([x, y, z]: [i32; 3], seed: u32) -> Self {
        let products = [(x, 0x9e37_79b1), (y, 0x85eb_ca77), (z, 0xc2b2_ae3d)];
        let [x_part, y_part, z_part] =
            products.map(|(v, factor): (i32, u32)| (v as u32).wrapping_mul(factor));
        let a = mixed(x_part ^ y_part ^ z_part ^ seed);
        let b = mixed(a ^ 0x68e3_1da4);
        let d = mixed(b ^ 0xb529_7a4d);
        let within = |shift: u32| ((a >> shift) & 1023) as f32 * 0.000_976_562_5;
        Self {
            place: [x as f32 + within(0), y as f32 + within(10), z as f32 + within(20)],
            rank: (b >> 8) as f32 * 2.384_185_8e-7,
            chance: [(d >> 16) as f32 * 1.525_878_9e-5, (d & 0xffff) as f32 * 1.525_878_9e-5],
        }
    }
}

/// 1 for points whose chance is below a weight, those about there little by little.
#[inline(always)]
fn counted(weight: f32, chance: f32) -> f32 {
    ((1.125 * weight - chance) * 8.0).within(0.0, 1.0)
}

/// A cell of the screen, and the best point in it so far.
struct Cell<'a> {
    params: &'a Params,
    inputs: &'a [View<'a>],
    corner: [i32; 2],
    best: [f32; 4],
    /// Blocks of eight cells of the lattice, or of four, whose points were looked at: pixels side by side mostly see the same.
    seen: [[i32; 4]; 8],
    blocks: usize,
}

/// Surface at a pixel: its point, its change per pixel, and the logarithm of the spacing that points are to have there.
struct Surface {
    point: [f32; 3],
    changes: [[f32; 3]; 2],
    level: f32,
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Pixels that show a point of an object.
#[inline(always)]
fn is_at_rest([x, y, z, validity]: [f32; 4]) -> bool {
    // Comparisons with what is no number are false.
    x.abs() < 1e15 && y.abs() < 1e15 && z.abs() < 1e15 && validity > 0.5 && validity <= f32::MAX
}

impl Surface {
    /// From a pixel's centre to where the surface is nearest to a point of the lattice, pixels, and how far that is, cells.
    #[inline(always)]
    fn nearest(&self, unit: f32, place: [f32; 3]) -> Option<[f32; 3]> {
        let mut v = [0.0; 3];
        let mut changes = self.changes;
        for i in 0..3 {
            v[i] = place[i] - self.point[i] * unit;
            changes[0][i] *= unit;
            changes[1][i] *= unit;
        }
        let [x, y] = changes;
        let (a, b, c) = (dot(x, x), dot(x, y), dot(y, y));
        let det = a * c - b * b;
        if det <= 1e-4 * a * c || a * c < 1e-20 {
            return None;
        }
        let (g, h) = (dot(x, v), dot(y, v));
        let [dx, dy] = [(c * g - b * h) / det, (a * h - b * g) / det];
        for i in 0..3 {
            v[i] = v[i] - x[i] * dx - y[i] * dy;
        }
        Some([dx, dy, dot(v, v).sqrt()])
    }
}

/// Weight of the points of an octave, so many octaves above the spacing that is wanted.
#[inline(always)]
fn octave_weight(above: f32) -> f32 {
    let t = 1.0 - above.abs();
    if t <= 0.0 {
        0.0
    } else if above > 0.0 {
        t
    } else {
        0.5 * (t + t * t)
    }
}

impl Cell<'_> {
    /// Of the points of a cell the best one stays: high ones that are as large as they may be.
    #[inline(always)]
    fn offer(&mut self, [x, y]: [f32; 2], rank: f32, share: f32) {
        let side = self.params.cell as f32;
        let inside = x >= 0.0 && y >= 0.0 && x < side && y < side;
        if inside && share > 0.0 && rank * share > self.best[2] * self.best[3] {
            self.best = [x, y, rank, share];
        }
    }

    /// True for a block of the lattice that was not looked at before.
    #[inline(always)]
    fn is_new(&mut self, block: [i32; 4]) -> bool {
        if self.blocks == 8 || self.seen[..self.blocks].contains(&block) {
            return false;
        }
        self.seen[self.blocks] = block;
        self.blocks += 1;
        true
    }

    #[inline(always)]
    fn is_in_picture(&self, [x, y]: [i32; 2]) -> bool {
        let [width, height] = self.inputs[0].full();
        x >= 0 && y >= 0 && x < width && y < height
    }

    /// True for places in the cell or hardly beside it.
    #[inline(always)]
    fn is_near(&self, place: [f32; 2]) -> bool {
        (0..2).all(|i| {
            let d = place[i] - self.corner[i] as f32;
            d > -1.0 && d < self.params.cell as f32 + 1.0
        })
    }

    /// A place beside a pixel's centre, from the corner of the cell.
    #[inline(always)]
    fn past_corner(&self, p: [i32; 2], d: [f32; 2]) -> [f32; 2] {
        [0, 1].map(|i| (p[i] - self.corner[i]) as f32 + 0.5 + d[i])
    }

    /// Change of the point per pixel along an axis; of both sides the one with less change lies on the same surface.
    #[inline(always)]
    fn change(&self, [x, y]: [i32; 2], here: [f32; 4], [dx, dy]: [i32; 2]) -> [f32; 3] {
        let side = |sign: i32| {
            let at = [x + sign * dx, y + sign * dy];
            let there = if self.is_in_picture(at) { self.inputs[0].pixel4(at[0], at[1]) } else { [0.0; 4] };
            is_at_rest(there).then(|| [0, 1, 2].map(|i| (there[i] - here[i]) * sign as f32))
        };
        match (side(-1), side(1)) {
            (Some(back), Some(ahead)) => {
                if dot(ahead, ahead) < dot(back, back) {
                    ahead
                } else {
                    back
                }
            }
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => [0.0; 3],
        }
    }

    #[inline(always)]
    fn surface(&self, [x, y]: [i32; 2]) -> Option<Surface> {
        let point = self.inputs[0].pixel4(x, y);
        let scales = &self.inputs[1];
        let scale = scales.data()[scales.offset(x, y)];
        let is_known = scale < 0.1 * NO_FOOTPRINT;
        if !is_at_rest(point) || !is_known {
            return None;
        }
        // So far from 0 that floats do not tell finer cells apart, points are farther apart.
        let farthest = point[0].abs().at_least(point[1].abs()).at_least(point[2].abs());
        let exponent = ((farthest.to_bits() >> 23) & 255) as f32 - 127.0;
        Some(Surface {
            point: [point[0], point[1], point[2]],
            changes: [self.change([x, y], point, [1, 0]), self.change([x, y], point, [0, 1])],
            level: (scale + self.params.level).at_least(exponent - 18.0).within(-60.0, 60.0),
        })
    }

    /// The points that are near a surface, as it is at `p`.
    #[inline(always)]
    fn solid(&mut self, p: [i32; 2], s: &Surface) {
        for n in 0..2 {
            let octave = s.level.floor() as i32 + n;
            let unit = f32::from_bits(((127 - octave) as u32) << 23);
            let first = s.point.map(|v| (v * unit - 0.5).floor() as i32);
            if !self.is_new([first[0], first[1], first[2], octave]) {
                continue;
            }
            let seed = self.params.seed.wrapping_add((octave as u32).wrapping_mul(0x9e37_79b9));
            for i in 0..8 {
                let found =
                    Point::of([first[0] + (i & 1), first[1] + ((i >> 1) & 1), first[2] + (i >> 2)], seed);
                self.solid_point(p, s, &found, octave);
            }
        }
    }

    #[inline(always)]
    fn solid_point(&mut self, p: [i32; 2], s: &Surface, found: &Point, octave: i32) {
        // Nothing can come of what is lower than the best so far, or far from its turn.
        let soon = octave_weight(octave as f32 - s.level) + SOON;
        if found.rank <= self.best[2] * self.best[3] || counted(soon, found.chance[0]) <= 0.0 {
            return;
        }
        let unit = f32::from_bits(((127 - octave) as u32) << 23);
        let Some([dx, dy, far]) = s.nearest(unit, found.place) else { return };
        let there = [p[0] as f32 + 0.5 + dx, p[1] as f32 + 0.5 + dy];
        let landed = there.map(|v| v.floor() as i32);
        if far > 1.0 || !self.is_near(there) || !self.is_in_picture(landed) {
            return;
        }
        let Some(below) = self.surface(landed) else { return };
        let Some([dx, dy, far]) = below.nearest(unit, found.place) else { return };
        let weight = octave_weight(octave as f32 - below.level);
        let share = counted(weight, found.chance[0]) * ((0.525 - far) * 20.0).within(0.0, 1.0);
        if dx.abs() < 1.5 && dy.abs() < 1.5 {
            self.offer(self.past_corner(landed, [dx, dy]), found.rank, share);
        }
    }

    /// Where the centre of a pixel belongs to in the lattice of the layer.
    #[inline(always)]
    fn carried_place(&self, [x, y]: [i32; 2]) -> [f32; 2] {
        let [ax, ay, bx, by] = self.inputs[0].pixel4(x, y);
        let Params { origin, spacing, way, .. } = self.params;
        let [dx, dy] = if *way == 2 { [bx, by] } else { [ax, ay] };
        [(x as f32 + 0.5 + origin[0] + dx) / spacing, (y as f32 + 0.5 + origin[1] + dy) / spacing]
    }

    /// The points that motion carried to about a pixel.
    #[inline(always)]
    fn carried(&mut self, p: [i32; 2]) {
        let q = self.carried_place(p);
        let first = q.map(|v| (v - 0.5).floor() as i32);
        if !self.is_new([first[0], first[1], 0, 0]) {
            return;
        }
        for i in 0..8 {
            // Points that all layers have in common, and those of this life alone.
            let is_own = i >= 4;
            let seed = self.params.seed.wrapping_add(if is_own { self.params.life } else { 0 });
            let found = Point::of([first[0] + (i & 1), first[1] + ((i >> 1) & 1), 0], seed);
            self.carried_point(p, q, &found, is_own);
        }
    }

    #[inline(always)]
    fn carried_point(&mut self, p: [i32; 2], q: [f32; 2], found: &Point, is_own: bool) {
        if found.rank <= self.best[2] * self.best[3] {
            return;
        }
        let spacing = self.params.spacing;
        let mut landed = p;
        let mut d = [0, 1].map(|i| (found.place[i] - q[i]) * spacing);
        if !self.is_near([0, 1].map(|i| landed[i] as f32 + 0.5 + d[i])) {
            return;
        }
        for _ in 0..2 {
            landed = [0, 1].map(|i| (landed[i] as f32 + 0.5 + d[i]).floor() as i32);
            if !self.is_in_picture(landed) {
                return;
            }
            let q = self.carried_place(landed);
            d = [0, 1].map(|i| (found.place[i] - q[i]) * spacing);
            if !self.is_near([0, 1].map(|i| landed[i] as f32 + 0.5 + d[i])) {
                return;
            }
        }
        if d[0].abs() <= 1.0 && d[1].abs() <= 1.0 {
            let ways = self.inputs[0].pixel4(landed[0], landed[1]);
            let share = self.carried_share(ways, found, is_own);
            self.offer(self.past_corner(landed, d), found.rank, share);
        }
    }

    /// Size of the stroke of a point: where both layers are at one place they have the same points.
    #[inline(always)]
    fn carried_share(&self, ways: [f32; 4], found: &Point, is_own: bool) -> f32 {
        let [dx, dy] = [ways[2] - ways[0], ways[3] - ways[1]];
        let t = ((dx * dx + dy * dy).sqrt() * self.params.decay).at_most(1.0);
        let own = t * t * (3.0 - 2.0 * t);
        counted(if is_own { own } else { 1.0 - own }, found.chance[1])
    }

    /// The points of the screen.
    #[inline(always)]
    fn flat(&mut self) {
        let Params { origin, spacing, cell, seed, .. } = *self.params;
        let half = 0.5 * cell as f32;
        let q = [0, 1].map(|i| (self.corner[i] as f32 + half + origin[i]) / spacing);
        let first = q.map(|v| (v - 0.5).floor() as i32);
        for i in 0..4 {
            let found = Point::of([first[0] + (i & 1), first[1] + (i >> 1), 0], seed);
            self.offer([0, 1].map(|i| half + (found.place[i] - q[i]) * spacing), found.rank, 1.0);
        }
    }

    /// The point of the screen, where there is no object.
    #[inline(always)]
    fn beside(&mut self) {
        let mut screen = Cell { best: [0.0; 4], ..*self };
        screen.flat();
        let [x, y, rank, share] = screen.best;
        let landed = [self.corner[0] as f32 + x, self.corner[1] as f32 + y].map(|v| v.floor() as i32);
        if self.is_in_picture(landed) && self.surface(landed).is_none() {
            self.offer([x, y], rank, share);
        }
    }

    /// The points that are found from four pixels of the cell.
    #[inline(always)]
    fn gather(&mut self) {
        let side = self.params.cell;
        let mut is_beside = false;
        for n in 0..4 {
            let p = [
                self.corner[0] + (1 + 2 * (n & 1)) * side / 4,
                self.corner[1] + (1 + 2 * (n >> 1)) * side / 4,
            ];
            if !self.is_in_picture(p) {
                continue;
            }
            if self.params.way < 3 {
                self.carried(p);
            } else if let Some(surface) = self.surface(p) {
                self.solid(p, &surface);
            } else {
                is_beside = true;
            }
        }
        if is_beside {
            self.beside();
        }
    }
}

#[inline(always)]
fn run<S: Simd>(_: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    for y in window.y0..window.y1 {
        let row = band.row_mut(0, y);
        for (x, target) in (window.x0..window.x1).zip(row.chunks_exact_mut(4)) {
            let corner =
                [x * params.cell - params.offset[0] as i32, y * params.cell - params.offset[1] as i32];
            let mut cell =
                Cell { params, inputs: pass.inputs, corner, best: [0.0; 4], seen: [[0; 4]; 8], blocks: 0 };
            if params.way == 0 {
                cell.flat();
            } else {
                cell.gather();
            }
            target.copy_from_slice(&cell.best);
        }
    }
}
