//! Results of segments that are kept for the other parts of them. A part is found again by the rows that it alone is made
//! from: its own, and as many around as passes and the longest vector reach. They are fewer than those of the segment, all
//! of which the first part looks at.

use super::content;
use super::contents::Content;
use super::executors::Executors;
use super::faults;
use super::inputs::{Gathered, Taken};
use super::kept;
use super::made::{self, Made};
use super::neighbours::Looked;
use super::plans::{Bands, Plans};
use super::segments::Part;
use super::stop::Stop;
use isophote::engine::plan::Port;
use isophote::engine::{Image, Plan, Rect};
use isophote::graph::GraphInput;
use isophote_abi::openfx::*;
use isophote_motion::Way;
use std::sync::Arc;
use std::time::Duration;

/// After so long a thread computes a part by itself of which another was to compute the segment.
const PATIENCE: Duration = Duration::from_secs(60);

/// Image of a plan whose content is wanted, or the vectors of one of its frames.
#[derive(Clone, PartialEq)]
struct Wanted {
    /// A name for it.
    name: String,
    /// The plan's image; one of them, where there are vectors of both ways.
    port: Port,
    /// The part of it that a segment needs.
    window: Rect,
    /// Rows of that which count.
    part: Rect,
}

/// Content that was looked at.
enum Seen {
    /// It, where there is such an image.
    Content(Option<Content>),
    /// The host gave too little of it.
    TooLittle,
    /// This frame, counted from the one that is rendered, lacks an image.
    Without(i32),
}

impl Wanted {
    /// Images that a plan reads, by the parts of its images that a segment needs, and by those that count.
    fn of(plan: &Plan, windows: &[Rect], parts: &[Rect]) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for port in plan.inputs() {
            let [window, part] = [windows, parts].map(|all| all[port.image.index()]);
            let Some(input) = GraphInput::from_id(port.base()).filter(|_| !window.is_empty()) else {
                continue;
            };
            if part.is_empty() {
                continue;
            }
            let name = if input.is_motion() { format!("vectors {}", port.frame) } else { port.name.clone() };
            match all.iter_mut().find(|wanted| wanted.name == name) {
                Some(wanted) => {
                    (wanted.window, wanted.part) = (wanted.window.union(&window), wanted.part.union(&part));
                }
                None => all.push(Self { name, port: port.clone(), window, part }),
            }
        }
        all
    }

    fn is_vectors(&self) -> bool {
        self.name != self.port.name
    }
}

/// True for an image of vectors.
fn is_vectors(port: &Port) -> bool {
    GraphInput::from_id(port.base()).is_some_and(|input| input.is_motion())
}

impl Plans<'_, '_> {
    /// The plan's result over the segment of a part, which is kept for the other parts of it; none where the part is all of
    /// it, or the host gave too little.
    ///
    /// # Errors
    /// As reading and running.
    pub fn find_result(
        &mut self,
        part: Part,
        executors: &mut Executors<'_>,
        work: &Bands<'_>,
    ) -> Result<Option<Arc<Image>>, Stop> {
        let Some(segment) = part.segment.filter(|segment| *segment != part.inside) else { return Ok(None) };
        if let Some(image) = self.result_of_before(segment, work)? {
            return Ok(Some(image));
        }
        let Some(contents) = self.look_through(segment, work)? else { return Ok(None) };
        let name = self.result_number(segment, |port| number_of(&contents, port));
        let stops = || work.control.cancelled.is_some_and(|cancelled| cancelled());
        let mut is_other = false;
        let found = kept::obtain(&[name], PATIENCE, &stops, |_| {
            if let Some(cpu) = executors.cpu() {
                self.find_stages(part, cpu, work)?;
            }
            let image = self.over(executors, &Bands { inside: segment, ..*work })?;
            // The host may have given something else meanwhile.
            is_other = !self.has_still(&contents, segment, work)?;
            if is_other {
                return Err(kOfxStatFailed.into());
            }
            faults::computed(1);
            Ok(vec![image])
        });
        if is_other {
            return Ok(None);
        }
        let image = found?.pop();
        if !made::has(name) {
            let reach = self.reach(&contents, segment, work)?;
            made::keep(Made { plan: self.plan_number(segment), name, contents, reach });
        }
        Ok(image)
    }

