//! Images that neighbouring frames have in common, and plans cut there: each part can be run by itself, and what one
//! frame computed of them be handed to the plan of another.

use super::keys::hash;
use super::parts::{ImageId, Lifetimes, Plan, Port};
use std::collections::{HashMap, HashSet};

/// An image that the plans of neighbouring frames compute alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shared {
    /// The virtual image.
    pub image: ImageId,
    /// First and last frame whose inputs it is made from, counted from the one that is computed.
    pub frames: [i32; 2],
    /// Number of it among all images of plans of this frame and size.
    pub name: u128,
}

impl Plan {
    /// The images at which a plan over several frames can be cut: each is computed in the same way of inputs of other
    /// frames, too, and read by passes that are not, or by such that read more frames.
    pub fn shared(&self) -> Vec<Shared> {
        let (shapes, frames) = self.shapes();
        let mut firsts: HashMap<u128, HashSet<i32>> = HashMap::new();
        for (shape, frames) in shapes.iter().zip(&frames) {
            if let Some([first, _]) = frames {
                firsts.entry(*shape).or_default().insert(*first);
            }
        }
        let is_repeated = |id: &ImageId| firsts.get(&shapes[id.index()]).is_some_and(|all| all.len() > 1);
        let mut found: HashSet<ImageId> = self.outputs.iter().map(|port| port.image).collect();
        for pass in &self.passes {
            let is_own = !pass.outputs.iter().all(is_repeated);
            let all = pass.outputs.first().map(|id| frames[id.index()]);
            found.extend(pass.inputs.iter().filter(|id| is_own || all != Some(frames[id.index()])));
        }
        let names = self.names(|port| hash(&(port.base(), port.frame)));
        let written = self.passes.iter().flat_map(|pass| &pass.outputs);
        written
            .filter(|id| found.contains(id) && is_repeated(id))
            .filter_map(|id| {
                frames[id.index()].map(|frames| Shared { image: *id, frames, name: names[id.index()] })
            })
            .collect()
    }

    /// By image: a number of the passes that make it, whatever their uniform bytes, with frames counted from its first;
    /// and its first and last frame.
    fn shapes(&self) -> (Vec<u128>, Vec<Option<[i32; 2]>>) {
        let mut shapes = vec![0; self.images.len()];
        let mut frames: Vec<Option<[i32; 2]>> = vec![None; self.images.len()];
        for port in &self.inputs {
            shapes[port.image.index()] = hash(&port.base());
            frames[port.image.index()] = Some([port.frame; 2]);
        }
        for pass in &self.passes {
            let read = pass.inputs.iter().filter_map(|id| frames[id.index()]);
            let all = read.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
            let first = all.map_or(0, |[first, _]| first);
            let from = |id: &ImageId| (shapes[id.index()], frames[id.index()].map(|[f, _]| f - first));
            let made: Vec<_> = pass.inputs.iter().map(from).collect();
            for (place, id) in pass.outputs.iter().enumerate() {
                shapes[id.index()] = hash(&(pass.kernel.name, &made, place, self.desc(*id)));
                frames[id.index()] = all;
            }
        }
        (shapes, frames)
    }

    /// By image: a number of all that makes it, down to the uniform bytes of passes; `input` gives those of images that
    /// enter.
    pub fn names(&self, input: impl Fn(&Port) -> u128) -> Vec<u128> {
        let mut names = vec![0; self.images.len()];
        for port in &self.inputs {
            names[port.image.index()] = hash(&(input(port), self.size));
        }
        for pass in &self.passes {
            let inputs: Vec<u128> = pass.inputs.iter().map(|input| names[input.index()]).collect();
            let made = (pass.kernel.name, inputs, &pass.params, &pass.supports, self.size);
            for (place, id) in pass.outputs.iter().enumerate() {
                names[id.index()] = hash(&(&made, place, self.desc(*id)));
            }
        }
        names
    }

    /// The plan of some of its images alone, which leave it in this order under the names of [`Plan::port_name`].
    #[must_use]
    pub fn part(&self, images: &[ImageId]) -> Self {
        let outputs = images.iter().map(|id| Port::new(&Self::port_name(*id), 0, *id)).collect();
        self.cut(outputs, &[])
    }

    /// The same plan for runs to which some of its images are handed, under the names of [`Plan::port_name`].
    #[must_use]
    pub fn with_handed(&self, images: &[ImageId]) -> Self {
        self.cut(self.outputs.clone(), images)
    }

    /// Name of an image that enters or leaves a plan that was cut.
    pub fn port_name(image: ImageId) -> String {
        format!("image{}", image.0)
    }

    fn cut(&self, outputs: Vec<Port>, handed: &[ImageId]) -> Self {
        let mut plan =
            Self { outputs, kept: Vec::new(), calls: Vec::new(), stamps: Vec::new(), ..self.clone() };
        let mut needed: HashSet<ImageId> = plan.outputs.iter().map(|port| port.image).collect();
        needed.retain(|id| !handed.contains(id));
        let mut passes = Vec::new();
        while let Some(pass) = plan.passes.pop() {
            if pass.outputs.iter().any(|id| needed.contains(id)) {
                needed.extend(pass.inputs.iter().filter(|id| !handed.contains(id)));
                passes.push(pass);
            }
        }
        passes.reverse();
        plan.passes = passes;
        plan.inputs.retain(|port| needed.contains(&port.image));
        plan.inputs.extend(handed.iter().map(|id| Port::new(&Self::port_name(*id), 0, *id)));
        plan.lifetimes = Lifetimes::find(&plan.passes, &plan.outputs);
        plan
    }
}
