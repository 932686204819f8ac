//! Recorder of plans, which are edited by recording them again.

use super::parts::{Class, ImageDesc, ImageId, Kept, Lifetimes, Pass, Plan, Port, Support};
use crate::error::{Error, Result};
use crate::image::check_size;
use crate::kernel::{Kernel, MAX_INPUTS};
use std::collections::HashMap;

#[derive(Default)]
struct Replay {
    call: usize,
    output: usize,
    diverged: bool,
}

#[derive(PartialEq, Eq, Hash)]
struct PassKey {
    kernel: *const Kernel,
    inputs: Vec<ImageId>,
    params: Vec<u8>,
    supports: Vec<Support>,
    outputs: Vec<(Class, i8)>,
}

impl Plan {
    /// Describes the plan again with other uniform bytes, in place and without allocating.
    ///
    /// Returns false when the description took another course (other passes, other connections, or
    /// passes that were shared and now differ); the plan is then invalid and must be made anew, as it
    /// is after an error.
    ///
    /// # Errors
    /// The errors of `describe`.
    pub fn edit<E>(
        &mut self,
        describe: impl FnOnce(&mut PlanBuilder) -> std::result::Result<(), E>,
    ) -> std::result::Result<bool, E> {
        let mut plan = std::mem::take(self);
        plan.edit += 1;
        plan.kept.clear();
        let mut builder =
            PlanBuilder { plan, shared: HashMap::new(), replay: Some(Replay::default()), frame: 0 };
        let described = describe(&mut builder);
        let replay = builder.replay.unwrap_or_default();
        let complete = replay.call == builder.plan.calls.len() && replay.output == builder.plan.outputs.len();
        *self = builder.plan;
        described.map(|()| complete && !replay.diverged)
    }

    /// A plan of pass `index` alone, run by `kernel`: the pass's own, or one of the same bindings in its
    /// place. Its inputs and outputs are named "0", "1", ... in their order. This is how the two twins
    /// of a kernel are compared on equal input.
    ///
    /// # Errors
    /// [`Error::Input`] when there is no such pass or the kernel has other bindings.
    pub fn single_pass(&self, index: usize, kernel: &'static Kernel) -> Result<Self> {
        let Some(pass) = self.passes.get(index) else {
            return Err(Error::Input(format!("the plan has no pass {index}")));
        };
        let same = kernel.inputs == pass.kernel.inputs
            && kernel.outputs == pass.kernel.outputs
            && kernel.params_size == pass.kernel.params_size;
        if !same {
            return Err(Error::Input(format!("{} cannot stand in for {}", kernel.name, pass.kernel.name)));
        }
        let images = pass.inputs.iter().chain(&pass.outputs).map(|i| self.desc(*i)).collect();
        let ids = |from: usize, count: usize| (from..from + count).map(|i| ImageId(i as u32));
        let ports = |from: usize, count: usize| {
            ids(from, count)
                .enumerate()
                .map(|(name, image)| Port::new(&name.to_string(), 0, image))
                .collect::<Vec<_>>()
        };
        let (inputs, outputs) = (pass.inputs.len(), pass.outputs.len());
        let alone = Pass {
            kernel,
            inputs: ids(0, inputs).collect(),
            outputs: ids(inputs, outputs).collect(),
            params: pass.params.clone(),
            supports: pass.supports.clone(),
        };
        let plan = Self {
            size: self.size,
            images,
            passes: vec![alone],
            inputs: ports(0, inputs),
            outputs: ports(inputs, outputs),
            calls: vec![0],
            stamps: vec![0],
            ..Self::default()
        };
        Ok(plan.with_lifetimes())
    }

    fn with_lifetimes(mut self) -> Self {
        self.lifetimes = Lifetimes::find(&self.passes, &self.outputs);
        self
    }
}

/// Records the passes of a plan, or replays them with other uniform bytes.
pub struct PlanBuilder {
    plan: Plan,
    shared: HashMap<PassKey, u32>,
    replay: Option<Replay>,
    /// The frame that is described, counted from the one that is computed.
    frame: i32,
}

impl PlanBuilder {
    /// An empty plan for pictures of `width` x `height`.
    ///
    /// # Errors
    /// [`Error::Geometry`] when a side is 0 or too large.
    pub fn new(width: u32, height: u32) -> Result<Self> {
        check_size(width, height)?;
        let plan = Plan { size: [width, height], ..Plan::default() };
        Ok(Self { plan, shared: HashMap::new(), replay: None, frame: 0 })
    }

