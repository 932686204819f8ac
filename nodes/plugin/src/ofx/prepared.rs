//! The plan for a frame, over pixels that are square.

use super::frame::Frame;
use super::host::Properties;
use super::known::Known;
use crate::pixel_aspect::SquarePixels;
use isophote::engine::plan::{LEAST_ROWS, WORKING_MEMORY};
use isophote::engine::{Plan, Rect};
use isophote::{ColourSpace, Planned, Request};
use isophote_abi::openfx::*;

/// Quality that a host asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// The picture as it is.
    Full,
    /// A picture of half the size, made larger: for looking at while values change.
    Draft,
}

impl Quality {
    /// Quality that the arguments of a render name.
    pub fn of(args: Properties<'_>) -> Self {
        match args.int(kOfxImageEffectPropRenderQualityDraft, 0) {
            Some(wanted) if wanted != 0 => Self::Draft,
            _ => Self::Full,
        }
    }
}

/// The plan for a frame, over square pixels.
#[derive(Debug)]
pub struct Prepared {
    /// Plan that is run.
    pub planned: Planned,
    /// Its pixels, where they are others than the host's. Colour is multiplied by alpha in them.
    pub square: Option<SquarePixels>,
}

impl Prepared {
    /// The plan for a frame of which this is known.
    ///
    /// # Errors
    /// Memory; failed, when the graph cannot be planned.
    pub fn new(
        known: &Known,
        space: ColourSpace,
        frame: &Frame,
        premultiplied: bool,
        quality: Quality,
    ) -> isophote::Result<Self> {
        let plan = |[width, height]: [u32; 2], scale, premultiplied| {
            Planned::new(
                &known.graph,
                Request {
                    scale,
                    space,
                    premultiplied,
                    guides: known.guides,
                    frames: known.frames,
                    origin: frame.origin(),
                    frame: frame.number,
                    reference_height: frame.reference_height,
                    canonical_height: frame.canonical_height(),
                    ..Request::new(width, height)
                },
            )
        };
        if quality == Quality::Draft {
            let square = SquarePixels::halved(frame.size(), frame.ratio);
            let planned = plan(square.size(), square.scale, true)?;
            return Ok(Self { planned, square: Some(square) });
        }
        if frame.is_square() {
            return Ok(Self { planned: plan(frame.size(), frame.scale, premultiplied)?, square: None });
        }
        let mut square = SquarePixels::of(frame.size(), frame.ratio);
        let mut planned = plan(square.size(), square.scale, true)?;
        if least_memory(planned.plan()) > WORKING_MEMORY[1] {
            square = SquarePixels::as_many(frame.size(), frame.ratio);
            planned = plan(square.size(), square.scale, true)?;
        }
        Ok(Self { planned, square: Some(square) })
    }

    /// The same for pictures with light beyond their coverage. It reads no more of them.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn emissive(&self, known: &Known) -> isophote::Result<Planned> {
        Planned::new(&known.graph, Request { emission: true, ..*self.planned.request() })
    }

    /// The same for motion that is nowhere longer than `longest` pixels along x and along y, which reads less around.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn for_motion(&self, known: &Known, longest: f32) -> isophote::Result<Planned> {
        let request = *self.planned.request();
        // What is interpolated between vectors is rounded.
        let max_motion = ((longest + 1.0) / request.scale).min(request.max_motion);
        Planned::new(&known.graph, Request { max_motion, ..request })
    }

    /// Rendered pixels per canonical unit, in x and y.
    pub fn ratio(&self, frame: &Frame) -> [f64; 2] {
        self.square.map_or(frame.ratio, |square| [f64::from(square.scale); 2])
    }

    /// The part of the plan's result that `region` of the frame is made from.
    pub fn plan_window(&self, region: Rect) -> Rect {
        self.square.map_or(region, |square| square.square_window(region))
    }

    /// The part of each of the plan's images that `region` of the frame needs.
    pub fn windows(&self, region: Rect) -> Vec<Rect> {
        self.planned.plan().windows(self.plan_window(region))
    }

    /// The host's pixels that a part of an image is made from.
    pub fn host_window(&self, window: Rect) -> Rect {
        self.square.map_or(window, |square| square.host_window(window))
    }

    /// Rows of the host's in one band of a run of `plan`, which is this one's or what is left of it.
    pub fn band_rows(&self, plan: &Plan, region: Rect) -> i32 {
        let window = self.plan_window(region);
        let mut rows = plan.band_rows(window, WORKING_MEMORY, LEAST_ROWS);
        let first = Rect { y1: (window.y0 + rows).min(window.y1), ..window };
        if plan.peak_bytes(&plan.windows(first)) > WORKING_MEMORY[1] {
            // No band keeps within the bound: each would be computed from nearly all, again and again.
            rows = window.height() as i32;
        }
        if self.square.is_none() {
            return rows;
        }
        let share = f64::from(rows) / f64::from(window.height().max(1));
        ((share * f64::from(region.height())) as i32).max(1)
    }
}

