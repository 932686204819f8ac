//! Strokes, one from the point of a cell (`stroke_points`): each goes along the tensor field, as long and as wide as the picture
//! keeps its colour, in a colour of its own, and only where the picture has detail of its size (after Hertzmann, Painterly
//! rendering with curved brush strokes of multiple sizes, 1998). Points near higher ones are no seeds, so that strokes keep their
//! distance; they shrink as a higher one comes nearer.
//!
//! Cost per cell: 25 distances; where there is a stroke, about 45 loads and 500 operations.

pub use crate::kernels::shaders::stroke_seeds::Params;
use crate::kernels::shared::tensor;
use crate::kernels::shared::value_noise::noise;
use crate::kernels::strokes::stroke_points::offset;
use isophote_engine::bounds::Bounds;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(stroke_seeds {
    cpu: |simd, pass, params, band| seeds(simd, pass, &params, band),
    cost: |_| 600.0,
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-3,
        outliers: 0.02,
        reason: "where a stroke ends the last bit of a place or of a difference decides, and as to which of two pixels \
                 a place belongs",
    },
});

/// Strokes of a layer; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strokes {
    /// Where the picture stands in the canonical one, as for the points.
    pub origin: [f32; 2],
    /// Half the width.
    pub half_width: f32,
    /// Half the length.
    pub half_length: f32,
    /// Distance between seeds, at least.
    pub apart: f32,
    /// Share of the field's bend that strokes follow, 0..=1.
    pub curve: f32,
    /// Difference of colour from which on a stroke ends, Lab.
    pub tolerance: f32,
    /// Difference between the picture and the coarse one from which on there are strokes, Lab.
    pub threshold: f32,
    /// Distance along a stroke at which colours count half.
    pub smoothing: f32,
    /// Largest change of lightness from stroke to stroke, L.
    pub variation: f32,
    /// Largest change of hue, radians.
    pub hue_variation: f32,
}

/// Images that strokes are made after.
#[derive(Clone, Copy, Debug)]
pub struct Inputs {
    /// Points by cell, which are at most [`Strokes::apart`] wide.
    pub points: ImageId,
    /// Tensors that strokes follow.
    pub tensors: ImageId,
    /// The picture to paint, Lab.
    pub picture: ImageId,
    /// The picture without what is finer than strokes, Lab: where its colour changes strokes end, so that neither a thin line
    /// nor a grain cuts a stroke off in one size of the picture and not in another.
    pub smooth: ImageId,
    /// The picture without what is finer than strokes of the layer below, Lab; none for the first layer.
    pub coarse: Option<ImageId>,
    /// Object ids, where they are known: strokes end at borders.
    pub ids: Option<ImageId>,
}

/// Strokes by cell, three images: place, rank and half width, 0 for none; direction, longer by the half length against it, bend
/// and half length along it; colour in Lab and object id.
pub fn pass(plan: &mut PlanBuilder, inputs: &Inputs, strokes: &Strokes) -> [ImageId; 3] {
    let level = plan.desc(inputs.points).level;
    let params = Params {
        offset: offset(strokes.origin, level),
        cell: (1 << level.clamp(0, 24)) as f32,
        apart: strokes.apart,
        half_width: strokes.half_width,
        half_length: strokes.half_length,
        curve: strokes.curve,
        tolerance: strokes.tolerance,
        threshold: if inputs.coarse.is_some() { strokes.threshold.max(1e-3) } else { -1.0 },
        inverse_smoothing: 1.0 / strokes.smoothing.max(1e-3),
        variation: strokes.variation,
        hue_variation: strokes.hue_variation,
        by_id: inputs.ids.is_some().into(),
        padding: Default::default(),
    };
    let picture = inputs.picture;
    let images = [
        inputs.points,
        inputs.tensors,
        picture,
        inputs.coarse.unwrap_or(picture),
        inputs.ids.unwrap_or(picture),
        inputs.smooth,
    ];
    // A stroke that turns by MOST_TURN / 2 leaves its direction by that share of its half length.
    let reach = (1.07 * params.half_length).max(FLAT_WITHIN * params.half_width).ceil() as u32
        + 2
        + params.cell as u32;
    let mut supports = [Support::Pixels(reach); 6];
    supports[0] = Support::Pixels(AROUND as u32);
    // Colours stand beside ids, which 16-bit floats do not hold.
    let classes = [Class::Field; 3];
    let first = plan.pass_reaching(&KERNEL, &images, &params, &classes, &supports, level);
    [first, plan.sibling(first, 1), plan.sibling(first, 2)]
}

