//! The test pattern of Figure 2.7 and angular errors on it.

use crate::pictures::from_fn;
use crate::random::Random;
use isophote::kernels::shared::tensor::scalar;
use isophote_engine::Image;

/// Radius of a plate, where its frequency is 0.9 of Nyquist's, or 0 for the inverted one.
const RADIUS: f64 = 120.0;
const SIDE: u32 = 512;

/// Distance from the centre up to which a plate is looked at, pixels.
pub const OUTER: f64 = RADIUS - 6.0;

/// A zone plate, whose rings grow finer outwards, and an inverted one, side by side; Gaussian noise of
/// this variance on top.
pub fn picture(variance: f64) -> Image {
    let mut random = Random::new(27);
    from_fn(SIDE, SIDE / 2, |x, y| {
        let [dx, dy] = from_centre(x, y);
        let r = dx.hypot(dy);
        let top = 0.9 * std::f64::consts::PI;
        let phase = if x < SIDE as i32 / 2 {
            top * r * r / (2.0 * RADIUS)
        } else {
            top * (r - r * r / (2.0 * RADIUS))
        };
        let noise = if variance > 0.0 { variance.sqrt() * random.normal() } else { 0.0 };
        let value = (0.5 + 0.5 * phase.cos() + noise) as f32;
        [value, value, value, 1.0]
    })
}

/// Position of a pixel relative to the centre of its plate.
fn from_centre(x: i32, y: i32) -> [f64; 2] {
    let half = f64::from(SIDE) / 4.0;
    let left = if x >= SIDE as i32 / 2 { 2.0 * half } else { 0.0 };
    [f64::from(x) + 0.5 - left - half, f64::from(y) + 0.5 - half]
}

/// Angular errors in degrees of the tensors of all pixels well inside the plates, with the angle of the
/// gradient in degrees, 0..90.
pub fn errors(tensor: &Image) -> Vec<(f64, f64)> {
    errors_between(tensor, 12.0, OUTER)
}

/// The same between two distances from the plates' centres, pixels.
pub fn errors_between(tensor: &Image, inner: f64, outer: f64) -> Vec<(f64, f64)> {
    let mut errors = Vec::new();
    for y in 0..SIDE as i32 / 2 {
        for x in 0..SIDE as i32 {
            let [dx, dy] = from_centre(x, y);
            let r = dx.hypot(dy);
            if !(inner..outer).contains(&r) {
                continue;
            }
            let t = tensor.pixel(x, y);
            let (.., [vx, vy]) = scalar::eigen(t[0], t[1], t[2]);
            let cross = (f64::from(vx) * dy - f64::from(vy) * dx).abs() / r;
            errors.push((cross.min(1.0).asin().to_degrees(), (dy / dx).abs().atan().to_degrees()));
        }
    }
    errors
}

/// Mean of the errors.
pub fn mean(errors: &[(f64, f64)]) -> f64 {
    errors.iter().map(|(e, _)| e).sum::<f64>() / errors.len().max(1) as f64
}
