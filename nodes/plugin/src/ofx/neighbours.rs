//! What neighbouring frames have in common: the stages that each carries from others, and motion that is estimated
//! between them.
//!
//! It is computed over the whole picture, or a segment of it where a host asks for tiles, once for all frames and tiles
//! that need it, and kept by what it was made from: the
//! contents of the images that were read, the passes down to their uniform bytes, and what was done to the pixels in
//! between. Whatever a host shows, and calls it, the same contents give the same bits.

use super::content;
use super::faults;
use super::inputs::{Gathered, Inputs, Read, Taken};
use super::kept::{self, PATIENCE};
use super::prepared::Prepared;
use super::segments::{Part, parts, segments};
use super::stop::Stop;
use crate::pool;
use isophote::Error;
use isophote::engine::cpu::{Control, CpuExecutor, Threads};
use isophote::engine::plan::{Port, Shared};
use isophote::engine::{Image, ImageId, Plan, Rect};
use isophote_abi::openfx::kOfxStatFailed;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Images that were found, by their numbers among all of a frame.
#[derive(Debug, Default)]
pub struct Stages(Vec<(u128, Arc<Image>)>);

/// A plan, cut where images are at hand.
#[derive(Debug)]
pub struct Cut {
    /// The plan that is run.
    pub plan: Plan,
    /// The images that are handed to it, by its names for them.
    pub handed: Vec<(String, Arc<Image>)>,
}

/// Result of a search for stages.
pub enum Found {
    /// All that there are.
    All(Stages),
    /// None, since this frame, counted from the one that is rendered, lacks an image.
    Without(i32),
}

impl Stages {
    /// A plan, without the passes that made them.
    pub fn cut(&self, plan: &Plan) -> Cut {
        let shared = if self.0.is_empty() { Vec::new() } else { plan.shared() };
        let (mut ids, mut handed) = (Vec::new(), Vec::new());
        for Shared { image, name, .. } in shared {
            if let Some((_, found)) = self.0.iter().find(|(of, _)| *of == name) {
                ids.push(image);
                handed.push((Plan::port_name(image), Arc::clone(found)));
            }
        }
        // A plan as it is has the same result to the bit as with the C table, on a graphics card, too.
        let plan = if ids.is_empty() { plan.clone() } else { plan.with_handed(&ids) };
        Cut { plan, handed }
    }
}

/// Rows that all segments may compute, as a share of the picture's.
const MOST_ROWS: f32 = 1.5;

/// Images of a plan that are kept for a segment of the picture.
pub struct Lasting {
    /// The images.
    pub shared: Vec<Shared>,
    /// The part of the picture over which each is computed; the same for all, since what is a neighbour's now was the
    /// frame's own before.
    pub region: Rect,
}

impl Lasting {
    /// Images for a segment of the host's pixels; none where there is nothing to share, or too much of it.
    pub fn of(prepared: &Prepared, segment: Rect) -> Option<Self> {
        Self::over(lasting(prepared.planned.plan()), prepared, segment)
    }

    /// The parts of `inside` of a picture of this size, each in the segment for which images are kept, if any are: all of the
    /// picture, where segments would have most of it in common and it is not too much.
    pub fn parts(prepared: &Prepared, size: [u32; 2], inside: Rect) -> Vec<Part> {
        let shared = lasting(prepared.planned.plan());
        if shared.is_empty() {
            return vec![Part::alone(inside)];
        }
        let over = |segment| Self::over(shared.clone(), prepared, segment);
        let (mut parts, whole) = (parts(size, inside), Rect::of_size(size[0], size[1]));
        if parts.iter().any(|part| part.segment.is_some_and(|segment| segment != whole)) {
            let rows = |segment| over(segment).map_or(0.0, |all| all.region.height() as f32);
            let most = MOST_ROWS * prepared.planned.plan().size()[1] as f32;
            if segments(size).map(rows).sum::<f32>() > most && over(whole).is_some() {
                return vec![Part { inside, segment: Some(whole) }];
            }
        }
        for part in &mut parts {
            part.segment = part.segment.filter(|segment| over(*segment).is_some());
        }
        if parts.iter().all(|part| part.segment.is_none()) { vec![Part::alone(inside)] } else { parts }
    }

