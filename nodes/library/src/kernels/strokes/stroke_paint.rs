//! A layer of brush strokes (`stroke_seeds`) on what lies below: each pixel keeps the topmost four that
//! cover it. Bristles leave marks of different height, ends are ragged, and a brush may run dry.
//!
//! The GPU gathers strokes pixel by pixel from the cells around. Here a small tile gathers them once, sorts them, and its
//! pixels go through them from the top until they are covered.
//!
//! Cost: for each stroke at hand about 40 operations, and 200 more where it covers the pixel; of strokes three times as dense
//! as covers the picture, a pixel meets about ten and is covered by three.

pub use crate::kernels::shaders::stroke_paint::Params;
use crate::kernels::shared::value_noise::noise;
use crate::kernels::simd::pixels::Block;
use crate::kernels::strokes::stroke_points::offset;
use isophote_engine::bounds::Bounds;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Rect, Support, Tolerance};

crate::kernel!(stroke_paint {
    cpu: |simd, pass, params, band| paint(simd, pass, &params, band),
    cost: |_| 1000.0,
    tolerance: Tolerance {
        absolute: 5e-3,
        relative: 2e-3,
        outliers: 0.01,
        reason: "borders of strokes and of dry bristles magnify the last bits of noise and of places, and a stroke that hardly \
                 covers a pixel counts or does not",
    },
});

/// Appearance of the paint; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// Where the picture stands in the canonical one, as for the points.
    pub origin: [f32; 2],
    /// Half the width of the strokes.
    pub half_width: f32,
    /// Half their length.
    pub half_length: f32,
    /// Width and length of the marks of bristles.
    pub bristles: [f32; 2],
    /// Share of a stroke's end that is ragged, 0..1.
    pub ragged: f32,
    /// Share of a stroke that the paint does not cover, 0..=1.
    pub dryness: f32,
    /// Height of the middle of a stroke, and of its bristles' marks.
    pub heights: [f32; 2],
    /// Pixels over which borders are soft.
    pub softness: f32,
}

/// Largest length of strokes over the one that is asked for.
const LONGER: f32 = 1.15;
/// Coverage from which on a stroke counts, and what is left of a pixel that counts as covered.
const LEAST: f32 = 0.02;
/// Strokes that are kept of those that cover a pixel.
const KEPT: f32 = 4.0;
/// Height where nothing is painted.
const GROUND: f32 = 0.3;
/// Sides of the tiles that gather strokes.
const TILE: [i32; 2] = [32, 16];

/// Adds the pass: `strokes` on `below`, a picture in Lab and, but for the first layer, the heights of its paint; where there
/// are `ids`, no stroke leaves its object. Returns the picture and its heights.
pub fn pass(
    plan: &mut PlanBuilder,
    strokes: [ImageId; 3],
    (below, heights): (ImageId, Option<ImageId>),
    ids: Option<ImageId>,
    paint: &Paint,
) -> [ImageId; 2] {
    let of_cells = plan.desc(strokes[0]).level;
    let cell = (1 << of_cells.clamp(0, 24)) as f32;
    let longest = (LONGER * paint.half_length).max(paint.half_width);
    // Strokes bend.
    let reach = 1.1 * (longest + paint.half_width) + 1.0;
    let params = Params {
        offset: offset(paint.origin, of_cells),
        cell,
        cells: (reach / cell).ceil() as i32,
        reach,
        longest,
        widest: paint.half_width,
        across: 1.0 / paint.bristles[0].max(1e-3),
        along: 1.0 / paint.bristles[1].max(1e-3),
        ragged: paint.ragged,
        dryness: paint.dryness,
        body: paint.heights[0],
        relief: paint.heights[1],
        inverse_soft: 1.0 / paint.softness.max(0.1),
        begin: heights.is_none().into(),
        by_id: ids.is_some().into(),
    };
    let [places, shapes, colours] = strokes;
    let inputs = [places, shapes, colours, below, heights.unwrap_or(below), ids.unwrap_or(below)];
    let cells = Support::Pixels(params.cells as u32 + 1);
    let own = Support::Pixels(0);
    let supports = [cells, cells, cells, own, own, own];
    let classes = [Class::Colour, Class::Field];
    let level = plan.desc(below).level;
    let first = plan.pass_reaching(&KERNEL, &inputs, &params, &classes, &supports, level);
    [first, plan.sibling(first, 1)]
}

