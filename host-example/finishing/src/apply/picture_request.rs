//! Request to the library about a picture: what its numbers mean and where it stands.

use isophote_loader::abi::{
    ISOPHOTE_ALPHA_PREMULTIPLIED, ISOPHOTE_ALPHA_STRAIGHT, ISOPHOTE_SPACE_ACESCG, ISOPHOTE_SPACE_LINEAR,
    ISOPHOTE_SPACE_SRGB, IsophoteRequest,
};
use isophote_pictures::exr::Picture;
use isophote_pictures::space::Space;

/// Farthest from 0 that a picture may begin, pixels, as the contract has it.
const MOST_ORIGIN: f64 = 1_000_000.0;

/// The part of a request that is the picture's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureRequest {
    /// The space in which it is filtered.
    pub space: Space,
    /// True where colour is multiplied by alpha.
    pub is_premultiplied: bool,
    /// Position of the first pixel in the canonical picture.
    pub origin: [f64; 2],
    /// Height of the canonical picture; 0 for that of the picture.
    pub canonical_height: u32,
    /// Size of the picture over full size.
    pub scale: f32,
    /// The frame's number; 0 for a picture by itself.
    pub frame: i64,
}

impl PictureRequest {
    /// Of a picture in `space`, of the frame of this number.
    pub fn of(picture: &Picture, space: Space, number: Option<i64>) -> Self {
        // Windows farther out than marks can be told apart are windows of their own.
        let origin = picture.meaning.data.map_or([0; 2], |window| [window.x, window.y]);
        let [x, y] = origin;
        // Full-size pixels are square, and as high as the file's.
        let aspect = picture.own.map_or(1.0, |own| own.aspect);
        let is_near = (f64::from(x) * aspect).abs() <= MOST_ORIGIN && f64::from(y).abs() <= MOST_ORIGIN;
        Self {
            space,
            is_premultiplied: picture.meaning.is_premultiplied(),
            origin: if is_near { [f64::from(x) * aspect, f64::from(y)] } else { [0.0; 2] },
            canonical_height: picture.meaning.display.map_or(0, |window| window.height as u32),
            scale: picture.own.map_or(1.0, |own| own.scale),
            frame: number.unwrap_or_default(),
        }
    }

    /// The request with it.
    pub fn request(&self, usual: IsophoteRequest) -> IsophoteRequest {
        let [origin_x, origin_y] = self.origin;
        IsophoteRequest {
            space: match self.space {
                Space::Srgb => ISOPHOTE_SPACE_SRGB,
                Space::Acescg => ISOPHOTE_SPACE_ACESCG,
                _ => ISOPHOTE_SPACE_LINEAR,
            },
            alpha: if self.is_premultiplied { ISOPHOTE_ALPHA_PREMULTIPLIED } else { ISOPHOTE_ALPHA_STRAIGHT },
            origin_x,
            origin_y,
            canonical_height: self.canonical_height,
            scale: usual.scale * self.scale,
            frame: self.frame,
            ..usual
        }
    }
}
