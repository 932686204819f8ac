//! Places and regions: OpenFX counts canonical units and pixels upwards from the bottom, the engine counts
//! rows of the picture downwards from the top.

use super::host::Host;
use crate::pixel_aspect::is_square;
use isophote::Request;
use isophote::engine::Rect;
use isophote::engine::image::MAX_SIDE;
use isophote_abi::openfx::*;

/// A rectangle of the host's pixels, y up.
pub type Bounds = [i32; 4];

/// The picture that an effect works on at one time and scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The whole picture, in the host's pixels.
    pub picture: Bounds,
    /// Pixels per canonical unit, in x (with the pixel aspect ratio in it) and in y.
    pub ratio: [f64; 2],
    /// Pixels per canonical unit where they are square; of others, along the finer side.
    pub scale: f32,
    /// Top of the project (canonical), where the host tells.
    pub top: Option<f64>,
    /// Number of the frame.
    pub number: i64,
    /// Height of pictures at which lengths are meant; 0: any.
    pub reference_height: u32,
}

/// Share of a pixel below which differences are rounding.
const ROUNDING: f64 = 1e-3;
/// A side of a region that lies farther out (canonical) has no bound. Hosts write infinities, the greatest
/// float, the greatest integer or a million.
const ENDLESS: f64 = 500_000.0;
/// Place where the picture ends on a side without a bound (canonical): farther out than hosts render, near enough for
/// positions in floats to be exact to a hundredth of a pixel.
const REACH: f64 = 16_384.0;

impl Frame {
    /// The frame of a clip with the region of definition `defined` (canonical), rendered at `scale`, with
    /// pixels of the aspect ratio `par`. `bounds` are those of its image, once there is one.
    pub fn new(
        host: &Host,
        defined: Option<OfxRectD>,
        scale: [f64; 2],
        par: f64,
        bounds: Option<Bounds>,
    ) -> Option<Self> {
        let ratio = [scale[0] / par, scale[1]];
        let endless = defined.as_ref().is_some_and(is_endless);
        let rounded = defined.and_then(|region| to_pixels(&region, ratio));
        let (picture, share) = match (rounded, bounds) {
            (Some(picture), None) => (picture, 1.0),
            (None, Some(bounds)) => (bounds, 1.0),
            (None, None) => return None,
            // Hosts without tiles have been seen to give parts as well; a part is not shaped like the whole.
            (Some(picture), Some(bounds))
                if is_within(&bounds, &picture)
                    && (host.tiles || endless || !is_smaller_whole(&picture, &bounds)) =>
            {
                // The image is a part of the picture, or the picture itself with other rounding.
                let is_same = (0..4).all(|i| picture[i].abs_diff(bounds[i]) <= 1);
                (if is_same { bounds } else { picture }, 1.0)
            }
            // A host of whole pictures that gives another one than it speaks of: one that says
            // "full size" of a proxy has forgotten the scale, others have their own idea of regions.
            (Some(picture), Some(bounds)) => {
                let is_full = scale == [1.0; 2] && !endless;
                (bounds, if is_full { forgotten_scale(&picture, &bounds) } else { 1.0 })
            }
        };
        let ratio = ratio.map(|r| r * share);
        let size = [0, 1].map(|i| i64::from(picture[i + 2]) - i64::from(picture[i]));
        if size.iter().any(|s| *s <= 0 || *s > i64::from(MAX_SIDE)) {
            return None;
        }
        let scale = match ratio {
            [x, y] if x == y => x,
            [x, y] if is_square(ratio) => (x * y).sqrt(),
            [x, y] => x.max(y),
        };
        (scale.is_finite() && scale > 0.0).then(|| Self {
            picture,
            ratio,
            scale: scale.clamp(1.0 / 1024.0, 64.0) as f32,
            top: None,
            number: 0,
            reference_height: 0,
        })
    }

    /// The same at a time of a project that ends at `top` (canonical).
    pub fn in_project(self, top: Option<f64>, time: f64) -> Self {
        Self { top, number: time.floor() as i64, ..self }
    }

    /// The same for lengths that are meant at a height of pictures; 0: at any.
    pub fn for_reference(self, reference_height: u32) -> Self {
        Self { reference_height, ..self }
    }

    /// The height that a reference is compared with, in canonical units: the project's; 0 where that is not known.
    pub fn canonical_height(&self) -> u32 {
        let height = self.top.map_or(0.0, f64::round);
        if (1.0..=f64::from(MAX_SIDE)).contains(&height) { height as u32 } else { 0 }
    }

