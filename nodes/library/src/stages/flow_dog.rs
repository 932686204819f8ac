//! The flow-based difference of Gaussians (§ 4.5), with lines where geometry breaks.

use crate::declare::choice::choice;
use crate::declare::spec::{ImageKind, Param, Port, Scope};
use crate::kernels::lines::flow_dog_two_dimensional::{self, Stepping};
use crate::kernels::lines::{
    colour_edges, darken_by_lines, depth_width, dog_columns, flow_dog_cabral_leedom, flow_dog_gradient,
    flow_dog_tangent, guide_lines, lab_channel,
};
use crate::kernels::shared::edge_threshold::{Threshold, Xdog};
use crate::kernels::structure::orientation_field;
use crate::stages::control::{Control, Directed};
use crate::stages::line_context::{Ground, LineContext};
use crate::stages::line_width;
use crate::stages::structure_tensor::of_color_and_guides;
use crate::stages::tensor_options::{Guides, TensorOptions};
use isophote_engine::{ImageId, PlanBuilder};

pub(crate) const NORMAL: Port = Port {
    id: "normal",
    kind: ImageKind::Normal,
    optional: true,
    doc: "View-space normals; creases draw lines.",
};
pub(crate) const DEPTH: Port = Port {
    id: "depth",
    kind: ImageKind::Depth,
    optional: true,
    doc: "Distance from the camera; jumps draw lines, relative to the distance and never on planes.",
};
pub(crate) const OBJECT_ID: Port = Port {
    id: "object_id",
    kind: ImageKind::ObjectId,
    optional: true,
    doc: "Object numbers; borders between objects draw lines.",
};
pub(crate) const SIGMA_M: Param = Param::length("sigma_m", "Line smoothing", 3.0, [0.0, 60.0])
    .slider(0.0, 15.0)
    .hint("How far lines are smoothed along themselves: more gives longer lines and less noise.")
    .doc("Standard deviation of the smoothing along the edges.");

choice! {
    /// The window of the filter.
    pub(crate) enum Kernel {
        /// Across the edge at each pixel, then along the line.
        Separable ("separable", "Fast"),
        /// Across the edge at every point of the line.
        TwoDimensional ("two_dimensional", "Thorough"),
    }
}

/// Options of lines along the flow; lengths in pixels of the picture that is rendered. Those of a node pass through
/// [`FlowDog::on_pixels`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlowDog {
    pub sigma_e: f32,
    pub k: f32,
    pub sigma_m: f32,
    pub xdog: Xdog,
    pub iterations: i32,
    pub stepping: Stepping,
    pub kernel: Kernel,
    pub guide_weight: f32,
    /// Weight of the picture's own edges, 0..=1.
    pub texture: f32,
    /// Creases, outlines, and borders between things that touch.
    pub guided: [Guided; guide_lines::KINDS],
    /// Lines narrower than a pixel are fainter.
    pub fades: bool,
    /// What is around lines, as far as it counts; it does in the separable filter.
    pub context: LineContext,
    /// Weight of the colour axes beside lightness; 0 leaves them unread. It counts in the separable filter.
    pub colour: f32,
    /// Width by distance; it counts in the separable filter, where depth is given.
    pub distance: Distance,
}

/// Standard deviations that a line reaches from a break, and the most pixels.
const REACH: f32 = 3.0;
const MOST_REACH: f32 = 64.0;

/// Width of lines by the distance from the camera.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Distance {
    /// Distance up to which lines keep their width, and that from which on they have the other one, scene units.
    pub near: f32,
    pub far: f32,
    /// Factor on widths far away; 1 leaves distances unread.
    pub width: f32,
}

impl Distance {
    /// One width everywhere.
    pub(crate) const NONE: Self = Self { near: 0.0, far: 0.0, width: 1.0 };

    /// A field with factors of widths by the distance of the nearest thing within `radius` pixels.
    fn widened(
        self,
        plan: &mut PlanBuilder,
        directed: Directed,
        depth: ImageId,
        radius: f32,
        least: f32,
    ) -> Directed {
        let params = depth_width::Params {
            near: self.near,
            inverse_range: 1.0 / (self.far - self.near).max(1e-6),
            change: self.width - 1.0,
            radius,
            least,
            scaled: directed.scaled.into(),
        };
        Directed { field: depth_width::pass(plan, [directed.field, depth], &params), scaled: true }
    }
}

