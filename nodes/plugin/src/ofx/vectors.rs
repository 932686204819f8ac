//! Vectors of clips: the motion between frames as it is read for a plan, in pixels of the plan.

use super::clips::{MOTION, MOTION_FORWARD};
use super::content;
use super::contents::Content;
use super::frame::is_endless;
use super::host::Outcome;
use super::image::{Clip, Fetched};
use super::inputs::Inputs;
use super::prepared::Prepared;
use super::stop::Stop;
use crate::pool;
use isophote::engine::cpu::Threads;
use isophote::engine::{Image, Rect};
use isophote::graph::GraphInput;
use isophote_abi::openfx::*;
use isophote_motion::Way;
use std::ffi::CStr;

/// The clips of vectors, with what they are to a plan.
const CLIPS: [(&CStr, GraphInput); 2] =
    [(MOTION, GraphInput::Motion), (MOTION_FORWARD, GraphInput::MotionForward)];

impl<'h> Inputs<'h> {
    /// Channels of the images of vectors, to the frame before and to the one after; 0 where there is none.
    pub fn vector_channels(&self) -> [usize; 2] {
        CLIPS.map(|(_, guide)| self.guide(guide).map_or(0, |image| image.channels as usize))
    }

    /// Vectors of one way in a frame, in pixels of the plan. What an image does not hold is unknown.
    pub fn vectors(
        &self,
        prepared: &Prepared,
        way: Way,
        offset: i32,
        window: Rect,
        threads: &dyn Threads,
    ) -> Result<Option<Image>, Stop> {
        let mut counts = self.vector_channels();
        while let Some((from, channels, rule)) = self.convention.among(way, counts) {
            let (name, guide) = CLIPS[usize::from(from == Way::Forward)];
            let mut fetched = None;
            let image = self.of_vectors(name, guide, offset, &mut fetched)?;
            let clip = Clip::of(self.host, self.instance, name);
            let par = image.and_then(|image| image.aspect).or(clip.map(|clip| clip.aspect())).unwrap_or(1.0);
            let defined = clip.and_then(|clip| clip.defined(self.time + f64::from(offset)));
            let (size, ratio) = (self.full_size(defined, par), prepared.ratio(&self.frame));
            let [x, y] = [ratio[0] * par, ratio[1]].map(|pixels| pixels as f32);
            let change = |row: &mut [f32]| {
                rule.apply(row, size);
                for vector in row.chunks_exact_mut(2) {
                    (vector[0], vector[1]) = (vector[0] * x, vector[1] * y);
                }
            };
            let read = |image: &Fetched<'_>| {
                self.of_field(window, |w| image.read_pairs(&self.frame, w, channels, threads, &change))
            };
            if let Some(pairs) = image.map(read).map_or(Ok(None), present)? {
                return Ok(Some(pairs));
            }
            drop(fetched);
            // The other image may have them reversed.
            counts[usize::from(from == Way::Forward)] = 0;
        }
        if offset != 0 {
            return Ok(None);
        }
        let mut unknown = pool::image(window, 2).map_err(|_| kOfxStatErrMemory)?;
        unknown.data_mut().fill(f32::NAN);
        Ok(Some(unknown))
    }

    /// Content of all that vectors of either way in a frame are read from, for the rows of `part`, a part of `window` of the plan;
    /// none where there is nothing, or the host gave too little of it for a part of the picture.
    pub fn content_of_vectors(
        &self,
        prepared: &Prepared,
        offset: i32,
        [window, part]: [Rect; 2],
        threads: &dyn Threads,
    ) -> Result<Option<Content>, Stop> {
        let [window, part] = [window, part].map(|window| self.grown(prepared.host_window(window)));
        let ratio = prepared.ratio(&self.frame);
        let rule = format!("{:?} {:?} {ratio:?} {window:?}", self.convention, self.vector_channels());
        let (mut form, mut images) = (vec![content::of_text(&rule)], Vec::new());
        for (name, guide) in CLIPS {
            let mut fetched = None;
            let Some(image) = self.of_vectors(name, guide, offset, &mut fetched)? else {
                form.push(0);
                continue;
            };
            if !self.is_held(Some(name), offset, image, part) {
                return Ok(None);
            }
            let clip = Clip::of(self.host, self.instance, name);
            let defined = clip.and_then(|clip| clip.defined(self.time + f64::from(offset)));
            let [width, height] = self.full_size(defined, 1.0);
            let aspects = [image.aspect, clip.map(|clip| clip.aspect())];
            form.push(content::of_text(&format!("{aspects:?} {width} {height} {:?}", self.field)));
            images.push(image.rows(&self.frame, window, part, threads)?);
        }
        Ok((!images.is_empty()).then(|| Content { form: content::of_all(&form), images }))
    }

    /// The image of a clip of vectors in a frame; `fetched` holds that of another frame.
    fn of_vectors<'i>(
        &'i self,
        name: &CStr,
        guide: GraphInput,
        offset: i32,
        fetched: &'i mut Option<Fetched<'h>>,
    ) -> Result<Option<&'i Fetched<'h>>, Stop> {
        if offset == 0 {
            return Ok(self.guide(guide));
        }
        *fetched = self.neighbour(name, offset)?.map(|(_, image)| image);
        Ok(fetched.as_ref())
    }

    /// Columns and rows of a clip's picture at full size.
    fn full_size(&self, defined: Option<OfxRectD>, par: f64) -> [f32; 2] {
        let region =
            defined.filter(|region| !is_endless(region) && region.x1 < region.x2 && region.y1 < region.y2);
        let [x1, y1, x2, y2] = match region {
            Some(OfxRectD { x1, y1, x2, y2 }) => [x1, y1, x2, y2],
            None => self.frame.canonical(self.frame.picture),
        };
        [((x2 - x1) / par) as f32, (y2 - y1) as f32]
    }
}

/// Image that was read; none where it is not fit for the input, which leaves no memory out.
fn present(read: Outcome<Image>) -> Result<Option<Image>, Stop> {
    match read {
        Err(status) if status != kOfxStatErrMemory => Ok(None),
        read => Ok(Some(read?)),
    }
}
