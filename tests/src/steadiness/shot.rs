//! Frames with what a renderer knows of them.

use crate::random::Random;
use isophote_engine::Image;

/// A frame, its images as the ports of the library want them.
#[derive(Clone, Debug)]
pub struct Frame {
    /// RGBA, gamma-encoded sRGB for display, opaque.
    pub color: Image,
    /// From where the surface is to where it was one frame ago: x right and y down, pixels.
    pub motion: Image,
    /// From where the surface is to where it will be one frame later, likewise.
    pub motion_forward: Image,
    /// Distance from the camera, scene units; 0 where there is nothing.
    pub depth: Image,
    /// A number per object; 0 where there is nothing.
    pub object_id: Image,
    /// View-space normal x, y, z, and 1 where there is a surface.
    pub normal: Image,
    /// Point x, y, z of the undeformed object, scene units, and 1 where there is one.
    pub rest: Image,
}

/// Consecutive frames of one size.
#[derive(Clone, Debug)]
pub struct Shot {
    /// For tables and names of files.
    pub name: String,
    /// The frames; the motion of the first leads nowhere, and that of the last forward to none of them.
    pub frames: Vec<Frame>,
    /// True where nothing moves, so that the motion is right where there is no object, too.
    pub is_static: bool,
}

impl Shot {
    /// A shot in which nothing moves but noise: `frame` repeated, each time with normal noise of its own whose
    /// standard deviation is `sigma`, in parts of the gamma-encoded range. Values may leave the range by it.
    pub fn noisy(frame: &Frame, count: usize, sigma: f64) -> Self {
        let mut random = Random::new(16);
        let mut one = || {
            let mut frame = frame.clone();
            frame.motion.data_mut().fill(0.0);
            frame.motion_forward.data_mut().fill(0.0);
            for pixel in frame.color.data_mut().chunks_exact_mut(4) {
                pixel[..3].iter_mut().for_each(|v| *v += (sigma * random.normal()) as f32);
            }
            frame
        };
        let frames = (0..count).map(|_| one()).collect();
        Self { name: "static with noise".into(), frames, is_static: true }
    }

    /// The plain frames.
    pub fn plain(&self) -> Vec<Image> {
        self.frames.iter().map(|frame| frame.color.clone()).collect()
    }
}
