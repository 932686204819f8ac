//! Parts that a plan is made of.

use crate::kernel::Kernel;
use std::collections::HashSet;

/// A virtual image of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ImageId(pub(crate) u32);

impl ImageId {
    /// Position in [`Plan::images`].
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Precision in which an image must be kept.
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

/// Distance around an output pixel within which a pass reads its inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Support {
    /// At most so many pixels of the input's own level, in x and in y.
    Pixels(u32),
    /// At most so many pixels of the input's own level to the left and to the right.
    Row(u32),
    /// At most so many pixels of the input's own level above and below.
    Column(u32),
    /// Anywhere.
    Global,
}

/// One pass over an image.
#[derive(Clone, Debug)]
pub struct Pass {
    /// Kernel to run.
    pub kernel: &'static Kernel,
    /// Images read.
    pub inputs: Vec<ImageId>,
    /// Images written; all of one level.
    pub outputs: Vec<ImageId>,
    /// The kernel's uniform block.
    pub params: Vec<u8>,
    /// Distance within which the kernel reads each input.
    pub supports: Vec<Support>,
}

impl Pass {
    /// Distance within which the kernel reads the input that it reads farthest.
    pub fn support(&self) -> Support {
        self.supports.iter().copied().fold(Support::Pixels(0), Support::farther)
    }
}

impl Support {
    /// Pixels to the left and right, and above and below; none for anywhere.
    pub fn sides(self) -> Option<[u32; 2]> {
        match self {
            Self::Pixels(n) => Some([n, n]),
            Self::Row(n) => Some([n, 0]),
            Self::Column(n) => Some([0, n]),
            Self::Global => None,
        }
    }

    /// The least that covers two.
    pub fn farther(self, other: Self) -> Self {
        match (self, other) {
            (Self::Row(a), Self::Row(b)) => Self::Row(a.max(b)),
            (Self::Column(a), Self::Column(b)) => Self::Column(a.max(b)),
            _ => match (self.sides(), other.sides()) {
                (Some([x, y]), Some([s, t])) => Self::Pixels(x.max(y).max(s).max(t)),
                _ => Self::Global,
            },
        }
    }
}

/// An image that enters or leaves a plan, by name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// The caller's name for it: "color", or "color@-1" for that of the frame before.
    pub name: String,
    /// Frame that it belongs to, counted from the one that is computed.
    pub frame: i32,
    /// The virtual image.
    pub image: ImageId,
}

impl Port {
    pub(super) fn new(base: &str, frame: i32, image: ImageId) -> Self {
        let name = if frame == 0 { base.to_owned() } else { format!("{base}@{frame:+}") };
        Self { name, frame, image }
    }

    /// The name without the frame.
    pub fn base(&self) -> &str {
        self.name.split_once('@').map_or(&self.name, |(base, _)| base)
    }
}

/// A stage of a plan that frames have in common: what the frame at hand computes of it, later ones carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kept {
    /// Number of the stage, in the order of description; the same in all frames.
    pub stage: u32,
    /// The frame that it belongs to, counted from the one that is computed.
    pub frame: i32,
    /// The virtual image.
    pub image: ImageId,
}

/// Ends of the use of images.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lifetimes {
    /// By pass: the images whose last use it is.
    ending: Vec<Vec<ImageId>>,
}

impl Lifetimes {
    /// Of the images of `passes` in this order, of which `outputs` live on.
    pub(super) fn find(passes: &[Pass], outputs: &[Port]) -> Self {
        let mut living: HashSet<ImageId> = outputs.iter().map(|port| port.image).collect();
        let mut ending: Vec<Vec<ImageId>> = passes
            .iter()
            .rev()
            .map(|pass| {
                pass.inputs.iter().chain(&pass.outputs).copied().filter(|id| living.insert(*id)).collect()
            })
            .collect();
        ending.reverse();
        Self { ending }
    }

    /// The images that pass `index` reads or writes and no later one does, each once. Images that leave the
    /// plan are never among them; images that enter it are.
    pub fn ending_with(&self, index: usize) -> &[ImageId] {
        self.ending.get(index).map_or(&[], Vec::as_slice)
    }
}

/// Passes in order, with the images that enter and leave.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    pub(super) size: [u32; 2],
    pub(super) images: Vec<ImageDesc>,
    pub(super) passes: Vec<Pass>,
    pub(super) inputs: Vec<Port>,
    pub(super) outputs: Vec<Port>,
    pub(super) kept: Vec<Kept>,
    pub(super) lifetimes: Lifetimes,
    /// Pass that each call of the builder led to; replayed by edits.
    pub(super) calls: Vec<u32>,
    /// The edit in which each pass was last written.
    pub(super) stamps: Vec<u64>,
    pub(super) edit: u64,
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

    /// Stages of this frame and of others, as far as they are computed here.
    pub fn kept(&self) -> &[Kept] {
        &self.kept
    }

    /// Shape of a virtual image.
    pub fn desc(&self, image: ImageId) -> ImageDesc {
        self.images[image.index()]
    }

    /// Ends of the use of its images.
    pub fn lifetimes(&self) -> &Lifetimes {
        &self.lifetimes
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
}