    /// A result of the segment that was kept, where the part that is wanted is made from the same contents.
    fn result_of_before(&self, segment: Rect, work: &Bands<'_>) -> Result<Option<Arc<Image>>, Stop> {
        let plan = self.prepared.planned.plan();
        let windows = self.prepared.windows(segment);
        let inside = self.prepared.plan_window(work.inside);
        // What was looked at for one result counts for the next, too.
        let mut looked: Vec<(Wanted, Content)> = Vec::new();
        'results: for made in made::of(self.plan_number(segment)) {
            let Some(image) = kept::find(made.name) else { continue };
            let parts = made.reach.as_ref().unwrap_or(plan).windows(inside);
            for wanted in Wanted::of(plan, &windows, &parts) {
                let at = match looked.iter().position(|(known, _)| *known == wanted) {
                    Some(at) => at,
                    None => match self.see(&wanted, &windows, work)? {
                        Seen::Content(Some(content)) => {
                            looked.push((wanted.clone(), content));
                            looked.len() - 1
                        }
                        _ => continue 'results,
                    },
                };
                if !made.content(&wanted.name).is_some_and(|all| looked[at].1.is_part_of(all)) {
                    continue 'results;
                }
            }
            return Ok(Some(image));
        }
        Ok(None)
    }

    /// Contents of all that a segment needs; none where the host gave too little of it.
    fn look_through(
        &mut self,
        segment: Rect,
        work: &Bands<'_>,
    ) -> Result<Option<Vec<(String, Content)>>, Stop> {
        'frames: loop {
            let windows = self.prepared.windows(segment);
            let all = Wanted::of(self.prepared.planned.plan(), &windows, &windows);
            let (mut contents, mut looked) = (Vec::new(), Vec::new());
            for wanted in all {
                match self.see(&wanted, &windows, work)? {
                    Seen::Content(Some(content)) => {
                        if !wanted.is_vectors() {
                            let (name, number) = (wanted.name.clone(), content.number());
                            looked.push(Looked { name, window: wanted.window, number });
                        }
                        contents.push((wanted.name, content));
                    }
                    Seen::Content(None) => {}
                    Seen::TooLittle => return Ok(None),
                    Seen::Without(missing) => {
                        self.forget_from(missing)?;
                        continue 'frames;
                    }
                }
            }
            self.looked = looked;
            return Ok(Some(contents));
        }
    }

    /// Looks at a content; `windows` are those of a segment.
    fn see(&self, wanted: &Wanted, windows: &[Rect], work: &Bands<'_>) -> Result<Seen, Stop> {
        let (inputs, prepared, threads) = (self.inputs, &self.prepared, work.threads);
        if wanted.is_vectors() {
            let windows = [wanted.window, wanted.part];
            let content = inputs.content_of_vectors(prepared, wanted.port.frame, windows, threads)?;
            return Ok(content.map_or(Seen::TooLittle, |content| Seen::Content(Some(content))));
        }
        let content = |taken: Taken<'_>| Ok(inputs.content(prepared, &taken, wanted.part, true, threads)?);
        Ok(match inputs.each(prepared, [&wanted.port], windows, threads, content)? {
            Gathered::Without(missing) => Seen::Without(missing),
            Gathered::All(mut all) => match all.pop() {
                Some(None) => Seen::TooLittle,
                found => Seen::Content(found.flatten()),
            },
        })
    }

    /// True where all that was read of other frames for a segment holds what it held. The host's images of the frame itself are
    /// held all the time, and what stages were made from was looked at when it was read.
    fn has_still(
        &self,
        contents: &[(String, Content)],
        segment: Rect,
        work: &Bands<'_>,
    ) -> Result<bool, Stop> {
        let windows = self.prepared.windows(segment);
        for wanted in Wanted::of(&self.cut.plan, &windows, &windows) {
            let known = contents.iter().find(|(name, _)| *name == wanted.name).map(|(_, content)| content);
            if wanted.port.frame != 0
                && !matches!(self.see(&wanted, &windows, work)?, Seen::Content(now) if now.as_ref() == known)
            {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The plan that says from which rows a part of a segment is made, by the longest of its vectors; none where that is not
    /// known, or motion is estimated, which depends on how long it may be.
    fn reach(
        &self,
        contents: &[(String, Content)],
        segment: Rect,
        work: &Bands<'_>,
    ) -> Result<Option<Plan>, Stop> {
        let (plan, windows) = (self.prepared.planned.plan(), self.prepared.windows(segment));
        let request = self.prepared.planned.request();
        let most = request.max_motion * request.scale;
        let mut longest = 0.0_f32;
        for wanted in Wanted::of(plan, &windows, &windows).iter().filter(|wanted| wanted.is_vectors()) {
            let Some((_, content)) = contents.iter().find(|(name, _)| *name == wanted.name) else {
                return Ok(None);
            };
            longest = longest.max(self.longest(wanted, content, most, work)?);
        }
        if longest >= most || self.known.is_estimated() {
            return Ok(None);
        }
        let planned = self.prepared.for_motion(&self.known, longest)?.into_plan();
        Ok(Some(planned).filter(|other| made::are_alike(plan, other)))
    }

    /// Pixels of the longest vector of a frame, along x or y; `most` where that is not known, or it is longer, in which case it
    /// counts for nothing.
    fn longest(&self, wanted: &Wanted, content: &Content, most: f32, work: &Bands<'_>) -> Result<f32, Stop> {
        let (inputs, prepared, frame) = (self.inputs, &self.prepared, wanted.port.frame);
        let of = format!("longest {:?} {:?} {most}", wanted.window, prepared.square);
        let name = content::of_all(&[content::of_text(&of), content.number()]);
        let stops = || work.control.cancelled.is_some_and(|cancelled| cancelled());
        let found = kept::obtain(&[name], kept::PATIENCE, &stops, |_| {
            let mut longest = 0.0_f32;
            for way in [Way::Backward, Way::Forward] {
                let window = prepared.host_window(wanted.window);
                let read = inputs.vectors(prepared, way, frame, window, work.threads)?;
                let image = read.ok_or(kOfxStatFailed)?;
                let known = image.data().iter().map(|v| v.abs()).filter(|v| *v <= most);
                longest = longest.max(known.fold(0.0, f32::max));
                crate::pool::keep_image(image);
            }
            let windows = [wanted.window; 2];
            let now = inputs.content_of_vectors(prepared, frame, windows, work.threads)?;
            if now.as_ref() != Some(content) {
                return Err(kOfxStatFailed.into());
            }
            Ok(vec![Image::from_vec(1, 1, 1, vec![longest]).map_err(|_| kOfxStatErrMemory)?])
        });
        match found {
            Err(Stop::Aborted) => Err(Stop::Aborted),
            found => Ok(found.ok().and_then(|all| Some(*all.first()?.data().first()?)).unwrap_or(most)),
        }
    }

    /// Number of the plan's passes over a segment, and of all that is done to pixels before them.
    fn plan_number(&self, segment: Rect) -> u128 {
        self.result_number(segment, |_| 0)
    }

    /// Number of the plan's result over a segment: of all that it is made from, by the numbers of what is read.
    fn result_number(&self, segment: Rect, content: impl Fn(&Port) -> u128) -> u128 {
        let plan = self.prepared.planned.plan();
        let names = plan.names(|port| content::of_all(&[content::of_text(&port.name), content(port)]));
        let treatment = format!("result {} {segment:?} {:?}", self.treatment(), self.prepared.square);
        let outputs = plan.outputs().iter().map(|port| names[port.image.index()]);
        content::of_all(&[content::of_text(&treatment), content::of_all(&outputs.collect::<Vec<_>>())])
    }
}

/// Number of what an image of a plan holds; 0 where there is none.
fn number_of(contents: &[(String, Content)], port: &Port) -> u128 {
    let name = if is_vectors(port) { format!("vectors {}", port.frame) } else { port.name.clone() };
    contents.iter().find(|(known, _)| *known == name).map_or(0, |(_, content)| content.number())
}