/// Picture that lines are found in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// (L alpha, alpha).
    pub lightness: ImageId,
    /// The same picture in CIELAB, where colours count.
    pub lab: Option<ImageId>,
    /// Width and amount of lines by place; they count in the separable filter.
    pub control: Control,
}

/// Kind of lines that guides draw.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guided {
    /// Standard deviation across them, as `sigma_e` is for the picture's own; 0 draws none.
    pub sigma: f32,
    /// Share of the guides' weight.
    pub strength: f32,
}

impl Guided {
    /// Lines of a standard deviation that count in full.
    pub(crate) const fn new(sigma: f32) -> Self {
        Self { sigma, strength: 1.0 }
    }
}

impl FlowDog {
    /// The lines as the grid of pixels shows them: none narrower than a pixel, but fainter, as faint as the widest kind of
    /// them that there is in the picture of `scope`.
    pub(crate) fn on_pixels(self, scope: &Scope<'_>) -> Self {
        let guides = guides(scope, self.guide_weight);
        let own = if self.texture > 0.0 { self.sigma_e } else { 0.0 };
        let some = guides != Guides::default();
        let there = [guides.normal.is_some(), some, some && guides.object_id.is_some()];
        let kinds = self.guided.iter().zip(there).filter(|(_, there)| *there);
        let widest = kinds.fold(own, |widest, (kind, _)| kind.sigma.max(widest));
        let widest = if widest > 0.0 { widest } else { self.sigma_e };
        let faintness = if self.fades { line_width::faintness(widest) } else { 0.0 };
        let guided = self.guided.map(|Guided { sigma, strength }| Guided {
            sigma: line_width::drawable(sigma),
            strength: strength * line_width::strength(sigma, widest),
        });
        Self {
            sigma_e: line_width::drawable(self.sigma_e),
            xdog: Xdog { faintness, ..self.xdog },
            guided,
            ..self
        }
    }

    /// The edge image of a picture along the stream lines of `tensor`.
    pub(crate) fn edges(
        &self,
        plan: &mut PlanBuilder,
        seen: Seen,
        tensor: ImageId,
        guides: &Guides,
    ) -> ImageId {
        let field = orientation_field::pass(plan, tensor);
        self.iterate(plan, seen.lightness, |plan, source, xdog| match self.kernel {
            Kernel::Separable => {
                let seen = Seen { lightness: source, ..seen };
                let response = self.across(plan, seen, field, guides, xdog);
                let response = seen.control.numbered(plan, [response, source], xdog.base);
                self.along(plan, response, field, &xdog)
            }
            Kernel::TwoDimensional => {
                let directed = Directed { field, scaled: false };
                let marked = self.with_guides(plan, source, directed, guides);
                let options = flow_dog_two_dimensional::Options {
                    sigma_e: self.sigma_e,
                    k: self.k,
                    sigma_m: self.sigma_m,
                    stepping: self.stepping,
                    xdog,
                };
                flow_dog_two_dimensional::pass(plan, [source, field, marked], &options)
            }
        })
    }

    /// The first pass of the separable filter.
    fn across(
        &self,
        plan: &mut PlanBuilder,
        seen: Seen,
        field: ImageId,
        guides: &Guides,
        xdog: Xdog,
    ) -> ImageId {
        let mut own = Xdog { edge: xdog.edge * self.texture, ..xdog };
        let Xdog { base, edge, .. } = own;
        let lab = seen.lab.filter(|_| self.colour > 0.0);
        let is_plain = lab.is_none() && self.context.is_off();
        if !is_plain {
            // Lightness is added to what the differences come to.
            own.base = 0.0;
        }
        let directed = self.directed(plan, seen.control, field, guides.depth);
        let options =
            flow_dog_gradient::Options { sigma: self.sigma_e, k: self.k, xdog: own, scaled: directed.scaled };
        let mut response = flow_dog_gradient::pass(plan, seen.lightness, directed.field, &options);
        if let Some(lab) = lab {
            let [a, b] = [0, 1].map(|axis| {
                let channel = lab_channel::pass(plan, lab, axis);
                flow_dog_gradient::pass(plan, channel, directed.field, &options)
            });
            let params = colour_edges::Params { weight: self.colour };
            response = colour_edges::pass(plan, [response, a, b], &params);
        }
        if !is_plain {
            let ground = Ground { lightness: seen.lightness, field, base, edge };
            response = self.context.weighed(plan, response, &ground);
        }
        self.with_guides(plan, response, directed, guides)
    }

