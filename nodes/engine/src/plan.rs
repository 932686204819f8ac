//! A plan: what to run, not how.
//!
//! Nodes describe passes over virtual images; equal passes are recorded once, so that two nodes
//! which need the same structure tensor share it without knowing of each other. Everything that
//! both executors must agree on is decided here, once.

mod builder;

pub use builder::PlanBuilder;

use crate::error::{Error, Result};
use crate::image::Rect;
use crate::kernel::Kernel;

/// A virtual image of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ImageId(pub(crate) u32);

impl ImageId {
    /// Position in [`Plan::images`].
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// How precisely an image must be kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Class {
    /// Tensors, distances, orientations: always 32-bit float.
    Field,
    /// Colours: an executor may keep them in half precision where the caller allows it.
    Colour,
}

/// Shape of a virtual image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ImageDesc {
    /// Values a pixel, 1..=4.
    pub channels: u32,
    /// Precision needed.
    pub class: Class,
    /// Pyramid level: sides are ceil(n / 2^level); negative levels are oversampled.
    pub level: i8,
}

/// How far around an output pixel a pass reads its inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Support {
    /// At most so many pixels of the input's own level, in x and in y.
    Pixels(u32),
    /// Anywhere.
    Global,
}

/// One pass over an image.
#[derive(Clone, Debug)]
pub struct Pass {
    /// What to run.
    pub kernel: &'static Kernel,
    /// Images read.
    pub inputs: Vec<ImageId>,
    /// Images written; all of one level.
    pub outputs: Vec<ImageId>,
    /// The kernel's uniform block.
    pub params: Vec<u8>,
    /// How far the kernel reads.
    pub support: Support,
}

/// An image that enters or leaves a plan, by name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// The caller's name for it.
    pub name: String,
    /// The virtual image.
    pub image: ImageId,
}

/// Passes in order, with the images that enter and leave.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    size: [u32; 2],
    images: Vec<ImageDesc>,
    passes: Vec<Pass>,
    inputs: Vec<Port>,
    outputs: Vec<Port>,
    /// Which pass each call of the builder led to; replayed by edits.
    calls: Vec<u32>,
    /// The edit in which each pass was last written.
    stamps: Vec<u64>,
    edit: u64,
}

impl Plan {
    /// Size of the picture at level 0, in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// All virtual images.
    pub fn images(&self) -> &[ImageDesc] {
        &self.images
    }

    /// All passes, in the order of execution.
    pub fn passes(&self) -> &[Pass] {
        &self.passes
    }

    /// Images that enter.
    pub fn inputs(&self) -> &[Port] {
        &self.inputs
    }

    /// Images that leave.
    pub fn outputs(&self) -> &[Port] {
        &self.outputs
    }

    /// Shape of a virtual image.
    pub fn desc(&self, image: ImageId) -> ImageDesc {
        self.images[image.index()]
    }

    /// Size of the whole picture at `level`: ceil(n / 2^level), at least 1.
    pub fn level_size(&self, level: i8) -> [i32; 2] {
        self.size.map(|n| {
            if level >= 0 {
                n.div_ceil(1 << level.min(31)).max(1) as i32
            } else {
                (n << (-level).min(4)) as i32
            }
        })
    }

    /// The pixels of `level` that lie under `region` (level 0): what an output of that level returns.
    pub fn region_at(&self, region: Rect, level: i8) -> Rect {
        self.clip(rescale(region, 0, level), level)
    }

    /// The window of every virtual image that is needed to compute `region` (level 0) of every
    /// output. Images that are not needed get an empty window.
    pub fn windows(&self, region: Rect) -> Vec<Rect> {
        let mut windows = vec![Rect::default(); self.images.len()];
        for port in &self.outputs {
            let level = self.desc(port.image).level;
            let needed = self.region_at(region, level);
            windows[port.image.index()] = windows[port.image.index()].union(&needed);
        }
        for pass in self.passes.iter().rev() {
            let out = pass.outputs.iter().fold(Rect::default(), |r, o| r.union(&windows[o.index()]));
            if out.is_empty() {
                continue;
            }
            // Every output of a pass is computed over the same window.
            for output in &pass.outputs {
                windows[output.index()] = out;
            }
            for input in &pass.inputs {
                let needed = self.read_by(pass, out, *input);
                windows[input.index()] = windows[input.index()].union(&needed);
            }
        }
        windows
    }

    /// The pixels of `input` that `pass` reads to compute `out`.
    pub(crate) fn read_by(&self, pass: &Pass, out: Rect, input: ImageId) -> Rect {
        let (from, level) = (self.desc(pass.outputs[0]).level, self.desc(input).level);
        match pass.support {
            Support::Pixels(n) => self.clip(rescale(out, from, level).grown(n.min(MAX_HALO) as i32), level),
            Support::Global => self.whole(level),
        }
    }

