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

/// The picture that a node gives.
pub(crate) const fn color_output(doc: &'static str) -> Port {
    Port { id: "color", kind: ImageKind::Color, optional: false, doc }
}
