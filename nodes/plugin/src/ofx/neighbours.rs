//! What neighbouring frames have in common: the stages that each carries from others, and motion that is estimated
//! between them.
//!
//! It is computed over the whole picture, once for all frames that need it, and kept by what it was made from: the
//! contents of the images that were read, the passes down to their uniform bytes, and what was done to the pixels in
//! between. Whatever a host shows, and calls it, the same contents give the same bits.

use super::content;
use super::faults;
use super::inputs::{Gathered, Inputs, Read};
use super::kept;
use super::prepared::Prepared;
use super::stop::Stop;
use isophote::Error;
use isophote::engine::cpu::{Control, CpuExecutor, Threads};
use isophote::engine::plan::Shared;
use isophote::engine::{Image, ImageId, Plan, Rect};
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
        Cut { plan: plan.with_handed(&ids), handed }
    }
}

/// The shared images of a plan that the plans of other frames ask for as well.
fn lasting(plan: &Plan) -> Vec<Shared> {
    let mut all = plan.shared();
    let mut relative = Vec::new();
    for Shared { image, frames: [first, _], .. } in &all {
        let name = |from: i32| content::of_text(&format!("{from}"));
        let names =
            plan.names(|port| content::of_all(&[content::of_text(port.base()), name(port.frame - first)]));
        relative.push(names[image.index()]);
    }
    let mut places = relative.iter();
    all.retain(|_| {
        places.next().is_some_and(|name| relative.iter().filter(|other| *other == name).count() > 1)
    });
    all
}

/// A search for the stages of one frame.
pub struct Search<'s> {
    pub inputs: &'s Inputs<'s>,
    pub prepared: &'s Prepared,
    /// What is done to pixels between their reading and the plan, beside what `prepared` does.
    pub treatment: String,
    pub threads: &'s dyn Threads,
    pub control: Control<'s>,
}

impl Search<'_> {
    /// The stages of the frame, those of all frames that are near enough.
    ///
    /// # Errors
    /// As reading and running.
    pub fn run(&self, executor: &mut CpuExecutor) -> Result<Found, Stop> {
        let plan = self.prepared.planned.plan();
        let shared = lasting(plan);
        let [width, height] = plan.size();
        let whole = Rect::of_size(width, height);
        let bytes = |shared: &Shared| {
            let shape = plan.desc(shared.image);
            plan.region_at(whole, shape.level).area() * u64::from(shape.channels) * 4
        };
        // The next frame must find them, beside those that it adds.
        if shared.is_empty() || shared.iter().map(bytes).sum::<u64>() * 3 / 2 > kept::most() {
            return Ok(Found::All(Stages::default()));
        }
        let mut groups: BTreeMap<[i32; 2], Vec<Shared>> = BTreeMap::new();
        for shared in shared {
            groups.entry(shared.frames).or_default().push(shared);
        }
        let ids: Vec<ImageId> = groups.values().flatten().map(|shared| shared.image).collect();
        let part = plan.part(&ids);
        let mut reads = match self.inputs.gather(self.prepared, &part, &part.windows(whole))? {
            Gathered::All(reads) => reads,
            Gathered::Without(frame) => return Ok(Found::Without(frame)),
        };
        let contents: Vec<(String, u128)> = reads
            .iter()
            .map(|read| (read.name.clone(), content::of_image(&read.pixels, self.threads)))
            .collect();
        let mut stages = Vec::new();
        for ([first, _], group) in groups {
            let found = self.of_group(plan, &group, first, &contents, &mut reads, executor)?;
            stages.extend(group.iter().map(|shared| shared.name).zip(found));
        }
        reads.into_iter().for_each(Read::keep_memory);
        Ok(Found::All(Stages(stages)))
    }

    /// The stages that are made of the same frames, from `first` on.
    fn of_group(
        &self,
        plan: &Plan,
        group: &[Shared],
        first: i32,
        contents: &[(String, u128)],
        reads: &mut [Read],
        executor: &mut CpuExecutor,
    ) -> Result<Vec<Arc<Image>>, Stop> {
        let [width, height] = plan.size();
        let whole = Rect::of_size(width, height);
        let treatment = content::of_text(&format!("{} {:?}", self.treatment, self.prepared.square));
        let all = plan.names(|port| {
            let held = contents.iter().find(|(name, _)| *name == port.name).map_or(0, |(_, held)| *held);
            let place = content::of_text(&format!("{} {}", port.base(), port.frame - first));
            content::of_all(&[treatment, place, held])
        });
        let names: Vec<u128> = group.iter().map(|shared| all[shared.image.index()]).collect();
        let stops = || self.control.cancelled.is_some_and(|cancelled| cancelled());
        kept::obtain(&names, &stops, |missing| {
            let ids: Vec<ImageId> = missing.iter().map(|index| group[*index].image).collect();
            let part = plan.part(&ids);
            for read in reads.iter_mut().filter(|r| part.inputs().iter().any(|port| port.name == r.name)) {
                self.inputs.make_ready(self.prepared, read, self.threads)?;
            }
            let named: Vec<(&str, &Image)> = reads.iter().map(|r| (&r.name[..], &r.pixels)).collect();
            let images = executor.run(&part, &named, whole, self.threads, self.control);
            faults::computed(ids.len());
            Ok(images.map_err(Error::from)?)
        })
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
                let image = Arc::new(Image::new(1, 1, 1).unwrap());
                let stages = Stages(shared.iter().map(|shared| (shared.name, Arc::clone(&image))).collect());
                let cut = stages.cut(plan);
                assert!(cut.handed.len() == shared.len() && cut.plan.passes().len() < plan.passes().len());
                let others = cut.plan.inputs().iter().filter(|p| p.base() == "color" && p.frame != 0);
                assert_eq!(others.count(), 0, "{:?}", effect.identifier);
            }
        }
    }
}