    /// The standard deviation of the widest kind of lines.
    pub(crate) fn widest(&self) -> f32 {
        self.guided.iter().fold(self.sigma_e, |widest, kind| widest.max(kind.sigma))
    }

    /// The standard deviation of outlines.
    pub(crate) const fn outline(&self) -> f32 {
        self.guided[guide_lines::OUTLINE].sigma
    }

    /// The field that lines follow, with factors on their widths where places or distances ask for them.
    fn directed(
        &self,
        plan: &mut PlanBuilder,
        control: Control,
        field: ImageId,
        depth: Option<ImageId>,
    ) -> Directed {
        let least = line_width::drawable(0.0) / self.sigma_e.max(1e-6);
        let directed = control.widened(plan, field, least);
        match depth.filter(|_| self.distance.width != 1.0) {
            Some(depth) => {
                // As far as lines reach from the things that they belong to.
                let radius = (REACH * self.widest() * self.distance.width.max(1.0)).min(MOST_REACH);
                self.distance.widened(plan, directed, depth, radius, least.min(1.0))
            }
            None => directed,
        }
    }

    /// Thresholds that give an edge image, which alone can darken the input of the next iteration; its lines are not faint.
    fn deciding(&self) -> Xdog {
        let threshold = match self.xdog.threshold {
            Threshold::None => Threshold::Tanh,
            threshold => threshold,
        };
        Xdog { threshold, faintness: 0.0, ..self.xdog }
    }

    /// The edge image of (L alpha, alpha) by the difference of Gaussians in all directions alike (§ 4.2).
    pub(crate) fn isotropic(&self, plan: &mut PlanBuilder, lightness: ImageId) -> ImageId {
        self.iterate(plan, lightness, |plan, source, xdog| {
            dog_columns::pass(plan, source, &dog_columns::Options { sigma: self.sigma_e, k: self.k, xdog })
        })
    }

    /// Filters as often as asked for, each time the lightness times the lines found so far.
    fn iterate(
        &self,
        plan: &mut PlanBuilder,
        lightness: ImageId,
        filter: impl Fn(&mut PlanBuilder, ImageId, Xdog) -> ImageId,
    ) -> ImageId {
        let (mut source, mut edges) = (lightness, lightness);
        for iteration in 1..=self.iterations {
            let last = iteration == self.iterations;
            let xdog = if last { self.xdog } else { self.deciding() };
            edges = filter(plan, source, xdog);
            if !last {
                source = darken_by_lines::pass(plan, lightness, edges);
            }
        }
        edges
    }

    /// A response, or any image of that shape, with the lines that the guides draw.
    fn with_guides(
        &self,
        plan: &mut PlanBuilder,
        response: ImageId,
        Directed { field, scaled }: Directed,
        guides: &Guides,
    ) -> ImageId {
        let guides = [guides.normal, guides.depth, guides.object_id];
        if self.guide_weight <= 0.0 || guides.iter().all(Option::is_none) {
            return response;
        }
        let options = guide_lines::Options {
            sigmas: self.guided.map(|kind| kind.sigma),
            weights: self.guided.map(|kind| self.guide_weight * kind.strength),
            edge: self.xdog.edge,
            scaled,
        };
        guide_lines::pass(plan, response, field, guides, &options)
    }

    /// The second pass of the separable filter.
    fn along(&self, plan: &mut PlanBuilder, response: ImageId, field: ImageId, xdog: &Xdog) -> ImageId {
        match self.stepping {
            Stepping::Along(integrator) => {
                let options = flow_dog_tangent::Options { sigma: self.sigma_m, integrator, xdog: *xdog };
                flow_dog_tangent::pass(plan, response, field, &options)
            }
            Stepping::CabralLeedom => flow_dog_cabral_leedom::pass(plan, response, field, self.sigma_m, xdog),
        }
    }
}

/// The guides connected to a node, as far as `weight` lets them count.
pub(crate) fn guides(scope: &Scope<'_>, weight: f32) -> Guides {
    if weight <= 0.0 {
        return Guides::default();
    }
    Guides { normal: scope.input("normal"), depth: scope.input("depth"), object_id: scope.input("object_id") }
}

/// The tensor of a picture and of the guides that count, for a node without a connected one.
pub(crate) fn tensor(scope: &mut Scope<'_>, color: ImageId, guides: &Guides) -> ImageId {
    let options = TensorOptions::at_scale(scope.scale());
    of_color_and_guides(scope.plan, color, guides, &options)
}
