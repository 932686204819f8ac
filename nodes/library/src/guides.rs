//! The pictures that may enter a graph: the colour, and the guides that a host knows beside it.
//!
//! This is the one list of guides. The C face, OpenFX and the page walk it. Text that must be there before a library is loaded
//! (constants of the C header, the program's names of guides, arguments in Python, types for TypeScript) is written from it by
//! `cargo xtask guides`.

use crate::declare::spec::ImageKind;

/// Declares the guides: document, variant, id, label, the kind of picture that each is, the number of its bit in requests of
/// the C face, and the place of its OpenFX clip.
macro_rules! guides {
    ($($(#[doc = $doc:literal])+ $guide:ident $id:ident ($label:literal, $kind:ident, $bit:literal, $clip:expr),)+) => {
        /// A picture that enters a graph.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum GraphInput {
            /// The picture to stylize.
            Color,
            $($(#[doc = $doc])+ $guide,)+
        }

        impl GraphInput {
            /// All of them, the colour first.
            pub const ALL: [Self; 1 + Self::GUIDES.len()] = [Self::Color, $(Self::$guide,)+];

            /// All but the colour.
            pub const GUIDES: [Self; [$(stringify!($id),)+].len()] = [$(Self::$guide,)+];

            /// Stable name, which is also the name of the plan's input.
            pub const fn id(self) -> &'static str {
                match self {
                    Self::Color => "color",
                    $(Self::$guide => stringify!($id),)+
                }
            }

            /// Name for people.
            pub const fn label(self) -> &'static str {
                match self {
                    Self::Color => "Colour",
                    $(Self::$guide => $label,)+
                }
            }

            /// Sentence for people: content of the picture.
            pub const fn doc(self) -> &'static str {
                match self {
                    Self::Color => "The picture to stylize.",
                    $(Self::$guide => concat!($($doc,)+).trim_ascii(),)+
                }
            }

            /// Kind of picture, which has the channels and the precision.
            pub const fn kind(self) -> ImageKind {
                match self {
                    Self::Color => ImageKind::Color,
                    $(Self::$guide => ImageKind::$kind,)+
                }
            }

            /// Bit in the guides of a request in C; 0 for the colour, which is always there. Bits are for ever: a new guide
            /// takes the next.
            pub const fn bit(self) -> u32 {
                match self {
                    Self::Color => 0,
                    $(Self::$guide => 1 << $bit,)+
                }
            }

            /// Place of its clip among those of guides in OpenFX; none for what is no such clip: the picture, and the mask,
            /// which the effects apply themselves. Hosts store inputs by their numbers, so that places are for ever: a new
            /// guide takes the next.
            pub const fn clip(self) -> Option<u32> {
                match self {
                    Self::Color => None,
                    $(Self::$guide => $clip,)+
                }
            }
        }

        /// The guides that a host can supply beside the colour.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct Guides {
            $($(#[doc = $doc])+ pub $id: bool,)+
        }

        impl Guides {
            /// None of them.
            pub const NONE: Self = Self { $($id: false,)+ };

            /// Set of those that `has` says there are.
            pub fn of(has: impl Fn(GraphInput) -> bool) -> Self {
                Self { $($id: has(GraphInput::$guide),)+ }
            }

            /// True where an input is there; the colour always is.
            pub const fn has(self, input: GraphInput) -> bool {
                match input {
                    GraphInput::Color => true,
                    $(GraphInput::$guide => self.$id,)+
                }
            }
        }
    };
}

guides! {
    /// View-space normals, x right, y up, z towards the camera.
    Normal normal ("Normal", Normal, 0, Some(0)),
    /// Distance from the camera, 0 or less where there is nothing.
    Depth depth ("Depth", Depth, 1, Some(1)),
    /// A number per object, 0 where there is nothing.
    ObjectId object_id ("Object id", ObjectId, 2, Some(5)),
    /// Share of the result that is used, 0 to 1.
    Mask mask ("Mask", Scalar, 3, None),
    /// A painted flow map: x and y in red and green, 0.5 for none, and its strength in alpha.
    Flow flow ("Flow", Flow, 4, Some(6)),
    /// Pixels from where points are to where they were in the frame before.
    Motion motion ("Motion", Motion, 5, Some(2)),
    /// Pixels from where points are to where they will be in the next frame.
    MotionForward motion_forward ("Motion forward", Motion, 6, Some(3)),
    /// Points of the undeformed objects.
    RestPosition rest_position ("Rest position", Position, 7, Some(4)),
    /// Colours of surfaces without light, in the picture's space.
    Albedo albedo ("Albedo", Color, 8, Some(7)),
    /// Light that surfaces reflect in all directions, in their colours and the picture's space.
    Diffuse diffuse ("Diffuse light", Color, 9, Some(8)),
    /// Light that surfaces mirror: highlights and reflections, in the picture's space.
    Specular specular ("Specular light", Color, 10, Some(9)),
    /// A control map, 0.5 for no change: detail, width of lines, their amount, and strength of the medium.
    Control control ("Control", Control, 11, Some(10)),
    /// A sheet of paper: its colours, and its grain, which is deep where it is darker than around; white where it is transparent.
    Paper paper ("Paper", Color, 12, Some(11)),
    /// Hatching in up to four tones, the lightest in red and the darkest in alpha: 1 is paper, 0 is ink.
    Hatching hatching ("Hatching", Hatching, 13, Some(12)),
    /// Colours of lines: that of the line here, as far as it is opaque.
    LinePaint line_paint ("Line paint", Color, 14, Some(13)),
    /// The two things that cover most of a pixel by a Cryptomatte: id of the one's name and its share, then those of the other.
    Cryptomatte cryptomatte ("Cryptomatte", Cryptomatte, 15, Some(14)),
}

impl GraphInput {
    /// The input of this name.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|input| input.id() == id)
    }

    /// The guide of this name.
    pub fn guide_from_id(id: &str) -> Option<Self> {
        Self::from_id(id).filter(|input| *input != Self::Color)
    }

    /// True for a picture whose numbers are colours, which have a space. Those of all others are data.
    pub const fn is_colour(self) -> bool {
        matches!(self.kind(), ImageKind::Color)
    }

    /// True for where points are in another frame.
    pub const fn is_motion(self) -> bool {
        matches!(self.kind(), ImageKind::Motion)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_find_their_inputs() {
        for input in GraphInput::ALL {
            assert_eq!(GraphInput::from_id(input.id()), Some(input));
            assert_eq!(GraphInput::guide_from_id(input.id()).is_some(), input != GraphInput::Color);
            assert!(input.doc().ends_with('.') && !input.label().is_empty());
        }
        assert_eq!(GraphInput::from_id("normals"), None);
    }

    #[test]
    fn sets_hold_what_they_were_made_of() {
        for input in GraphInput::GUIDES {
            let one = Guides::of(|guide| guide == input);
            for other in GraphInput::GUIDES {
                assert_eq!(one.has(other), other == input);
            }
            assert!(one.has(GraphInput::Color) && !Guides::NONE.has(input));
        }
    }
}