/// Bytes that the images of the whole picture take, in the bands that take least.
fn least_memory(plan: &Plan) -> u64 {
    let [width, height] = plan.size();
    let all = Rect::of_size(width, height);
    let rows = plan.band_rows(all, WORKING_MEMORY, LEAST_ROWS);
    let middle = (all.y1 - rows) / 2;
    plan.peak_bytes(&plan.windows(Rect { y0: middle, y1: middle + rows, ..all }))
}

#[cfg(test)]
mod tests {
    use super::super::effects::{EFFECTS, Form};
    use super::super::motion::MotionFrom;
    use super::*;
    use isophote::frames::Frames;
    use isophote::request::Guides;

    #[test]
    fn what_looks_at_whole_pictures_is_no_band() {
        let picture = [0, 0, 7680, 4320];
        let frame = Frame { picture, ratio: [1.0; 2], scale: 1.0, top: None, number: 0, reference_height: 0 };
        let whole = Rect::of_size(7680, 4320);
        for effect in EFFECTS.iter().filter(|effect| effect.temporal) {
            let (mut graph, ids) = effect.graph(false).unwrap();
            graph.set(ids[0], "steadiness", isophote::Value::Float(0.5)).unwrap();
            for vectors in [true, false] {
                let has = Guides { motion: vectors, ..Guides::default() };
                let known = Known::of(&graph, MotionFrom::default(), has, true).unwrap();
                assert_ne!(known.frames, Frames::NONE);
                let prepared =
                    Prepared::new(&known, ColourSpace::Linear, &frame, true, Quality::Full).unwrap();
                let rows = prepared.band_rows(prepared.planned.plan(), whole);
                let bytes = prepared.planned.plan().peak_bytes(&prepared.windows(Rect { y1: rows, ..whole }));
                let gib = bytes as f64 / (1_u64 << 30) as f64;
                println!("{:?}, vectors {vectors}: {rows} rows, {gib:.2} GiB", effect.identifier);
                assert!(
                    rows == 4320 || (vectors && bytes <= WORKING_MEMORY[1]),
                    "{rows} rows take {gib:.2} GiB"
                );
                assert!(bytes <= 21 << 29, "{gib:.2} GiB");
            }
        }
    }

    #[test]
    fn an_8k_frame_of_any_pixels_fits_into_4_gib_and_a_quarter() {
        let guides = Guides { normal: true, depth: true, ..Guides::default() };
        for par in [0.5, 1.0, 1.0667, 2.0, 20.0] {
            let picture = [0, 0, 7680, 4320];
            let frame = Frame {
                picture,
                ratio: [1.0 / par, 1.0],
                scale: 1.0 / par.min(1.0) as f32,
                top: None,
                number: 0,
                reference_height: 0,
            };
            let whole = Rect::of_size(7680, 4320);
            let bytes = |window: Rect| window.area() * 16;
            for effect in EFFECTS.iter() {
                for over in [false, true] {
                    if over && effect.form != Form::Lines {
                        continue;
                    }
                    let (graph, _) = effect.graph(over).unwrap();
                    let known = Known { graph, guides, frames: Frames::NONE };
                    let prepared =
                        Prepared::new(&known, ColourSpace::Linear, &frame, true, Quality::Full).unwrap();
                    let rows = prepared.band_rows(prepared.planned.plan(), whole);
                    let middle = (4320 - rows) / 2;
                    let band = Rect { y0: middle, y1: middle + rows, ..whole };
                    let (plan, windows) = (prepared.planned.plan(), prepared.windows(band));
                    // The host's pixels of a guide or the colour are gone when the last are resampled.
                    let read = plan.inputs().iter().map(|port| windows[port.image.index()]);
                    let read = read.map(|w| bytes(w) + 2 * bytes(prepared.host_window(w))).sum::<u64>();
                    let most = 2 * bytes(whole) + plan.peak_bytes(&windows).max(read);
                    let gib = most as f64 / (1_u64 << 30) as f64;
                    println!("{:?} at {par}: {rows} rows, {gib:.2} GiB", effect.identifier);
                    assert!(most <= 17 << 28, "{:?} at {par}: {gib:.2} GiB", effect.identifier);
                }
            }
        }
    }
}
