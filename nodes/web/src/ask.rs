//! Request of a page.

use isophote::engine::Rect;
use isophote::engine::program::Precision;
use isophote::graph::GraphInput;
use isophote::request::Guides;
use isophote::{ColourSpace, Error};
use serde::Deserialize;
use serde_json::Value;

/// A call, told apart by its key `ask`.
#[derive(Debug, Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case", deny_unknown_fields)]
pub enum Request {
    /// All nodes with their inputs and parameters, and the guides.
    Catalogue,
    /// A look as a graph file, with the parameters that differ from their defaults.
    Graph {
        /// A preset, a graph, or the name of a node or a look.
        look: Value,
        /// Frame whose keys count.
        #[serde(default)]
        frame: i64,
    },
    /// A new plan: its number and its program.
    Plan {
        /// A preset, a graph, or the name of a node or a look.
        look: Value,
        /// The picture.
        picture: Picture,
        /// Part of the picture that is computed, `[x0, y0, x1, y1]`; all of it without.
        region: Option<[i32; 4]>,
    },
    /// Another look, frame or origin for a plan: whether uniform bytes alone changed, and the program.
    Update {
        /// Its number.
        plan: u32,
        /// A preset, a graph, or the name of a node or a look.
        look: Value,
        /// The picture, of the same size.
        picture: Picture,
    },
    /// Another region for a plan: the program.
    Region {
        /// Its number.
        plan: u32,
        /// Part of the picture that is computed.
        region: [i32; 4],
    },
    /// The shader of a dispatch.
    Shader {
        /// Number of the plan.
        plan: u32,
        /// Index of the dispatch.
        dispatch: usize,
    },
    /// Forgets a plan.
    Release {
        /// Its number.
        plan: u32,
    },
    /// Parts that the processor computes a picture in, and what each reads.
    Parts {
        /// A preset, a graph, or the name of a node or a look.
        look: Value,
        /// The picture.
        picture: Picture,
        /// Bytes that a part may take.
        memory: u64,
    },
    /// The pixels of a part, computed by the processor.
    #[cfg(feature = "cpu")]
    Compute {
        /// A preset, a graph, or the name of a node or a look.
        look: Value,
        /// The picture.
        picture: Picture,
        /// The part.
        region: [i32; 4],
        /// By input: the window that is given, four bytes a pixel, one input after the other.
        inputs: std::collections::BTreeMap<String, [i32; 4]>,
    },
}

/// The picture that is computed.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Picture {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// `srgb`, `linear` or `acescg`.
    #[serde(default)]
    space: Space,
    /// `straight`, `premultiplied` or `emissive`.
    #[serde(default)]
    alpha: Alpha,
    /// `exact`, `half` or `fast`.
    #[serde(default)]
    precision: Accuracy,
    /// Ids of the guides that the page has.
    #[serde(default)]
    guides: Vec<String>,
    /// Number of the frame.
    #[serde(default)]
    pub frame: i64,
    /// Frames before this one that are known, for looks that are steady over time; none for a still.
    pub past: Option<u32>,
    /// Position of the picture in the canonical one, pixels of the full size.
    #[serde(default)]
    origin: [f64; 2],
    /// Size over full size.
    #[serde(default = "one")]
    scale: f32,
}

const fn one() -> f32 {
    1.0
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Space {
    #[default]
    Srgb,
    Linear,
    AcesCg,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Alpha {
    Straight,
    #[default]
    Premultiplied,
    Emissive,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Accuracy {
    #[default]
    Exact,
    Half,
    Fast,
}

impl Picture {
    /// Precision in which it is computed.
    pub fn precision(&self) -> Precision {
        match self.precision {
            Accuracy::Exact => Precision::Exact,
            Accuracy::Half => Precision::Half,
            Accuracy::Fast => Precision::Fast,
        }
    }

    /// Request to the library, where lengths are those of pictures of so many lines.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a guide that is none.
    pub fn request(&self, reference_height: u32) -> Result<isophote::Request, Error> {
        if let Some(unknown) = self.guides.iter().find(|id| GraphInput::guide_from_id(id).is_none()) {
            let known = GraphInput::GUIDES.map(GraphInput::id).join(", ");
            return Err(Error::Unknown(format!("'{unknown}' is no guide; the guides are {known}")));
        }
        let (premultiplied, emission) = match self.alpha {
            Alpha::Straight => (false, false),
            Alpha::Premultiplied => (true, false),
            Alpha::Emissive => (true, true),
        };
        Ok(isophote::Request {
            scale: self.scale,
            reference_height,
            origin: self.origin,
            frame: self.frame,
            space: match self.space {
                Space::Srgb => ColourSpace::Srgb,
                Space::Linear => ColourSpace::Linear,
                Space::AcesCg => ColourSpace::AcesCg,
            },
            premultiplied,
            emission,
            guides: Guides::of(|input| self.guides.iter().any(|id| id == input.id())),
            ..isophote::Request::new(self.width, self.height)
        })
    }
}

/// The region that a page names.
pub const fn region([x0, y0, x1, y1]: [i32; 4]) -> Rect {
    Rect { x0, y0, x1, y1 }
}
