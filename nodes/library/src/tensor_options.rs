//! How a structure tensor is made, and the guide images that count in it.

use crate::kernels::structure::gradient_tensor::Derivative;
use crate::kernels::structure::guide_tensor::Guide;
use isophote_engine::ImageId;

/// What the gradient is taken of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// Gamma-encoded RGB.
    Rgb,
    /// The Rec. 709 luma of gamma-encoded RGB.
    Luminance,
    /// CIELAB divided by 100.
    Lab,
}

/// How a tensor is made; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TensorOptions {
    /// Derivative operator.
    pub derivative: Derivative,
    /// Standard deviation of the smoothing.
    pub rho: f32,
    /// What the gradient is taken of.
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
    /// Size of the picture over its full size, as far as the smoothing is to make good for it.
    pub scale: f32,
}

impl Default for TensorOptions {
    fn default() -> Self {
        Self {
            derivative: Derivative::Scharr3,
            rho: 2.0,
            space: Space::Rgb,
            normalize: false,
            relax_threshold: 0.0,
            relax_steps: 1,
            levels: 1,
            oversample: None,
            guide_weight: 1.0,
            scale: 1.0,
        }
    }
}

impl TensorOptions {
    /// Standard deviation of the smoothing that gives a proxy the tensors of the full picture. A pixel of
    /// a proxy is a mean over several, and its operator reaches over several, so that gradients come
    /// smoothed by that much more. Smoothed squares are as wide as squares of something smoother: of a
    /// Gaussian edge, and of one that falls off exponentially, half of its variance is theirs.
    pub(crate) fn smoothing(&self) -> f32 {
        if self.scale >= 1.0 {
            return self.rho;
        }
        let wider = 1.0 - self.scale * self.scale;
        let operator = if self.oversample.is_some() { 0.0 } else { self.derivative.variance() };
        (self.rho * self.rho - 0.5 * wider * (operator + 1.0 / 12.0)).max(0.0).sqrt()
    }

    /// The defaults for a picture rendered at `scale` of its full size.
    pub fn at_scale(scale: f32) -> Self {
        let default = Self::default();
        Self { rho: default.rho * scale, ..default }
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