/// Size below which a stroke is none.
const LEAST: f32 = 0.1;
/// Cells to each side whose points may be too near.
const AROUND: i32 = 2;
/// Steps to each side of a stroke.
const STEPS: i32 = 6;
/// Where a picture is flat within so many widths, strokes lie as the hand has it: slope against the field at most, and the
/// difference in Lab that counts as flat no more.
const FLAT_WITHIN: f32 = 1.5;
const MOST_SLOPE: f32 = 0.5;
const NOT_FLAT: f32 = 4.0;
/// Turn of a stroke along half its length at most.
const MOST_TURN: f32 = 0.7;

/// Values of a cell for each of the outputs.
type Record = [[f32; 4]; 3];

#[inline(always)]
fn seeds<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    for y in window.y0..window.y1 {
        for x in window.x0..window.x1 {
            let record = seed(simd, pass, params, [x, y]);
            for (output, values) in record.iter().enumerate() {
                let at = 4 * (x - window.x0) as usize;
                band.row_mut(output, y)[at..at + 4].copy_from_slice(values);
            }
        }
    }
}

/// Size of the stroke of a point, as higher ones are near it.
#[inline(always)]
fn prominence(pass: &CpuPass<'_>, params: &Params, [x, y]: [i32; 2], own: [f32; 4]) -> f32 {
    let [width, height] = pass.inputs[0].full();
    let mut share = own[3];
    for j in (y - AROUND).max(0)..=(y + AROUND).min(height - 1) {
        for i in (x - AROUND).max(0)..=(x + AROUND).min(width - 1) {
            let other = pass.inputs[0].pixel4(i, j);
            if other[2] > own[2] {
                let dx = other[0] - own[0] + (i - x) as f32 * params.cell;
                let dy = other[1] - own[1] + (j - y) as f32 * params.cell;
                // What comes nearer counts little by little, so that strokes neither appear nor vanish at once.
                let near =
                    (6.666_666_5 - (dx * dx + dy * dy).sqrt() / params.apart * 6.666_666_5).within(0.0, 1.0);
                share = share.at_most(1.0 - near * other[3]);
            }
        }
    }
    share
}

/// The pictures and the ids around a seed.
struct Surroundings<'a> {
    pass: &'a CpuPass<'a>,
    params: &'a Params,
    /// Pixels of the cell's corner, and of the seed from there: where a picture stands in a larger one rounds nothing.
    corner: [i32; 2],
    place: [f32; 2],
    tangent: [f32; 2],
    curvature: f32,
}