    /// Size of the picture at level 0.
    pub fn size(&self) -> [u32; 2] {
        self.plan.size
    }

    /// Size of the picture at `level`.
    pub fn level_size(&self, level: i8) -> [i32; 2] {
        self.plan.level_size(level)
    }

    /// Shape of an image described so far.
    pub fn desc(&self, image: ImageId) -> ImageDesc {
        // A replay that took another course may hold ids that the plan does not have.
        let nothing = ImageDesc { channels: 4, class: Class::Colour, level: 0 };
        self.plan.images.get(image.index()).copied().unwrap_or(nothing)
    }

    /// The pass that writes an image described so far; none for one that enters.
    pub fn made_by(&self, image: ImageId) -> Option<&Pass> {
        self.plan.passes.iter().find(|pass| pass.outputs.contains(&image))
    }

    /// The frame that is described, counted from the one that is computed.
    pub fn frame(&self) -> i32 {
        self.frame
    }

    /// Goes on with the description of another frame, counted from the one that is computed: inputs are its own
    /// from here on.
    pub fn set_frame(&mut self, frame: i32) {
        self.frame = frame;
    }

    /// Declares an image of the frame that is described that enters; the same name twice is the same image.
    pub fn input(&mut self, name: &str, channels: u32, class: Class) -> ImageId {
        let frame = self.frame;
        if let Some(port) = self.plan.inputs.iter().find(|p| p.frame == frame && p.base() == name) {
            return port.image;
        }
        if let Some(replay) = &mut self.replay {
            replay.diverged = true;
        }
        let image = self.image(ImageDesc { channels, class, level: 0 });
        self.plan.inputs.push(Port::new(name, frame, image));
        image
    }

    /// Declares an image of the frame that is described that leaves.
    pub fn output(&mut self, name: &str, image: ImageId) {
        let frame = self.frame;
        if let Some(replay) = &mut self.replay {
            let is_it = |p: &Port| p.image == image && p.frame == frame && p.base() == name;
            replay.diverged |= !self.plan.outputs.get(replay.output).is_some_and(is_it);
            replay.output += 1;
            return;
        }
        self.plan.outputs.push(Port::new(name, frame, image));
    }

    /// Marks an image of the frame that is described as its `stage`, which other frames carry; returns the stage
    /// that the image was marked as before, if it was.
    pub fn keep(&mut self, stage: u32, image: ImageId) -> u32 {
        let frame = self.frame;
        if let Some(kept) = self.plan.kept.iter().find(|k| k.image == image && k.frame == frame) {
            return kept.stage;
        }
        self.plan.kept.push(Kept { stage, frame, image });
        stage
    }

    /// Adds a pass with one output at the level of its first input.
    pub fn pass<P: bytemuck::NoUninit>(
        &mut self,
        kernel: &'static Kernel,
        inputs: &[ImageId],
        params: &P,
        class: Class,
        support: Support,
    ) -> ImageId {
        let level = inputs.first().map_or(0, |i| self.desc(*i).level);
        self.pass_at(kernel, inputs, params, &[class], support, level)
    }

    /// Adds a pass whose outputs lie at `level`, and returns the first of them; the others follow it
    /// ([`PlanBuilder::sibling`]).
    pub fn pass_at<P: bytemuck::NoUninit>(
        &mut self,
        kernel: &'static Kernel,
        inputs: &[ImageId],
        params: &P,
        classes: &[Class],
        support: Support,
        level: i8,
    ) -> ImageId {
        let supports = [support; MAX_INPUTS];
        self.pass_reaching(kernel, inputs, params, classes, &supports[..inputs.len()], level)
    }

    /// Adds a pass that does not read all its inputs equally far: `supports` are theirs, in their order.
    pub fn pass_reaching<P: bytemuck::NoUninit>(
        &mut self,
        kernel: &'static Kernel,
        inputs: &[ImageId],
        params: &P,
        classes: &[Class],
        supports: &[Support],
        level: i8,
    ) -> ImageId {
        self.pass_of_bytes(kernel, inputs, bytemuck::bytes_of(params), classes, supports, level)
    }

