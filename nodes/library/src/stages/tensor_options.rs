//! Options of a structure tensor: the parameters and their values, and the guide images that count in it.

use crate::declare::choice::choice;
use crate::declare::spec::{Param, Scope};
use crate::kernels::structure::gradient_tensor::Derivative;
use crate::kernels::structure::guide_tensor::Guide;
use isophote_engine::ImageId;

choice! {
    /// The derivative operator.
    pub enum Operator {
        /// Central differences.
        Central ("central", "Central differences"),
        /// The Sobel operator.
        Sobel ("sobel", "Sobel"),
        /// The 3x3 operator that treats all directions alike.
        Scharr3 ("scharr3", "Scharr 3x3"),
        /// The 5x5 operator that treats all directions alike.
        Scharr5 ("scharr5", "Scharr 5x5"),
        /// Derivatives of a Gaussian.
        Gaussian ("gaussian", "Gaussian"),
    }
}

choice! {
    /// Picture that the gradient is taken of.
    pub enum Space {
        /// Gamma-encoded RGB.
        Rgb ("rgb", "RGB"),
        /// The Rec. 709 luma of gamma-encoded RGB.
        Luminance ("luminance", "Luminance"),
        /// CIELAB divided by 100.
        Lab ("lab", "CIELAB"),
    }
}

pub(crate) const DERIVATIVE: Param =
    Param::choice("derivative", "Edge operator", Operator::Scharr3.selected())
        .uniform()
        .hint("How changes of colour are measured.")
        .doc("Derivative operator: (2.18), (2.23), (2.27), (2.29) or (2.22).");
pub(crate) const SIGMA_G: Param = Param::length("sigma_g", "Operator size", 0.867, [0.2, 6.0])
    .slider(0.4, 3.0)
    .hint("Size of the Gaussian operator; the others do not use it.").doc("Standard deviation of the Gaussian derivative (2.22); the other operators ignore it unless oversampled.");
pub(crate) const RHO: Param = Param::length("rho", "Flow scale", 2.0, [0.0, 40.0])
    .slider(0.0, 10.0)
    .hint("Size of the forms that are followed: larger values turn more gently.")
    .doc("Standard deviation of the Gaussian that smooths the tensor.");
pub(crate) const SPACE: Param = Param::choice("space", "Colour space", Space::Rgb.selected()).hint("How colours are compared: as they are stored, by lightness alone, or as the eye sees them.").doc(
    "What the gradient is taken of: gamma-encoded RGB, its Rec. 709 luma, or CIELAB divided by 100, so that \
     from black to white is a step of 1.",
);
pub(crate) const NORMALIZE: Param = Param::bool("normalize", "Even contrast", false)
    .hint("Lets weak edges count nearly as much as strong ones.").doc("Divides each channel's tensor by the magnitude of its gradient (2.133), so that strong edges dominate less.");
pub(crate) const RELAX_THRESHOLD: Param = Param::float("relax_threshold", "Flow threshold", 0.0, [0.0, 10.0])
    .slider(0.0, 0.2)
    .structural()
    .hint(
        "Where the picture is flatter than this, its direction is taken from around it; 0 keeps every edge.",
    )
    .doc(
        "Keeps tensors where sqrt(lambda1) is above this before smoothing (2.164) and fills the others \
             smoothly; 0 keeps all.",
    );
pub(crate) const RELAX_STEPS: Param = Param::int("relax_steps", "Filling rounds", 1, [1, 3])
    .structural()
    .hint("How carefully flat areas are filled with directions from around them.")
    .doc("Jacobi steps on each level of the pyramid (2.171).");
pub(crate) const LEVELS: Param = Param::int("levels", "Scales", 1, [1, 8])
    .structural()
    .hint("Sizes at which directions are looked for: more are robust against noise.")
    .doc(
        "Levels of the multi-scale estimation (2.172): each further one halves the picture, and its tensor, \
     upsampled, joins by its anisotropy (2.173). Guides join on the finest.",
    );
pub(crate) const OVERSAMPLE: Param = Param::bool("oversample", "Double resolution", false)
    .structural()
    .hint("Looks at twice the resolution: exact for the finest texture, and about ten times as slow.")
    .doc(
        "Takes derivatives at twice the resolution (2.4.6), those of the Gaussian of sigma_g whatever the \
     operator: exact also for the finest texture, at about ten times the cost.",
    );
pub(crate) const GUIDE_WEIGHT: Param = Param::float("guide_weight", "Guide strength", 1.0, [0.0, 100.0])
    .slider(0.0, 4.0)
    .hint("How much normals, depth and object ids count.")
    .doc("Factor on the tensors of normals, depth and object numbers.");

