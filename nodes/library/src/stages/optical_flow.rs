//! Optical flow: where each pixel of a picture is in another one.
//!
//! Dense inverse search (T. Kroeger, R. Timofte, D. Dai, L. Van Gool, *Fast Optical Flow using Dense Inverse Search*,
//! ECCV 2016), from coarse to fine. At each level of the pyramid of brightness patches are searched from the motion of
//! the coarser level (3.1), all pixels vote among the patches that hold them (3.2, eq. 3), and a variational refinement
//! makes the field smooth but for breaks (3.3).

use crate::kernels::time::{
    brightness, brightness_derivatives, brightness_restrict, brightness_warp, inverse_search,
    motion_interpolate, motion_refine, patch_vote,
};
use inverse_search::Start;
use isophote_engine::{ImageId, PlanBuilder};

crate::declare::choice::choice! {
    /// Effort that is made for precision.
    pub enum Quality {
        /// At half the resolution, with fewer steps.
        Fast ("fast", "Fast"),
        /// At half the resolution.
        Medium ("medium", "Medium"),
        /// At full resolution.
        Fine ("fine", "Fine"),
    }
}

/// Effort that a quality stands for.
struct Effort {
    /// Level of the pyramid at which the search ends.
    finest: i8,
    /// Gauss-Newton steps of a patch.
    search: u32,
    /// Steps of the refinement at each level but the finest.
    refine: u32,
    /// Steps of the refinement at the finest level, which takes longer than all others.
    refine_finest: u32,
}

impl Quality {
    const fn effort(self) -> Effort {
        match self {
            Self::Fast => Effort { finest: 1, search: 2, refine: 16, refine_finest: 12 },
            Self::Medium => Effort { finest: 1, search: 8, refine: 24, refine_finest: 24 },
            Self::Fine => Effort { finest: 0, search: 8, refine: 32, refine_finest: 32 },
        }
    }
}

/// Pixels of the longer side of the coarsest level, by a factor of the root of 2 more or less: a few patches, which
/// take in motions of that size.
const COARSEST: f32 = 32.0;

/// The motion of two colour pictures of one size, pixels from a place `here` to the place in `there` that shows the
/// same, x to the right and y down. `reach` bounds it along x and along y, pixels, and with it how far around a part of
/// the result the pictures are read.
pub fn estimate(plan: &mut PlanBuilder, pictures: [ImageId; 2], quality: Quality, reach: f32) -> ImageId {
    let effort = quality.effort();
    let longest = plan.size().into_iter().max().unwrap_or(1) as f32;
    let coarsest = ((longest / COARSEST).log2().round() as i8).max(effort.finest);
    let mut levels = vec![pictures.map(|picture| brightness::pass(plan, picture))];
    for level in 0..coarsest as usize {
        let finer = levels[level];
        levels.push(finer.map(|image| brightness_restrict::pass(plan, image)));
    }
    let mut motion = None;
    for level in (effort.finest..=coarsest).rev() {
        let reach = (reach / f32::from(1u16 << level)).ceil().max(1.0) as u32;
        motion = Some(at_level(plan, levels[level as usize], motion, &effort, reach));
    }
    // There is one level at least.
    let mut motion = motion.unwrap_or(pictures[0]);
    for _ in 0..effort.finest {
        motion = motion_interpolate::pass(plan, motion);
    }
    motion
}

/// The motion at the level of the pictures, from that at the next coarser one.
fn at_level(
    plan: &mut PlanBuilder,
    pictures: [ImageId; 2],
    coarser: Option<ImageId>,
    effort: &Effort,
    reach: u32,
) -> ImageId {
    let is_finest = plan.desc(pictures[0]).level == effort.finest;
    let steps = if is_finest { effort.refine_finest } else { effort.refine };
    let start = coarser.map_or(Start::Rest, Start::Field);
    let options = inverse_search::Options { start, steps: effort.search, reach };
    let patches = inverse_search::pass(plan, pictures, &options);
    let motion = patch_vote::pass(plan, pictures, patches, reach);
    let warped = brightness_warp::pass(plan, pictures, motion, reach);
    let derivatives = brightness_derivatives::pass(plan, warped);
    motion_refine::pass(plan, &motion_refine::Options { motion, derivatives, steps })
}