    fn over(shared: Vec<Shared>, prepared: &Prepared, segment: Rect) -> Option<Self> {
        if shared.is_empty() {
            return None;
        }
        let plan = prepared.planned.plan();
        let windows = plan.windows(prepared.plan_window(segment));
        let region = shared.iter().fold(Rect::default(), |all, Shared { image, .. }| {
            let window = windows[image.index()];
            if window.is_empty() {
                all
            } else {
                all.union(&plan.region_over(window, plan.desc(*image).level))
            }
        });
        let bytes = |shared: &Shared| {
            let shape = plan.desc(shared.image);
            plan.region_at(region, shape.level).area() * u64::from(shape.channels) * 4
        };
        // The next frame must find them, beside those that it adds.
        let fits = shared.iter().map(bytes).sum::<u64>() * 3 / 2 <= kept::most();
        (fits && !region.is_empty()).then_some(Self { shared, region })
    }

    /// The plan of them alone, and the part of each of its images that it needs.
    pub fn part(&self, plan: &Plan) -> (Plan, Vec<Rect>) {
        let ids: Vec<ImageId> = self.shared.iter().map(|shared| shared.image).collect();
        let part = plan.part(&ids);
        let windows = part.windows(self.region);
        (part, windows)
    }
}

/// The shared images of a plan that the plans of other frames ask for as well.
fn lasting(plan: &Plan) -> Vec<Shared> {
    let mut all = plan.shared();
    let mut named: BTreeMap<i32, Vec<u128>> = BTreeMap::new();
    let of_frame = |first: i32| {
        let name = |from: i32| content::of_text(&format!("{from}"));
        plan.names(|port| content::of_all(&[content::of_text(port.base()), name(port.frame - first)]))
    };
    let relative: Vec<u128> = all
        .iter()
        .map(|Shared { image, frames: [first, _], .. }| {
            named.entry(*first).or_insert_with(|| of_frame(*first))[image.index()]
        })
        .collect();
    let mut places = relative.iter();
    all.retain(|_| {
        places.next().is_some_and(|name| relative.iter().filter(|other| *other == name).count() > 1)
    });
    all
}

/// Content of an image of a plan that was looked at.
pub struct Looked {
    /// The plan's name for the image.
    pub name: String,
    /// The part of it.
    pub window: Rect,
    /// Number of what it holds.
    pub number: u128,
}

/// A search for the stages of one frame.
pub struct Search<'s, 'h> {
    pub inputs: &'s Inputs<'h>,
    pub prepared: &'s Prepared,
    /// The part of the host's pixels that the images are found for.
    pub segment: Rect,
    /// True where the host need not have given all of the picture.
    pub is_part: bool,
    /// Contents that were looked at before.
    pub known: &'s [Looked],
    /// What is done to pixels between their reading and the plan, beside what `prepared` does.
    pub treatment: String,
    pub threads: &'s dyn Threads,
    pub control: Control<'s>,
}

