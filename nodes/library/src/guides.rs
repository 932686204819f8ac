//! The pictures that may enter a graph: the colour, and the guides that a host knows beside it.
//!
//! This is the one list of guides. The C face, OpenFX, the program, Python, Blender and the page walk it, or match it so that
//! the compiler asks for what is new.

use crate::declare::spec::ImageKind;

/// Declares the guides: document, variant, id, label, and the kind of picture that each is.
macro_rules! guides {
    ($($(#[doc = $doc:literal])+ $guide:ident $id:ident ($label:literal, $kind:ident),)+) => {
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
    Normal normal ("Normal", Normal),
    /// Distance from the camera, 0 or less where there is nothing.
    Depth depth ("Depth", Depth),
    /// A number per object, 0 where there is nothing.
    ObjectId object_id ("Object id", ObjectId),
    /// Share of the result that is used, 0 to 1.
    Mask mask ("Mask", Scalar),
    /// A painted flow map: x and y in red and green, 0.5 for none, and its strength in alpha.
    Flow flow ("Flow", Flow),
    /// Pixels from where points are to where they were in the frame before.
    Motion motion ("Motion", Motion),
    /// Pixels from where points are to where they will be in the next frame.
    MotionForward motion_forward ("Motion forward", Motion),
    /// Points of the undeformed objects.
    RestPosition rest_position ("Rest position", Position),
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
