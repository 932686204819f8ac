//! Ports that many nodes share.

use crate::declare::spec::{ImageKind, Port};

/// The picture that a node filters.
pub(crate) const COLOR: Port =
    Port { id: "color", kind: ImageKind::Color, optional: false, doc: "The picture." };

/// The orientation that a node follows, or finds by itself.
pub(crate) const TENSOR: Port = Port {
    id: "tensor",
    kind: ImageKind::Tensor,
    optional: true,
    doc: "The orientation to follow, in all iterations; the smoothed structure tensor of the picture when open.",
};

/// Where marks are anchored that belong to things.
pub(crate) const REST_POSITION: Port = Port {
    id: "rest_position",
    kind: ImageKind::Position,
    optional: true,
    doc: "Points of the undeformed objects, in any unit and 32 bits a channel: marks move with things, and keep their size \
          on screen.",
};

/// Colours of lines at each pixel.
pub(crate) const LINE_PAINT: Port = Port {
    id: "line_paint",
    kind: ImageKind::Color,
    optional: true,
    doc: "Colours of lines: a line has the colour that is painted where it lies, as far as that is opaque, and its own where \
          nothing is painted.",
};

/// Paper on which a style draws or paints.
pub(crate) const PAPER: Port = Port {
    id: "paper",
    kind: ImageKind::Color,
    optional: true,
    doc: "A sheet of paper in the place of the style's own: its colours, and its grain, which is deep where it is darker than \
          what is around it. It stays on the screen.",
};

/// Hatching by which a style says tones.
pub(crate) const HATCHING: Port = Port {
    id: "hatching",
    kind: ImageKind::Hatching,
    optional: true,
    doc: "Hatching in the place of the style's own, in up to four tones: the lightest in red, then green, blue and alpha; 1 is \
          paper, 0 is ink. A channel that is no darker than the one before is no tone. It stays on the screen.",
};

/// The picture that a node gives.
pub(crate) const fn color_output(doc: &'static str) -> Port {
    Port { id: "color", kind: ImageKind::Color, optional: false, doc }
}