    /// The same for the bytes of a uniform block: apart, since nothing of it depends on the block's type.
    fn pass_of_bytes(
        &mut self,
        kernel: &'static Kernel,
        inputs: &[ImageId],
        params: &[u8],
        classes: &[Class],
        supports: &[Support],
        level: i8,
    ) -> ImageId {
        // These are slips of the describing code, never of outside data; a node's tests meet them.
        assert_eq!(params.len(), kernel.params_size, "{}: uniform block of another size", kernel.name);
        assert_eq!(inputs.len(), kernel.inputs, "{}: wrong number of inputs", kernel.name);
        assert_eq!(classes.len(), kernel.outputs.len(), "{}: wrong number of outputs", kernel.name);
        assert_eq!(supports.len(), kernel.inputs, "{}: wrong number of supports", kernel.name);
        debug_assert!(inputs.len() <= MAX_INPUTS);
        if self.replay.is_some() {
            return self.replayed(kernel, inputs, params, classes, supports, level);
        }
        let key = PassKey {
            kernel,
            inputs: inputs.to_vec(),
            params: params.to_vec(),
            supports: supports.to_vec(),
            outputs: classes.iter().map(|c| (*c, level)).collect(),
        };
        if let Some(index) = self.shared.get(&key) {
            self.plan.calls.push(*index);
            return self.plan.passes[*index as usize].outputs[0];
        }
        let outputs: Vec<ImageId> = classes
            .iter()
            .zip(kernel.outputs)
            .map(|(class, channels)| self.image(ImageDesc { channels: *channels, class: *class, level }))
            .collect();
        let index = self.plan.passes.len() as u32;
        let first = outputs[0];
        self.plan.passes.push(Pass {
            kernel,
            inputs: inputs.to_vec(),
            outputs,
            params: params.to_vec(),
            supports: supports.to_vec(),
        });
        self.plan.stamps.push(0);
        self.plan.calls.push(index);
        self.shared.insert(key, index);
        first
    }

    /// The `n`th image written by the pass that wrote `first`.
    pub fn sibling(&self, first: ImageId, n: u32) -> ImageId {
        ImageId(first.0 + n)
    }

    /// The finished plan.
    ///
    /// # Errors
    /// [`Error::Input`] when nothing leaves it.
    pub fn finish(self) -> Result<Plan> {
        if self.plan.outputs.is_empty() {
            return Err(Error::Input("the plan has no output".into()));
        }
        Ok(self.plan.with_lifetimes())
    }

    fn image(&mut self, desc: ImageDesc) -> ImageId {
        self.plan.images.push(desc);
        ImageId(self.plan.images.len() as u32 - 1)
    }

    fn replayed(
        &mut self,
        kernel: &'static Kernel,
        inputs: &[ImageId],
        params: &[u8],
        classes: &[Class],
        supports: &[Support],
        level: i8,
    ) -> ImageId {
        let plan = &mut self.plan;
        let Some(replay) = self.replay.as_mut().filter(|r| !r.diverged) else {
            return self.diverge(kernel, classes, level);
        };
        let Some(&index) = plan.calls.get(replay.call) else {
            return self.diverge(kernel, classes, level);
        };
        replay.call += 1;
        let pass = &mut plan.passes[index as usize];
        let descs = pass.outputs.iter().map(|o| plan.images[o.index()]);
        let same_outputs = descs.map(|d| (d.class, d.level)).eq(classes.iter().map(|c| (*c, level)));
        if !std::ptr::eq(pass.kernel, kernel) || pass.inputs != inputs || !same_outputs {
            return self.diverge(kernel, classes, level);
        }
        let stamp = &mut plan.stamps[index as usize];
        if *stamp == plan.edit && (pass.params != params || pass.supports != supports) {
            // Two requests shared this pass and now ask for different things.
            replay.diverged = true;
        }
        *stamp = plan.edit;
        pass.params.copy_from_slice(params);
        pass.supports.copy_from_slice(supports);
        pass.outputs[0]
    }

    /// Outputs for a pass that the plan does not have. The plan is invalid then, but the description
    /// goes on to its end and must meet images of the shapes it asked for: a pyramid described from a
    /// level that never changes would not end.
    fn diverge(&mut self, kernel: &'static Kernel, classes: &[Class], level: i8) -> ImageId {
        if let Some(replay) = &mut self.replay {
            replay.diverged = true;
        }
        let first = ImageId(self.plan.images.len() as u32);
        for (class, channels) in classes.iter().zip(kernel.outputs) {
            self.image(ImageDesc { channels: *channels, class: *class, level });
        }
        first
    }
}