/// Options of a tensor; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TensorOptions {
    /// Derivative operator.
    pub derivative: Derivative,
    /// Standard deviation of the smoothing.
    pub rho: f32,
    /// Picture that the gradient is taken of.
    pub space: Space,
    /// Divide by the gradient's magnitude (2.133).
    pub normalize: bool,
    /// Fill tensors whose sqrt(lambda1) is not above this; 0: none.
    pub relax_threshold: f32,
    /// Jacobi steps per level.
    pub relax_steps: i32,
    /// Levels of the multi-scale estimation (2.172), from 1 on.
    pub levels: i32,
    /// Take derivatives at twice the resolution, those of a Gaussian of this standard deviation.
    pub oversample: Option<f32>,
    /// Factor on the tensors of the guides.
    pub guide_weight: f32,
    /// Size of the picture over its full size, as far as the smoothing has to compensate for it.
    pub scale: f32,
}

impl Default for TensorOptions {
    /// The defaults of the parameters, for a picture of full size.
    fn default() -> Self {
        Self {
            derivative: derivative(DERIVATIVE.default_option(), SIGMA_G.default_float()),
            rho: RHO.default_float(),
            space: SPACE.default_option(),
            normalize: NORMALIZE.default_bool(),
            relax_threshold: RELAX_THRESHOLD.default_float(),
            relax_steps: RELAX_STEPS.default_int(),
            levels: LEVELS.default_int(),
            oversample: OVERSAMPLE.default_bool().then_some(SIGMA_G.default_float()),
            guide_weight: GUIDE_WEIGHT.default_float(),
            scale: 1.0,
        }
    }
}

/// The operator as its kernel takes it; `sigma_g` is the width of the Gaussian one.
fn derivative(operator: Operator, sigma_g: f32) -> Derivative {
    match operator {
        Operator::Central => Derivative::Central,
        Operator::Sobel => Derivative::Sobel,
        Operator::Scharr3 => Derivative::Scharr3,
        Operator::Scharr5 => Derivative::Scharr5,
        Operator::Gaussian => Derivative::Gaussian(sigma_g),
    }
}

impl TensorOptions {
    /// The values of the parameters.
    pub(crate) fn of(scope: &Scope<'_>) -> Self {
        let sigma_g = scope.float("sigma_g");
        Self {
            derivative: derivative(scope.option("derivative"), sigma_g),
            rho: scope.float("rho"),
            space: scope.option("space"),
            normalize: scope.bool("normalize"),
            relax_threshold: scope.float("relax_threshold"),
            relax_steps: scope.int("relax_steps"),
            levels: scope.int("levels"),
            oversample: scope.bool("oversample").then_some(sigma_g),
            guide_weight: scope.float("guide_weight"),
            scale: scope.scale(),
        }
    }

    /// Standard deviation of the smoothing that gives a proxy the tensors of the full picture. A pixel of
    /// a proxy is a mean over several, and its operator reaches over several, so that gradients come
    /// smoothed by that much more. Tensors are squares of gradients: the square of a Gaussian edge, and of
    /// one that falls off exponentially, has half of its variance, and so does what the smoothing adds.
    pub(crate) fn smoothing(&self) -> f32 {
        if self.scale >= 1.0 {
            return self.rho;
        }
        let wider = 1.0 - self.scale * self.scale;
        let operator = if self.oversample.is_some() { 0.0 } else { self.derivative.variance() };
        (self.rho * self.rho - 0.5 * wider * (operator + 1.0 / 12.0)).max(0.0).sqrt()
    }

    /// The defaults for a picture rendered at `scale` of its full size: what the node `structure_tensor` makes
    /// with its own.
    pub fn at_scale(scale: f32) -> Self {
        let default = Self::default();
        Self { rho: default.rho * scale, scale, ..default }
    }
}

/// Guide images, where there are any.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Guides {
    /// View-space normals.
    pub normal: Option<ImageId>,
    /// Distance from the camera.
    pub depth: Option<ImageId>,
    /// Object numbers.
    pub object_id: Option<ImageId>,
}

impl Guides {
    pub(crate) fn each(&self) -> impl Iterator<Item = (Guide, ImageId)> {
        [(Guide::Normal, self.normal), (Guide::Depth, self.depth), (Guide::ObjectId, self.object_id)]
            .into_iter()
            .filter_map(|(kind, image)| image.map(|image| (kind, image)))
    }
}
