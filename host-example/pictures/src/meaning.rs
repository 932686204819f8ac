//! Meaning of the numbers of a picture. Each reader decides once what its file says; every writer is handed it.

use std::collections::BTreeSet;

use std::sync::{Arc, Mutex, PoisonError};

pub use isophote_exr_edit::Window;

use crate::primaries::{ADOBE, AP0, AP1, Chromaticities, P3, REC709, REC2020, same};
use crate::space::Space;
use crate::transfer::Transfer;
use isophote_files::output;

/// State of the numbers of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageState {
    /// Made for displays: PNG, JPEG, WebP and TIFF of integers, video.
    DisplayReferred,
    /// Light of a scene: EXR, HDR and TIFF of floats.
    SceneReferred,
}

/// Kind of a picture's alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alpha {
    /// There is none: everything is opaque.
    None,
    /// Colour is apart from alpha.
    Straight,
    /// Colour is multiplied by alpha.
    Premultiplied,
}

/// Coding of the colours of a video.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Matrix {
    /// Red, green and blue.
    Rgb,
    /// Luma and chroma of BT.601.
    Bt601,
    /// Luma and chroma of BT.709.
    Bt709,
    /// Luma and chroma of BT.2020, not of constant luminance.
    Bt2020,
    /// Luma and chroma of SMPTE 240M.
    Smpte240m,
}

/// Numbers that black and white have in a video.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// The least and the greatest.
    Full,
    /// 16 and 235 of 255.
    Limited,
}

/// Meaning of the numbers of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Meaning {
    /// State of the numbers.
    pub state: ImageState,
    /// Primaries and white.
    pub primaries: Chromaticities,
    /// Relation of numbers to light.
    pub transfer: Transfer,
    /// Coding of colours in the file; those of pictures in memory are red, green and blue.
    pub matrix: Matrix,
    /// Range of the numbers in the file; those of pictures in memory are full.
    pub range: Range,
    /// Kind of alpha.
    pub alpha: Alpha,
    /// Width of a pixel over its height.
    pub pixel_aspect: f32,
    /// The window that the pixels fill, where it is not all there is of a picture that begins at 0.
    pub data: Option<Window>,
    /// The window that is shown, of which the pixels may be a part or more.
    pub display: Option<Window>,
    /// The part of the file that says which colours are meant; nothing where it is silent and the usual is assumed.
    pub said_by: Option<&'static str>,
    /// The ICC profile of the file, where it is one of these numbers.
    pub profile: Option<Arc<[u8]>>,
    /// Sentences about what is not understood or not kept; they follow the name of the file.
    pub warnings: Vec<String>,
}

impl Meaning {
    /// Pictures for displays of which nothing is said: sRGB, alpha apart from colour.
    pub fn display() -> Self {
        Self {
            state: ImageState::DisplayReferred,
            primaries: REC709,
            transfer: Transfer::Srgb,
            matrix: Matrix::Rgb,
            range: Range::Full,
            alpha: Alpha::Straight,
            pixel_aspect: 1.0,
            data: None,
            display: None,
            said_by: None,
            profile: None,
            warnings: Vec::new(),
        }
    }

    /// Light of which nothing is said: Rec.709, colour multiplied by alpha.
    pub fn light() -> Self {
        Self {
            state: ImageState::SceneReferred,
            transfer: Transfer::Linear,
            alpha: Alpha::Premultiplied,
            ..Self::display()
        }
    }

    /// The usual meaning in this state.
    pub fn usual(state: ImageState) -> Self {
        match state {
            ImageState::DisplayReferred => Self::display(),
            ImageState::SceneReferred => Self::light(),
        }
    }

    /// The same numbers in a space that somebody names, whatever the file says.
    #[must_use]
    pub fn named(self, space: Option<Space>) -> Self {
        let Some(space) = space else { return self };
        let (primaries, transfer) = (space.primaries(), space.transfer());
        Self { primaries, transfer, said_by: Some("the command line"), profile: None, ..self }
    }