impl Search<'_, '_> {
    /// The stages of the frame, those of all frames that are near enough.
    ///
    /// # Errors
    /// As reading and running.
    pub fn run(&self, executor: &mut CpuExecutor) -> Result<Found, Stop> {
        let plan = self.prepared.planned.plan();
        let Some(lasting) = Lasting::of(self.prepared, self.segment) else {
            return Ok(Found::All(Stages::default()));
        };
        let (part, windows) = lasting.part(plan);
        let content = |taken: Taken<'_>| {
            let known =
                self.known.iter().find(|known| known.name == taken.name && known.window == taken.window);
            let number = known.map_or_else(|| self.content(&taken), |known| Ok(Some(known.number)))?;
            Ok((number, taken.name))
        };
        let contents =
            match self.inputs.each(self.prepared, part.inputs(), &windows, self.threads, content)? {
                Gathered::All(contents) => contents,
                Gathered::Without(frame) => return Ok(Found::Without(frame)),
            };
        if contents.iter().any(|(content, _)| content.is_none()) {
            return Ok(Found::All(Stages::default()));
        }
        // What is made of fewer frames comes first, since the others may be made of it.
        let mut groups: BTreeMap<[i32; 2], Vec<Shared>> = BTreeMap::new();
        for shared in lasting.shared {
            let [first, last] = shared.frames;
            groups.entry([last - first, first]).or_default().push(shared);
        }
        let mut pixels = Pixels { contents, windows, read: Vec::new(), changed: false };
        let (mut stages, mut made) = (Vec::new(), Vec::new());
        for ([_, first], group) in groups {
            match self.of_group(&group, (lasting.region, first), &made, &mut pixels, executor) {
                Ok(found) => {
                    stages.extend(group.iter().map(|shared| shared.name).zip(found.iter().cloned()));
                    made.extend(group.iter().map(|shared| shared.image).zip(found));
                }
                Err(_) if pixels.changed => return Ok(Found::All(Stages::default())),
                Err(stop) => return Err(stop),
            }
        }
        pixels.read.into_iter().for_each(Read::keep_memory);
        Ok(Found::All(Stages(stages)))
    }

    /// Number of what an image holds; none where the host gave too little of it.
    fn content(&self, taken: &Taken<'_>) -> Result<Option<u128>, Stop> {
        let content = self.inputs.content(self.prepared, taken, taken.window, self.is_part, self.threads)?;
        Ok(content.map(|content| content.number()))
    }

    /// The stages that are made of the same frames, from `first` on, over `region`, where those of `made` are at hand.
    fn of_group(
        &self,
        group: &[Shared],
        (region, first): (Rect, i32),
        made: &[(ImageId, Arc<Image>)],
        pixels: &mut Pixels,
        executor: &mut CpuExecutor,
    ) -> Result<Vec<Arc<Image>>, Stop> {
        let plan = self.prepared.planned.plan();
        let treatment =
            content::of_text(&format!("{} {region:?} {:?}", self.treatment, self.prepared.square));
        let all = plan.names(|port| {
            let held = pixels.content(&port.name).unwrap_or_default();
            let place = content::of_text(&format!("{} {}", port.base(), port.frame - first));
            content::of_all(&[treatment, place, held])
        });
        let names: Vec<u128> = group.iter().map(|shared| all[shared.image.index()]).collect();
        let stops = || self.control.cancelled.is_some_and(|cancelled| cancelled());
        kept::obtain(&names, PATIENCE, &stops, |missing| {
            let ids: Vec<ImageId> = missing.iter().map(|index| group[*index].image).collect();
            let whole = plan.part(&ids);
            let windows = whole.windows(region);
            // Those that hold what is read of them.
            let is_fit = |(id, image): &&(ImageId, Arc<Image>)| {
                let window = windows[id.index()];
                !window.is_empty() && image.window().contains(&window)
            };
            let at_hand: Vec<&(ImageId, Arc<Image>)> = made.iter().filter(is_fit).collect();
            let part = whole.with_handed(&at_hand.iter().map(|(id, _)| *id).collect::<Vec<_>>());
            pixels.read(self, &part)?;
            let names: Vec<String> = at_hand.iter().map(|(id, _)| Plan::port_name(*id)).collect();
            let handed = names.iter().zip(&at_hand).map(|(name, (_, image))| (&name[..], &**image));
            let read = pixels.read.iter().map(|read| (&read.name[..], &read.pixels));
            let named: Vec<(&str, &Image)> = read.chain(handed).collect();
            // What is kept of these leaves the executor, and those come back that are kept no longer.
            for id in &ids {
                let spare = pool::spare(windows[id.index()], plan.desc(*id).channels);
                spare.into_iter().for_each(|image| executor.recycle(image));
            }
            let images = executor.run(&part, &named, region, self.threads, self.control);
            faults::computed(ids.len());
            Ok(images.map_err(Error::from)?)
        })
    }
}

/// The images that a search knows, and those of them that were read: what is found need not be.
struct Pixels {
    /// Numbers of what they hold, with the plan's names for them.
    contents: Vec<(Option<u128>, String)>,
    /// The parts of them that are read.
    windows: Vec<Rect>,
    read: Vec<Read>,
    /// True where an image holds something else now, so that its number must not be used.
    changed: bool,
}

impl Pixels {
    fn content(&self, name: &str) -> Option<u128> {
        self.contents.iter().find(|(_, known)| known == name).and_then(|(content, _)| *content)
    }

    /// Reads what a plan is computed from.
    fn read(&mut self, search: &Search<'_, '_>, plan: &Plan) -> Result<(), Stop> {
        let is_new = |port: &&Port| self.read.iter().all(|read| read.name != port.name);
        let ports = plan.inputs().iter().filter(is_new);
        let read = |taken: Taken<'_>| {
            if search.content(&taken)? != self.content(&taken.name) {
                return Ok(None);
            }
            let mut read = search.inputs.read_taken(search.prepared, taken)?;
            search.inputs.make_ready(search.prepared, &mut read, search.threads)?;
            Ok(Some(read))
        };
        let all = match search.inputs.each(search.prepared, ports, &self.windows, search.threads, read)? {
            Gathered::All(all) => all.into_iter().collect::<Option<Vec<Read>>>(),
            Gathered::Without(_) => None,
        };
        self.changed = all.is_none();
        self.read.extend(all.ok_or(kOfxStatFailed)?);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::effects::EFFECTS;
    use super::super::frame::Frame;
    use super::super::known::Known;
    use super::super::motion::MotionFrom;
    use super::super::prepared::Quality;
    use super::*;
    use isophote::ColourSpace;
    use isophote::request::Guides;