/// A stroke as pixels need it.
#[derive(Clone, Copy)]
struct Stroke {
    /// Pixels of the cell's corner, and of the seed from there.
    corner: [f32; 2],
    place: [f32; 2],
    rank: f32,
    half_width: f32,
    tangent: [f32; 2],
    curvature: f32,
    back: f32,
    forth: f32,
    colour: [f32; 3],
    id: f32,
}

impl Stroke {
    /// About where it is.
    #[inline(always)]
    fn centre(&self) -> [f32; 2] {
        [self.corner[0] + self.place[0], self.corner[1] + self.place[1]]
    }

    /// The stroke of a cell, if it has one.
    #[inline(always)]
    fn of(pass: &CpuPass<'_>, params: &Params, x: i32, y: i32) -> Option<Self> {
        let place = pass.inputs[0].pixel4(x, y);
        if place[3] <= 0.0 {
            return None;
        }
        let shape = pass.inputs[1].pixel4(x, y);
        let colour = pass.inputs[2].pixel4(x, y);
        let back = (shape[0] * shape[0] + shape[1] * shape[1]).sqrt();
        let length = back.at_least(1e-6);
        Some(Self {
            corner: [x as f32 * params.cell - params.offset[0], y as f32 * params.cell - params.offset[1]],
            place: [place[0], place[1]],
            rank: place[2],
            half_width: place[3].at_most(params.widest),
            tangent: [shape[0] / length, shape[1] / length],
            curvature: shape[2],
            back: back.within(1e-3, params.longest),
            forth: shape[3].within(1e-3, params.longest),
            colour: [colour[0], colour[1], colour[2]],
            id: colour[3],
        })
    }
}

#[inline(always)]
fn paint<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    let mut strokes = Vec::new();
    for y0 in (window.y0..window.y1).step_by(TILE[1] as usize) {
        for x0 in (window.x0..window.x1).step_by(TILE[0] as usize) {
            let tile = Rect { x0, y0, x1: (x0 + TILE[0]).min(window.x1), y1: (y0 + TILE[1]).min(window.y1) };
            gather(pass, params, tile, &mut strokes);
            for y in tile.y0..tile.y1 {
                for x in (tile.x0..tile.x1).step_by(8) {
                    let block = Block::until(tile.x1, x, y);
                    let [colours, heights] = painted(simd, pass, params, &strokes, &block);
                    block.write(colours, band, 0);
                    block.write(heights, band, 1);
                }
            }
        }
    }
}

/// The strokes that may cover a tile, the topmost first.
#[inline(always)]
fn gather(pass: &CpuPass<'_>, params: &Params, tile: Rect, strokes: &mut Vec<Stroke>) {
    strokes.clear();
    let [width, height] = pass.inputs[0].full();
    let cell = |v: i32, c: usize| ((v as f32 + 0.5 + params.offset[c]) / params.cell).floor() as i32;
    let (left, right) = (cell(tile.x0, 0) - params.cells, cell(tile.x1 - 1, 0) + params.cells);
    let (top, bottom) = (cell(tile.y0, 1) - params.cells, cell(tile.y1 - 1, 1) + params.cells);
    for y in top.max(0)..=bottom.min(height - 1) {
        for x in left.max(0)..=right.min(width - 1) {
            if let Some(stroke) = Stroke::of(pass, params, x, y) {
                let [px, py] = stroke.centre();
                let beside = (tile.x0 as f32 - px).at_least(px - tile.x1 as f32);
                let above = (tile.y0 as f32 - py).at_least(py - tile.y1 as f32);
                if beside <= params.reach && above <= params.reach {
                    strokes.push(stroke);
                }
            }
        }
    }
    // Of equals the first stays on top, as where pixels go through the cells.
    strokes.sort_by(|a, b| b.rank.total_cmp(&a.rank));
}