impl Surroundings<'_> {
    /// The pixel `u` along the stroke and `v` across it.
    #[inline(always)]
    fn pixel(&self, u: f32, v: f32) -> [i32; 2] {
        let ([x, y], [tx, ty]) = (self.place, self.tangent);
        let [x, y] = [x + tx * u - ty * v, y + ty * u + tx * v];
        [self.corner[0] + x.floor() as i32, self.corner[1] + y.floor() as i32]
    }

    #[inline(always)]
    fn picture(&self, [x, y]: [i32; 2]) -> [f32; 4] {
        self.pass.inputs[2].pixel4(x, y)
    }

    #[inline(always)]
    fn smooth(&self, [x, y]: [i32; 2]) -> [f32; 4] {
        self.pass.inputs[5].pixel4(x, y)
    }

    #[inline(always)]
    fn id(&self, [x, y]: [i32; 2]) -> f32 {
        if self.params.by_id == 0 {
            return 0.0;
        }
        let ids = &self.pass.inputs[4];
        let id = ids.data()[ids.offset(x, y)];
        if id.is_finite() { id } else { 0.0 }
    }

    /// Difference of the picture from the coarse one.
    #[inline(always)]
    fn missing(&self, at: [i32; 2]) -> f32 {
        difference(self.picture(at), self.pass.inputs[3].pixel4(at[0], at[1]))
    }

    /// 1 where the picture is all of one colour around the seed, 0 where it is not.
    #[inline(always)]
    fn flatness(&self, middle: [f32; 4]) -> f32 {
        let far = FLAT_WITHIN * self.params.half_width;
        let mut varied = 0.0f32;
        for [u, v] in [[0.0, far], [0.0, -far], [far, 0.0], [-far, 0.0]] {
            varied = varied.at_least(difference(self.smooth(self.pixel(u, v)), middle));
        }
        1.0 - rise(varied / NOT_FLAT)
    }

    /// Half length of the stroke on one side, and the colours along it, added to `sum`.
    #[inline(always)]
    fn end(&self, along: f32, middle: [f32; 4], thing: f32, sum: &mut [f32; 4]) -> f32 {
        let length = self.params.half_length;
        let step = length / STEPS as f32;
        let mut before = 0.0;
        for i in 1..=STEPS {
            let u = i as f32 * step;
            let at = self.pixel(along * u, 0.5 * self.curvature * u * u);
            let c = self.picture(at);
            if c[3] < 0.5 || (self.id(at) - thing).abs() > 0.5 {
                return u - 0.5 * step;
            }
            let now = difference(self.smooth(at), middle);
            if now > self.params.tolerance {
                // Between two steps, so that ends do not jump.
                return u - step
                    * (1.0 - (self.params.tolerance - before) / (now - before).at_least(1e-3))
                        .within(0.0, 1.0);
            }
            before = now;
            let far = u * self.params.inverse_smoothing;
            let counts = 1.0 / (1.0 + far * far);
            for k in 0..3 {
                sum[k] += c[k] * counts;
            }
            sum[3] += counts;
        }
        length
    }
}

#[inline(always)]
fn seed<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, cell: [i32; 2]) -> Record {
    const NONE: Record = [[0.0; 4]; 3];
    let own = pass.inputs[0].pixel4(cell[0], cell[1]);
    let corner = [0, 1].map(|i| (cell[i] as f32 * params.cell - params.offset[i]) as i32);
    let place = [own[0], own[1]];
    let share = prominence(pass, params, cell, own);
    if share <= LEAST {
        return NONE;
    }
    let at = [0, 1].map(|i| corner[i] + place[i].floor() as i32);
    let mut around = Surroundings { pass, params, corner, place, tangent: [1.0, 0.0], curvature: 0.0 };
    let (field, bend) = direction(simd, &around, at);
    around.tangent = field;
    around.curvature = (bend * params.curve).within(-MOST_TURN, MOST_TURN) / params.half_length;
    let middle = around.picture(at);
    if middle[3] < 0.5 {
        return NONE;
    }
    let smooth = around.smooth(at);
    let slope = MOST_SLOPE * around.flatness(smooth) * wave(own[2] * 3.0 + 0.7);
    let length = (1.0 + slope * slope).sqrt();
    let tangent = [(field[0] - field[1] * slope) / length, (field[1] + field[0] * slope) / length];
    around.tangent = tangent;
    let thing = around.id(at);
    let mut sum = [middle[0], middle[1], middle[2], 1.0];
    let forth = around.end(1.0, smooth, thing, &mut sum);
    let back = around.end(-1.0, smooth, thing, &mut sum);
    let w = params.half_width;
    let splat = |v: f32| f32x8::splat(simd, v);
    let vary = 0.85 + 0.3 * noise(simd, splat(own[2] * 75.0), splat(7.0), 3)[0];

    let (mut room, mut missing) = (0.6, 0.0);
    for along in [1.0, -1.0] {
        let apart = difference(around.smooth(around.pixel(0.0, along * 0.8 * w)), smooth);
        room += 0.2 - 0.2 * rise(2.0 * apart / params.tolerance - 1.5);
        missing += around.missing(around.pixel(0.0, along * 0.7 * w));
        missing += around.missing(around.pixel(along * 0.35 * params.half_length, 0.0));
    }
    missing = 0.2 * (missing + around.missing(at));
    let wanted = if params.threshold < 0.0 { 1.0 } else { rise(missing / params.threshold - 1.0) };
    let share = (share * wanted - LEAST) * (1.0 / (1.0 - LEAST));
    let width = w * room * share.at_least(0.0);
    // A stroke that comes or goes is small, not thin.
    let longer = vary * (0.4 + 0.6 * share.within(0.0, 1.0));
    let (forth, back) = ((forth * longer).at_least(width), (back * longer).at_least(width));
    let [l, a, b] = varied([sum[0] / sum[3], sum[1] / sum[3], sum[2] / sum[3]], own[2], params);
    [
        [place[0], place[1], own[2], width],
        [tangent[0] * back, tangent[1] * back, around.curvature, forth],
        [l, a, b, thing],
    ]
}