    #[test]
    fn plans_are_cut_at_what_other_frames_ask_for_as_well() {
        let picture = [0, 0, 64, 48];
        let frame = Frame { picture, ratio: [1.0; 2], scale: 1.0, top: None, number: 7, reference_height: 0 };
        for effect in EFFECTS.iter().filter(|effect| effect.temporal) {
            let (mut graph, ids) = effect.graph(false).unwrap();
            let prepared = |graph: &_, has: Guides| {
                let known = Known::of(graph, MotionFrom::default(), has, true).unwrap();
                Prepared::new(&known, ColourSpace::Srgb, &frame, true, Quality::Full).unwrap()
            };
            let vectors = Guides { motion: true, motion_forward: true, ..Guides::default() };
            graph.set(ids[0], "steadiness", isophote::Value::Float(0.0)).unwrap();
            assert_eq!(lasting(prepared(&graph, vectors).planned.plan()), [], "{:?}", effect.identifier);
            graph.set(ids[0], "steadiness", isophote::Value::Float(0.5)).unwrap();
            for has in [vectors, Guides::default()] {
                let prepared = prepared(&graph, has);
                let plan = prepared.planned.plan();
                let shared = lasting(plan);
                let of = |frames: [i32; 2]| shared.iter().filter(|shared| shared.frames == frames).count();
                assert!(of([0, 0]) > 0, "{:?}", effect.identifier);
                assert!((-2..=2).all(|n| of([n, n]) == of([0, 0])), "{:?}: {shared:?}", effect.identifier);
                assert_eq!(of([-1, 0]) > 0, !has.motion, "{:?}: {shared:?}", effect.identifier);
                // Motion is estimated from what is kept of each of the two frames.
                let are_pairs = |are: bool| {
                    let pairs =
                        shared.iter().filter(move |shared| (shared.frames[0] != shared.frames[1]) == are);
                    pairs.map(|shared| shared.image).collect::<Vec<_>>()
                };
                let estimates = plan.part(&are_pairs(true)).with_handed(&are_pairs(false));
                assert!(
                    estimates.inputs().iter().all(|port| port.base() != "color"),
                    "{:?}",
                    effect.identifier
                );
                let image = Arc::new(Image::new(1, 1, 1).unwrap());
                let stages = Stages(shared.iter().map(|shared| (shared.name, Arc::clone(&image))).collect());
                let cut = stages.cut(plan);
                assert!(cut.handed.len() == shared.len() && cut.plan.passes().len() < plan.passes().len());
                let others = cut.plan.inputs().iter().filter(|p| p.base() == "color" && p.frame != 0);
                assert_eq!(others.count(), 0, "{:?}", effect.identifier);
            }
        }
    }

    #[test]
    fn segments_are_the_picture_where_they_would_have_most_of_it_in_common() {
        let effect = EFFECTS.iter().find(|effect| effect.identifier == c"org.isophote.cartoon").unwrap();
        let (mut graph, ids) = effect.graph(false).unwrap();
        graph.set(ids[0], "steadiness", isophote::Value::Float(0.5)).unwrap();
        let count = |size: [u32; 2]| {
            let picture = [0, 0, size[0] as i32, size[1] as i32];
            let frame =
                Frame { picture, ratio: [1.0; 2], scale: 1.0, top: None, number: 7, reference_height: 0 };
            let vectors = Guides { motion: true, ..Guides::default() };
            let known = Known::of(&graph, MotionFrom::default(), vectors, true).unwrap();
            let prepared = Prepared::new(&known, ColourSpace::Srgb, &frame, true, Quality::Full).unwrap();
            let strips = Rect { y1: picture[3] - 1, ..Rect::of_size(size[0], size[1]) };
            let parts = Lasting::parts(&prepared, size, strips);
            assert_eq!(parts.iter().map(|part| part.inside.height()).sum::<u32>(), size[1] - 1);
            parts.iter().filter(|part| part.segment.is_some()).count()
        };
        assert_eq!(count([256, 1080]), 1);
        // So much is not kept.
        assert_eq!(count([16_000, 8000]), 0);
    }
}