/// Colours and heights of a block.
#[inline(always)]
fn painted<S: Simd>(
    simd: S,
    pass: &CpuPass<'_>,
    params: &Params,
    strokes: &[Stroke],
    block: &Block,
) -> [[f32x8<S>; 4]; 2] {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let [px, py] = block.centres(simd);
    let mut thing = zero;
    if params.by_id != 0 {
        let [id] = block.read::<S, 1>(simd, &pass.inputs[5]);
        thing = id.abs().simd_le(f32::MAX).select(id, zero);
    }
    let (mut rest, mut kept) = (one, zero);
    let mut sum = [zero; 3];
    let mut height = zero;
    let (first, last, row) = (block.x as f32, (block.x + 8) as f32, block.y as f32 + 0.5);
    for stroke in strokes {
        let [x, y] = stroke.centre();
        let far = stroke.back.at_least(stroke.forth) * 1.1 + stroke.half_width * 1.1 + 1.0;
        if (row - y).abs() > far || x - last > far || first - x > far {
            continue;
        }
        let open = rest.simd_ge(LEAST) & kept.simd_lt(KEPT);
        if !open.any_true() {
            break;
        }
        let d = [px - stroke.corner[0] - stroke.place[0], py - stroke.corner[1] - stroke.place[1]];
        let near = d[0].abs().simd_le(params.reach) & d[1].abs().simd_le(params.reach);
        let here = if params.by_id != 0 { (thing - stroke.id).abs().simd_le(0.5) } else { near };
        let Some([alpha, top]) = mark(simd, params, stroke, d) else { continue };
        let counts = open & near & here & alpha.simd_ge(LEAST);
        let share = counts.select(rest * alpha, zero);
        for c in 0..3 {
            sum[c] += share * stroke.colour[c];
        }
        height += share * top;
        rest -= share;
        kept += counts.select(one, zero);
    }
    let [l, a, b, alpha]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[3]);
    let ground = if params.begin != 0 {
        one * GROUND
    } else {
        let [ground, ..]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[4]);
        ground
    };
    let height = height + rest * ground;
    [[sum[0] + rest * l, sum[1] + rest * a, sum[2] + rest * b, alpha], [height, height, height, one]]
}

/// Share that a stroke covers of pixels that lie `d` from its seed, and height of its paint there; nothing where it lies
/// beside all of them.
#[inline(always)]
fn mark<S: Simd>(
    simd: S,
    params: &Params,
    stroke: &Stroke,
    [dx, dy]: [f32x8<S>; 2],
) -> Option<[f32x8<S>; 2]> {
    let [tx, ty] = stroke.tangent;
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let u = dx * tx + dy * ty;
    let v = dy * tx - dx * ty - u * u * (0.5 * stroke.curvature);
    let len = u.simd_gt(zero).select(one * stroke.forth, one * stroke.back);
    let w = stroke.half_width;
    let (q, e) = (v.abs() * (1.0 / w), u.abs() / len);
    let inside = q.simd_le(1.1) & e.simd_le(1.1);
    if !inside.any_true() {
        return None;
    }
    let x = u * params.along + stroke.rank * 16.0;
    let y = v * params.across;
    let fine = noise(simd, x, y + 31.0, 11);
    let coarse = noise(simd, x * 0.45, y * 0.37 + 77.0, 23);
    let bristle = (fine + coarse) * 0.5;
    let row = v.simd_gt(zero).select(one * 3.0, one * 9.0);
    let side = one - noise(simd, x * 1.3, row, 5) * 0.22;
    let end = one - bristle * params.ragged - q * q * 0.25;
    let ahead = ((end - e) * len * params.inverse_soft + 0.5).within(0.0, 1.0);
    let across = ((side - q) * (w * params.inverse_soft) + 0.5).within(0.0, 1.0);
    let mut alpha = inside.select(ahead * across, zero);
    if params.dryness > 0.0 {
        // A brush that runs dry covers less and less.
        let dry = ((u / len) * 0.245 + 0.505) * params.dryness;
        alpha *= ((bristle - dry) * 8.0 + 0.5).within(0.0, 1.0);
    }
    // Paint is thick in the middle, heaped up at the sides and thin at the ends.
    let edge = (q / side).at_most(1.0);
    let square = edge * edge;
    let profile = (one - square * square) * 1.4 + square * (one - edge) * 3.0;
    let ahead = (e / end.at_least(0.1)).at_most(1.0);
    let cube = ahead * ahead * ahead;
    let height = profile * (one - cube * cube) * params.body + (bristle - 0.5) * params.relief + GROUND;
    Some([alpha, height])
}