    /// How far outside a region the inputs are read, in pixels of level 0, or `Global`. Holds for
    /// every region; with pyramids a region aligned to them may need a little less.
    pub fn support(&self) -> Support {
        // A region far from every border shows the full halo.
        let wide = Plan { size: [1 << 24, 1 << 24], ..self.clone() };
        let coarsest = wide.images.iter().map(|i| i.level).max().unwrap_or(0).clamp(0, 22);
        let step = 1 << coarsest;
        let region = Rect { x0: 1 << 23, y0: 1 << 23, x1: (1 << 23) + step, y1: (1 << 23) + step };
        let windows = wide.windows(region);
        let mut halo = 0;
        for port in &wide.inputs {
            let window = windows[port.image.index()];
            if window.is_empty() {
                continue;
            }
            if window.x0 <= 0 {
                return Support::Global;
            }
            halo = halo.max(region.x0 - window.x0).max(window.x1 - region.x1);
            halo = halo.max(region.y0 - window.y0).max(window.y1 - region.y1);
        }
        // That was a region of whole coarse pixels; any other lies inside such a one.
        Support::Pixels((halo + step - 1) as u32)
    }

    /// The last pass that reads each image (or writes it, when nobody reads it); images that leave
    /// the plan live on past the end.
    pub fn last_uses(&self) -> Vec<usize> {
        let mut last = vec![0; self.images.len()];
        for (index, pass) in self.passes.iter().enumerate() {
            for image in pass.inputs.iter().chain(&pass.outputs) {
                last[image.index()] = index;
            }
        }
        for port in &self.outputs {
            last[port.image.index()] = usize::MAX;
        }
        last
    }

    /// The most bytes that the images of a run over `windows` ([`Plan::windows`]) take at once, those that
    /// enter included, when each is freed after its last use.
    pub fn peak_bytes(&self, windows: &[Rect]) -> u64 {
        let bytes = |image: ImageId| {
            let window = &windows[image.index()];
            let channels = u64::from(self.desc(image).channels);
            u64::from(window.width()) * u64::from(window.height()) * channels * 4
        };
        let mut live: u64 = self.inputs.iter().map(|port| bytes(port.image)).sum();
        let mut most = live;
        let last_uses = self.last_uses();
        let mut freed: Vec<Vec<ImageId>> = vec![Vec::new(); self.passes.len()];
        for (index, last) in last_uses.iter().enumerate() {
            let image = ImageId(index as u32);
            if let Some(list) = freed.get_mut(*last)
                && !self.inputs.iter().any(|port| port.image == image)
            {
                list.push(image);
            }
        }
        for (pass, freed) in self.passes.iter().zip(&freed) {
            live += pass.outputs.iter().map(|o| bytes(*o)).sum::<u64>();
            most = most.max(live);
            live -= freed.iter().map(|image| bytes(*image)).sum::<u64>();
        }
        most
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
                .map(|(name, image)| Port { name: name.to_string(), image })
                .collect::<Vec<_>>()
        };
        let (inputs, outputs) = (pass.inputs.len(), pass.outputs.len());
        let alone = Pass {
            kernel,
            inputs: ids(0, inputs).collect(),
            outputs: ids(inputs, outputs).collect(),
            params: pass.params.clone(),
            support: pass.support,
        };
        Ok(Self {
            size: self.size,
            images,
            passes: vec![alone],
            inputs: ports(0, inputs),
            outputs: ports(inputs, outputs),
            calls: vec![0],
            stamps: vec![0],
            edit: 0,
        })
    }

    fn whole(&self, level: i8) -> Rect {
        let [w, h] = self.level_size(level);
        Rect { x0: 0, y0: 0, x1: w, y1: h }
    }

    fn clip(&self, rect: Rect, level: i8) -> Rect {
        // A region wholly outside still needs the edge pixels that it clamps to.
        let [w, h] = self.level_size(level);
        let x0 = rect.x0.clamp(0, w - 1);
        let y0 = rect.y0.clamp(0, h - 1);
        Rect { x0, y0, x1: rect.x1.clamp(x0 + 1, w), y1: rect.y1.clamp(y0 + 1, h) }
    }
}

/// Wider halos than any picture are cut to this, so that sums of positions cannot overflow.
const MAX_HALO: u32 = 1 << 25;

/// The pixels of level `to` that lie under `rect` of level `from`.
fn rescale(rect: Rect, from: i8, to: i8) -> Rect {
    // Beyond these every picture is one pixel, or none is that large.
    let shift = (i32::from(to) - i32::from(from)).clamp(-8, 30);
    if shift >= 0 {
        let up = |v: i32| (v + (1 << shift) - 1) >> shift;
        Rect { x0: rect.x0 >> shift, y0: rect.y0 >> shift, x1: up(rect.x1), y1: up(rect.y1) }
    } else {
        Rect { x0: rect.x0 << -shift, y0: rect.y0 << -shift, x1: rect.x1 << -shift, y1: rect.y1 << -shift }
    }
}