/// A stroke's own colour: `colour`, a little lighter or darker, greyer or of another hue, as its rank has it.
#[inline(always)]
fn varied([l, a, b]: [f32; 3], rank: f32, params: &Params) -> [f32; 3] {
    let grey = 1.0 + 0.04 * params.variation * wave(rank * 5.0);
    let hue = params.hue_variation * wave(rank * 11.0 + 0.3);
    [l + params.variation * wave(rank * 7.0), (a - b * hue) * grey, (b + a * hue) * grey]
}

/// The tangent at a seed, and how far it turns over the length of a stroke.
#[inline(always)]
fn direction<S: Simd>(simd: S, around: &Surroundings<'_>, seed: [i32; 2]) -> ([f32; 2], f32) {
    let tensor = |at: [i32; 2]| around.pass.inputs[1].pixel4(at[0], at[1]);
    let [tx, ty] = tangents(simd, [tensor(seed); 2])[0];
    let along = Surroundings { tangent: [tx, ty], ..*around };
    let half = 0.5 * around.params.half_length;
    let ends = tangents(simd, [tensor(along.pixel(half, 0.0)), tensor(along.pixel(-half, 0.0))]);
    // About the sine of the angle between tangents, whose signs mean nothing.
    let turn = |[ox, oy]: [f32; 2]| {
        let sine = tx * oy - ty * ox;
        if tx * ox + ty * oy < 0.0 { -sine } else { sine }
    };
    ([tx, ty], turn(ends[0]) - turn(ends[1]))
}

#[inline(always)]
fn tangents<S: Simd>(simd: S, [a, b]: [[f32; 4]; 2]) -> [[f32; 2]; 2] {
    let lanes = |c: usize| f32x8::from_slice(simd, &[a[c], b[c], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let [x, y] = tensor::tangent(lanes(0), lanes(1), lanes(2));
    [[x[0], y[0]], [x[1], y[1]]]
}

/// Difference of two colours in Lab.
#[inline(always)]
fn difference(a: [f32; 4], b: [f32; 4]) -> f32 {
    let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
}

/// A triangle wave from -1 to 1.
#[inline(always)]
fn wave(v: f32) -> f32 {
    4.0 * (v - v.floor() - 0.5).abs() - 1.0
}

/// A smooth ramp from 0 to 1.
#[inline(always)]
fn rise(t: f32) -> f32 {
    let t = t.within(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