    /// Rendered pixels that a pixel of a length comes to, as the plan's request has it.
    pub fn length_scale(&self) -> f32 {
        let [width, height] = self.size();
        Request {
            scale: self.scale,
            reference_height: self.reference_height,
            canonical_height: self.canonical_height(),
            ..Request::new(width, height)
        }
        .length_scale()
    }

    /// Position of its left top corner in the project, in canonical units downwards from the project's; marks are
    /// anchored to that. Without a project's size rows are counted from the picture's own top.
    pub fn origin(&self) -> [f64; 2] {
        let [x, _, _, y] = self.canonical(self.picture);
        let origin = [x, self.top.map_or(0.0, |top| top - y)];
        // Pictures without a bound begin farther out than marks can be told apart.
        origin.map(|o| if o.abs() < ENDLESS { o } else { 0.0 })
    }

    /// True where its pixels are square, as far as anyone can see.
    pub fn is_square(&self) -> bool {
        is_square(self.ratio)
    }

    /// Size of the picture.
    pub fn size(&self) -> [u32; 2] {
        [0, 1].map(|i| self.picture[i + 2].abs_diff(self.picture[i]))
    }

    /// The pixels of the picture under a rectangle of the host's, rows downwards.
    pub fn inside(&self, bounds: Bounds) -> Rect {
        let [width, height] = self.size().map(|n| n as i32);
        let x = |v: i32| v.saturating_sub(self.picture[0]).clamp(0, width);
        let y = |v: i32| self.picture[3].saturating_sub(v).clamp(0, height);
        Rect { x0: x(bounds[0]), y0: y(bounds[3]), x1: x(bounds[2]), y1: y(bounds[1]) }
    }

    /// The pixels under a canonical region, those beside the picture too.
    pub fn around(&self, region: &OfxRectD) -> Option<Rect> {
        let bounds = self.pixels(region)?;
        let x = |v: i32| v.saturating_sub(self.picture[0]);
        let y = |v: i32| self.picture[3].saturating_sub(v);
        Some(Rect { x0: x(bounds[0]), y0: y(bounds[3]), x1: x(bounds[2]), y1: y(bounds[1]) })
    }

    /// The other way.
    pub fn outside(&self, rect: Rect) -> Bounds {
        let [left, _, _, top] = self.picture;
        [left + rect.x0, top - rect.y1, left + rect.x1, top - rect.y0]
    }

    /// The pixels under a canonical region.
    pub fn pixels(&self, region: &OfxRectD) -> Option<Bounds> {
        to_pixels(region, self.ratio)
    }

    /// The canonical region of pixels.
    pub fn canonical(&self, bounds: Bounds) -> [f64; 4] {
        [0, 1, 2, 3].map(|i| f64::from(bounds[i]) / self.ratio[i % 2])
    }
}

/// True when `bounds` lie within `picture`, to a pixel.
fn is_within(bounds: &Bounds, picture: &Bounds) -> bool {
    (0..4).all(|i| {
        let beyond = i64::from(picture[i]) - i64::from(bounds[i]);
        (if i < 2 { beyond } else { -beyond }) <= 1
    })
}

/// The scale of a proxy of `picture` with these bounds, where it is too far from 1 for rounding.
fn forgotten_scale(picture: &Bounds, bounds: &Bounds) -> f64 {
    let widths = [picture, bounds].map(|b| f64::from(b[2]) - f64::from(b[0]));
    let share = widths[1] / widths[0].max(1.0);
    let is_scale = !(0.98..=1.02).contains(&share) && share.is_finite() && share > 0.0;
    if is_scale { share } else { 1.0 }
}

/// True where `bounds` are `picture` made smaller, to a pixel.
fn is_smaller_whole(picture: &Bounds, bounds: &Bounds) -> bool {
    let side = |b: &Bounds, i: usize| f64::from(b[i + 2]) - f64::from(b[i]);
    let share = side(bounds, 0) / side(picture, 0).max(1.0);
    (0..4).all(|i| (f64::from(picture[i]) * share - f64::from(bounds[i])).abs() <= 1.0)
}

/// True where a region has a side without a bound.
pub fn is_endless(region: &OfxRectD) -> bool {
    let OfxRectD { x1, y1, x2, y2 } = *region;
    [x1, y1, x2, y2].iter().any(|side| side.abs() > ENDLESS)
}

