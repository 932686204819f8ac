//! Request of a host for one picture: its spaces and what is known beside its colour.

use crate::colour_space::{ColourSpace, Encoding};
use crate::frames::Frames;
pub use crate::guides::Guides;

/// Request of a host for one picture of a graph.
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
    /// Neighbouring frames that are there.
    pub frames: Frames,
    /// Longest motion from frame to frame that counts, pixels of the full-size picture; longer ones are unknown. It
    /// bounds how far tiles read their neighbours.
    pub max_motion: f32,
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
            guides: Guides::NONE,
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
