//! Steadiness of a filter over time, in numbers: shots whose motion is known, and what a filter makes of them.
//!
//! Three shots: [`rendered_shots::demo`] and [`rendered_shots::fox`] come from the sample host, with the renderer's motion;
//! [`Shot::noisy`] repeats a frame with fresh noise. Pictures are gamma-encoded sRGB in 0..=1, and all measures
//! are means over red, green and blue.
//!
//! **Carrying.** Let F_t be frame t, x the centre of a pixel and m_t(x) the motion there: from where the surface
//! is to where it was one frame ago, in pixels, x right and y down. The frame before, carried to frame t, is
//! C_t(x) = F_(t-1)(x + m_t(x)), sampled bilinearly.
//!
//! **Mask.** A pixel counts in frame t when it shows an object, when x + m_t(x) lies among the centres of pixels of
//! the frame before, and when every pixel there that has a part in the sample shows the same object at a depth
//! within a tenth of its own. It is found from the plain frames alone and is the same for all filters.
//!
//! **Warping error.** E(F) = mean of |F_t(x) - C_t(x)| over all counting pixels of all frames but the first.
//!
//! **Ratio.** E(stylized) / E(plain): above 1 a filter exaggerates what flickers, below 1 it calms it.
//!
//! **Energy.** G(F) = mean over all pixels of all frames, masked or not, of the gradient's length, by differences to
//! the next pixel to the right and below. G(stylized) / G(plain) says how strong a style draws, and G(stylized) /
//! G(still), `still` being the same style frame by frame, how much of that a temporal filter keeps: blur lowers the
//! warping error as well, but not without lowering this. The ratio over G(stylized) / G(plain) is the flicker a contrast.

mod carry;
mod look;
mod measure;
mod read;
pub mod rendered_shots;
mod shot;
mod style;

pub use carry::{Carried, carried};
pub use look::{FOLDER, show};
pub use measure::{Entry, Row, Steadiness, measure, table};
pub use shot::{Frame, Shot};
pub use style::Style;