    /// Meaning of results in files of a state: the same in the same, the usual in another. Results are colours, to which a
    /// profile of grey says nothing.
    pub fn of_results(&self, state: ImageState) -> Self {
        let is_of_grey = self.profile.is_some() && self.profile_of(3).is_none();
        if state == self.state && !is_of_grey {
            return self.clone();
        }
        let alpha = match (self.alpha, state) {
            (Alpha::None, _) => Alpha::None,
            (_, ImageState::DisplayReferred) => Alpha::Straight,
            (_, ImageState::SceneReferred) => Alpha::Premultiplied,
        };
        let Self { pixel_aspect, data, display, .. } = *self;
        Self { alpha, pixel_aspect, data, display, ..Self::usual(state) }
    }

    /// The profile, where it is one of pictures with so many channels.
    pub fn profile_of(&self, channels: u32) -> Option<&[u8]> {
        self.profile.as_deref().filter(|profile| profile_is_of(profile, channels))
    }

    /// True where primaries and transfer are those that files of this state have when they say nothing.
    pub fn is_usual(&self) -> bool {
        self.transfer == Self::usual(self.state).transfer && self.has_primaries(REC709)
    }

    /// True where colour is multiplied by alpha, or would be if there were any.
    pub fn is_premultiplied(&self) -> bool {
        match self.alpha {
            Alpha::None => self.state == ImageState::SceneReferred,
            Alpha::Straight => false,
            Alpha::Premultiplied => true,
        }
    }

    /// True where the primaries are these but for rounding.
    pub fn has_primaries(&self, primaries: Chromaticities) -> bool {
        same(self.primaries, primaries)
    }

    /// Warns of what is not understood or not kept, once for all files that say the same.
    pub fn tell(&self, name: &str) {
        static TOLD: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
        for warning in &self.warnings {
            if TOLD.lock().unwrap_or_else(PoisonError::into_inner).insert(warning.clone()) {
                output::warn(format_args!("{name}: {warning}"));
            }
        }
    }

    /// Primaries and transfer in words.
    pub fn words(&self) -> String {
        let known = [
            (REC709, "Rec.709"),
            (P3, "P3 D65"),
            (REC2020, "Rec.2020"),
            (AP1, "ACES AP1"),
            (AP0, "ACES AP0"),
            (ADOBE, "Adobe RGB"),
        ];
        let primaries = match known.iter().find(|(known, _)| self.has_primaries(*known)) {
            Some((_, name)) => (*name).to_owned(),
            None => {
                let [rx, ry, gx, gy, bx, by, wx, wy] = self.primaries;
                format!("R {rx:.3} {ry:.3} G {gx:.3} {gy:.3} B {bx:.3} {by:.3} W {wx:.4} {wy:.4}")
            }
        };
        let transfer = match &self.transfer {
            Transfer::Linear => "linear".to_owned(),
            Transfer::Srgb => "sRGB curve".to_owned(),
            Transfer::Rec709 => "Rec.709 curve".to_owned(),
            Transfer::Gamma(gamma) => format!("gamma {gamma:.2}"),
            Transfer::Pq => "PQ".to_owned(),
            Transfer::Hlg => "HLG".to_owned(),
            Transfer::Curves(_) => "curves of a profile".to_owned(),
        };
        format!("{primaries}, {transfer}")
    }
}

/// Place in an ICC profile of the colour space of its pictures.
const PROFILE_SPACE: std::ops::Range<usize> = 16..20;

/// True for an ICC profile of pictures with so many channels: grey, or red, green and blue.
pub fn profile_is_of(profile: &[u8], channels: u32) -> bool {
    let wanted: &[u8] = if channels == 1 { b"GRAY" } else { b"RGB " };
    profile.get(PROFILE_SPACE) == Some(wanted)
}
