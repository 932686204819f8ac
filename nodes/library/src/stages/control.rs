//! Control maps: places of a picture directed by an artist, as the guide `control` says (MNPR and its successors have such
//! maps of parameters; the thesis has one value for the whole picture), or by what is found to matter.

use crate::declare::spec::{CONTROL, IMPORTANCE, Scope};
use crate::kernels::colour::{control_density, control_difference, control_marks};
use crate::kernels::lines::line_amount;
use crate::kernels::structure::control_field::{self, Params};
use crate::kernels::structure::control_importance;
use crate::stages::importance::importance;
use isophote_engine::{ImageId, PlanBuilder};

/// The map of a node, where it has one and something is connected.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Control(Option<ImageId>);

/// An orientation field, and whether a factor stands in its fourth channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Directed {
    pub field: ImageId,
    pub scaled: bool,
}

impl Control {
    /// The map that is connected to a node, and that of what matters where the node looks for it.
    pub(crate) fn of(scope: &mut Scope<'_>) -> Self {
        let painted = scope.spec.input(CONTROL.id).and_then(|_| scope.input(CONTROL.id));
        let strength = scope.spec.param(IMPORTANCE.id).map_or(0.0, |_| scope.float(IMPORTANCE.id));
        if strength <= 0.0 {
            return Self(painted);
        }
        let importance = importance(scope);
        Self(Some(control_importance::pass(scope.plan, importance, painted, strength)))
    }

    /// The field that smoothing follows, with factors on `sigma_r`: more detail, less tolerance.
    pub(crate) fn detailed(self, plan: &mut PlanBuilder, field: ImageId) -> Directed {
        self.directed(plan, field, Params { channel: 0, sense: -1.0, least: 0.0 })
    }

    /// The field that lines follow, with factors on their width; none becomes narrower than `least` of what it was.
    pub(crate) fn widened(self, plan: &mut PlanBuilder, field: ImageId, least: f32) -> Directed {
        self.directed(plan, field, Params { channel: 1, sense: 1.0, least })
    }

    fn directed(self, plan: &mut PlanBuilder, field: ImageId, params: Params) -> Directed {
        match self.0 {
            Some(map) => Directed { field: control_field::pass(plan, field, map, &params), scaled: true },
            None => Directed { field, scaled: false },
        }
    }

    /// A response of a line filter, of which lightness (L alpha, alpha) has the weight `base`, with more or fewer lines.
    pub(crate) fn numbered(
        self,
        plan: &mut PlanBuilder,
        [response, lightness]: [ImageId; 2],
        base: f32,
    ) -> ImageId {
        self.0.map_or(response, |map| line_amount::pass(plan, [response, lightness, map], base))
    }

    /// A filtered picture, closer to the picture itself where more detail is wanted.
    pub(crate) fn kept(self, plan: &mut PlanBuilder, images: [ImageId; 2]) -> ImageId {
        self.weighed(plan, images, control_difference::Params { channel: 0, sense: -1.0, most: 1.0 })
    }

    /// A coarse picture, further from the picture itself where more detail is wanted: finer strokes paint the difference.
    pub(crate) fn contrasted(self, plan: &mut PlanBuilder, images: [ImageId; 2]) -> ImageId {
        self.weighed(plan, images, control_difference::Params { channel: 0, sense: 1.0, most: f32::MAX })
    }

    /// Strokes over a picture, fainter where less of the medium is wanted.
    pub(crate) fn laid(self, plan: &mut PlanBuilder, images: [ImageId; 2]) -> ImageId {
        self.weighed(plan, images, control_difference::Params { channel: 3, sense: 1.0, most: 1.0 })
    }

    fn weighed(
        self,
        plan: &mut PlanBuilder,
        [first, second]: [ImageId; 2],
        params: control_difference::Params,
    ) -> ImageId {
        self.0.map_or(second, |map| control_difference::pass(plan, [first, second], map, &params))
    }

    /// A picture in transparent paint, with more or less of it.
    pub(crate) fn diluted(self, plan: &mut PlanBuilder, painted: ImageId) -> ImageId {
        self.0.map_or(painted, |map| control_density::pass(plan, painted, map))
    }

    /// The share of the paper that marks cover, with more or fewer of them.
    pub(crate) fn marked(self, plan: &mut PlanBuilder, marks: ImageId) -> ImageId {
        self.0.map_or(marks, |map| control_marks::pass(plan, marks, map))
    }
}
