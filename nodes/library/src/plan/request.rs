//! What a host asks for: one picture, its spaces and what is known beside its colour.

use crate::colour_space::{ColourSpace, Encoding};
use crate::frames::Frames;
use crate::graph::GraphInput;

/// What a host wants of a graph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Size of the rendered picture, in pixels.
    pub width: u32,
    /// Size of the rendered picture, in pixels.
    pub height: u32,
    /// Rendered size over full size: 0.5 for a half-size proxy. Scales every parameter in pixels.
    pub scale: f32,
    /// Height of the picture, in pixels, at which parameters in pixels are meant: pictures of other sizes scale them, so
    /// that the same picture gives the same look at any size. 0: pixels are those of the full-size picture.
    pub reference_height: u32,
    /// Height of the canonical picture, in full-size pixels, which the reference is compared with; 0: it is that of this
    /// picture. A bounding box, or a data window within a display window, is not the canonical picture.
    pub canonical_height: u32,
    /// Where the left top corner of the picture stands in the canonical one, in full-size pixels: noise, paper, hatching
    /// and grids are anchored there, so that a bounding box that moves shows the same marks.
    pub origin: [f64; 2],
    /// Number of the frame, which renews what `hold` lets last.
    pub frame: i64,
    /// Space of the colour that enters and leaves.
    pub space: ColourSpace,
    /// True when colour enters, and is to leave, multiplied by alpha.
    pub premultiplied: bool,
    /// True when premultiplied colour may have light where coverage is 0 or little: fire, glows, additive renders. It
    /// is then filtered apart and added to the result, which costs as much again; without, it is lost where coverage
    /// is 0.
    pub emission: bool,
    /// Which guides the host has; connections to others count as open.
    pub guides: Guides,
    /// What there is of neighbouring frames.
    pub frames: Frames,
    /// Longest motion from frame to frame that counts, pixels of the full-size picture; longer ones are unknown. It
    /// bounds how far tiles read their neighbours.
    pub max_motion: f32,
}

/// The guide images that a host can supply beside the colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Guides {
    /// View-space normals.
    pub normal: bool,
    /// Distance from the camera.
    pub depth: bool,
    /// Object numbers.
    pub object_id: bool,
    /// How much of the result is used.
    pub mask: bool,
    /// A painted flow map.
    pub flow: bool,
    /// Motion from the frame before.
    pub motion: bool,
    /// Motion to the next frame.
    pub motion_forward: bool,
    /// Points of the undeformed objects.
    pub rest_position: bool,
}

impl Guides {
    /// Those that `has` says there are.
    pub fn of(has: impl Fn(GraphInput) -> bool) -> Self {
        Self {
            normal: has(GraphInput::Normal),
            depth: has(GraphInput::Depth),
            object_id: has(GraphInput::ObjectId),
            mask: has(GraphInput::Mask),
            flow: has(GraphInput::Flow),
            motion: has(GraphInput::Motion),
            motion_forward: has(GraphInput::MotionForward),
            rest_position: has(GraphInput::RestPosition),
        }
    }

    /// Whether an input is there; the colour always is.
    pub fn has(self, input: GraphInput) -> bool {
        match input {
            GraphInput::Color => true,
            GraphInput::Normal => self.normal,
            GraphInput::Depth => self.depth,
            GraphInput::ObjectId => self.object_id,
            GraphInput::Mask => self.mask,
            GraphInput::Flow => self.flow,
            GraphInput::Motion => self.motion,
            GraphInput::MotionForward => self.motion_forward,
            GraphInput::RestPosition => self.rest_position,
        }
    }
}

/// Longest motion that counts unless a request says otherwise: a pan over the width of a film frame in a second.
pub const MAX_MOTION: f32 = 128.0;

impl Request {
    /// A request for full size, sRGB, premultiplied, without guides.
    pub const fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            scale: 1.0,
            reference_height: 0,
            canonical_height: 0,
            origin: [0.0; 2],
            frame: 0,
            space: ColourSpace::Srgb,
            premultiplied: true,
            emission: false,
            guides: Guides {
                normal: false,
                depth: false,
                object_id: false,
                mask: false,
                flow: false,
                motion: false,
                motion_forward: false,
                rest_position: false,
            },
            frames: Frames::NONE,
            max_motion: MAX_MOTION,
        }
    }

    /// Pixels of the rendered picture that a pixel of a parameter comes to.
    pub fn length_scale(&self) -> f32 {
        if self.reference_height == 0 {
            return self.scale;
        }
        let canonical = match self.canonical_height {
            // The height of the full-size picture times the scale.
            0 => self.height as f32,
            height => height as f32 * self.scale,
        };
        canonical / self.reference_height as f32
    }

    pub(crate) fn encoding(&self) -> Encoding {
        Encoding { space: self.space, premultiplied: self.premultiplied, emission: self.emission }
    }
}
