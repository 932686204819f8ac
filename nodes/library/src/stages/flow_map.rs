//! Flow maps (§ 1.2): what nodes bend tensors of their own by.

use crate::declare::spec::{Param, Scope};
use crate::kernels::smoothing::gaussian_blur;
use crate::kernels::structure::{flow_bend, flow_field};
use isophote_engine::{Class, ImageId, PlanBuilder};

pub(crate) const STRENGTH: Param = Param::float("strength", "Strength", 1.0, [0.0, 1.0])
    .hint("How far directions give way to those that are painted.")
    .doc("How far the field gives way where alpha is 1.");
pub(crate) const SOFTNESS: Param = Param::length("softness", "Softness", 8.0, [0.0, 64.0])
    .slider(0.0, 32.0)
    .structural()
    .hint("How gently the painted directions turn.")
    .doc("Standard deviation of the Gaussian that smooths what was painted, so that directions turn gently.");
pub(crate) const INVERT_Y: Param = Param::bool("invert_y", "Flip green", false)
    .hint("For maps whose green points upwards, as in OpenGL; off where it points downwards.");

/// A painted flow map, smoothed: what other nodes bend the tensors of their own by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flow(pub ImageId);

impl Flow {
    /// Map that is connected to the port `flow` of a node, with the defaults of this one.
    pub(crate) fn of(scope: &mut Scope<'_>) -> Option<Self> {
        let softness = SOFTNESS.default_float() * scope.scale();
        let map = scope.input("flow")?;
        Some(Self::new(scope.plan, map, STRENGTH.default_float(), softness, INVERT_Y.default_bool()))
    }

    /// Flow of a painted map, as strong and as soft as asked for.
    pub(crate) fn new(
        plan: &mut PlanBuilder,
        map: ImageId,
        strength: f32,
        softness: f32,
        invert_y: bool,
    ) -> Self {
        let painted = flow_field::pass(plan, map, strength, invert_y);
        Self(gaussian_blur::pass(plan, painted, softness, Class::Field))
    }

    /// Bends a tensor field.
    pub(crate) fn bend(self, plan: &mut PlanBuilder, tensors: ImageId) -> ImageId {
        flow_bend::pass(plan, tensors, self.0)
    }
}

/// Bends the tensors of a node to what is connected to its port `flow`.
pub(crate) fn bent(scope: &mut Scope<'_>, tensors: ImageId) -> ImageId {
    match Flow::of(scope) {
        Some(flow) => flow.bend(scope.plan, tensors),
        None => tensors,
    }
}