/// The region with the sides of `within` where it has no bound.
pub fn bounded(region: &OfxRectD, within: &OfxRectD) -> OfxRectD {
    let side = |side: f64, bound: f64| if side.abs() > ENDLESS { bound } else { side };
    OfxRectD {
        x1: side(region.x1, within.x1),
        y1: side(region.y1, within.y1),
        x2: side(region.x2, within.x2),
        y2: side(region.y2, within.y2),
    }
}

/// The pixels that a region touches; `None` when it is empty. Sides without a bound are put where no tile
/// moves them, so that tiles are parts of one picture.
fn to_pixels(region: &OfxRectD, ratio: [f64; 2]) -> Option<Bounds> {
    if region.x1 >= region.x2 || region.y1 >= region.y2 {
        return None;
    }
    // Halved until the picture is one that the engine can have.
    let most = f64::from(MAX_SIDE / 2) / ratio[0].max(ratio[1]);
    let reach = REACH * (most / REACH).log2().floor().min(0.0).exp2();
    let region = bounded(region, &OfxRectD { x1: -reach, y1: -reach, x2: reach, y2: reach });
    let low = |v: f64, r: f64| (v * r + ROUNDING).floor();
    let high = |v: f64, r: f64| (v * r - ROUNDING).ceil();
    let sides = [
        low(region.x1, ratio[0]),
        low(region.y1, ratio[1]),
        high(region.x2, ratio[0]),
        high(region.y2, ratio[1]),
    ];
    let finite = sides.iter().all(|v| v.is_finite() && v.abs() < f64::from(1 << 24));
    (finite && sides[0] < sides[2] && sides[1] < sides[3]).then(|| sides.map(|v| v as i32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_survive_the_way_to_canonical_units_and_back() {
        let frame = Frame {
            picture: [-3, 5, 61, 45],
            ratio: [0.5 / 1.0667, 0.5],
            scale: 0.5,
            top: None,
            number: 0,
            reference_height: 0,
        };
        for bounds in [[-3, 5, 61, 45], [0, 6, 1, 7], [-2, 30, 17, 44]] {
            let [x1, y1, x2, y2] = frame.canonical(bounds);
            assert_eq!(frame.pixels(&OfxRectD { x1, y1, x2, y2 }), Some(bounds));
            assert_eq!(frame.outside(frame.inside(bounds)), bounds);
        }
        assert_eq!(frame.inside([-3, 44, -2, 45]), Rect { x0: 0, y0: 0, x1: 1, y1: 1 });
        assert_eq!(frame.inside([-100, -100, 100, 100]), Rect::of_size(64, 40));
        let empty = OfxRectD { x1: 4.0, y1: 0.0, x2: 4.0, y2: 4.0 };
        assert_eq!(frame.pixels(&empty), None);
    }

    #[test]
    fn a_side_without_a_bound_is_put_where_every_tile_finds_it() {
        let most = f64::from(i32::MAX);
        for (low, high) in
            [(-most - 1.0, most), (f64::NEG_INFINITY, f64::INFINITY), (-1e6, 1e6), (f64::MIN, f64::MAX)]
        {
            let all = OfxRectD { x1: low, y1: low, x2: high, y2: high };
            assert!(is_endless(&all));
            assert_eq!(to_pixels(&all, [1.0; 2]), Some([-16384, -16384, 16384, 16384]));
            assert_eq!(to_pixels(&all, [0.25, 0.5]), Some([-4096, -8192, 4096, 8192]));
            // No picture has more pixels on a side than the engine's may.
            assert_eq!(to_pixels(&all, [64.0, 1.0]), Some([-32768, -512, 32768, 512]));
            let above = OfxRectD { x1: 5.0, y1: 7.0, x2: 90.0, y2: high };
            assert_eq!(to_pixels(&above, [1.0; 2]), Some([5, 7, 90, 16384]));
        }
        assert!(!is_endless(&OfxRectD { x1: -7680.0, y1: 0.0, x2: 60_000.0, y2: 4.0 }));
    }

    #[test]
    fn a_proxy_is_told_from_a_part() {
        let picture = [0, 0, 200, 140];
        for (bounds, smaller) in [
            ([0, 0, 100, 70], true),
            ([0, 0, 67, 47], true),
            ([60, 30, 126, 96], false),
            ([0, 0, 200, 70], false),
        ] {
            assert_eq!(is_smaller_whole(&picture, &bounds), smaller, "{bounds:?}");
        }
    }
}
