//! Colours of hosts: the spaces that they may be in, and the change of those in which the library does not compute to one in
//! which it does, before a plan reads them, and of results back before they are written.

use isophote::ColourSpace;
use isophote::engine::Image;
use isophote::engine::cpu::Threads;
use isophote_colour::{Conversion, Space};
use std::ffi::CStr;
use std::sync::{Mutex, PoisonError};

/// Label of the option for pixels that are in none of the spaces.
pub const AS_IS: &str = "As is";

/// The spaces that pixels may be in, in the order of the options, which saved projects number; new ones come last. Nothing
/// stands for "As is", which computes as sRGB does, without a claim that the pixels are.
pub const SPACES: [Option<Space>; 13] = [
    Some(Space::Linear),
    Some(Space::Srgb),
    None,
    Some(Space::Acescg),
    Some(Space::P3),
    Some(Space::Rec2020),
    Some(Space::Aces),
    Some(Space::DisplayP3),
    Some(Space::EncodedRec709),
    Some(Space::EncodedRec2020),
    Some(Space::AdobeRgb),
    Some(Space::Pq),
    Some(Space::Hlg),
];

/// The space that hosts are asked for where the user says that pixels are in `space`.
pub fn preferred(space: Space) -> &'static CStr {
    match space {
        space if space.is_linear() => c"ofx_scene_linear",
        space if space.is_hdr() => c"ofx_display_hdr",
        _ => c"ofx_display_sdr",
    }
}

/// The space of a host's name, where the user says that pixels are in `said`. Generic names stand for that one where it is
/// such a space.
pub fn of_host(name: &CStr, said: Space) -> Space {
    match name.to_bytes() {
        b"ofx_scene_linear" if !said.is_linear() => Space::Linear,
        b"ofx_display_sdr" if said.is_linear() || said.is_hdr() => Space::Srgb,
        b"srgb_tx" | b"srgb_display" => Space::Srgb,
        b"displayp3_display" | b"srgb_encoded_p3d65_tx" => Space::DisplayP3,
        b"camera_rec709" => Space::EncodedRec709,
        b"rec2100_pq_display" => Space::Pq,
        b"rec2100_hlg_display" => Space::Hlg,
        b"lin_rec709_srgb" => Space::Linear,
        b"lin_p3d65" => Space::P3,
        b"lin_rec2020" => Space::Rec2020,
        b"ACEScg" => Space::Acescg,
        b"ACES2065-1" => Space::Aces,
        _ => said,
    }
}

/// The space in which the library computes pictures of a space.
pub fn working(space: Space) -> ColourSpace {
    match space.working() {
        Space::Srgb => ColourSpace::Srgb,
        Space::Acescg => ColourSpace::AcesCg,
        _ => ColourSpace::Linear,
    }
}

/// Changes between the pixels of a host and those of a plan.
#[derive(Debug)]
pub struct Colours {
    entering: Option<Conversion>,
    leaving: Option<Conversion>,
}

impl Colours {
    /// For pixels of a space, multiplied by alpha or not.
    pub fn of(space: Space, is_premultiplied: bool) -> Self {
        let working = space.working();
        Self {
            entering: Conversion::of_spaces(space, working, is_premultiplied),
            leaving: Conversion::of_spaces(working, space, is_premultiplied),
        }
    }

    /// True where [`Colours::enter`] changes nothing.
    pub fn enter_as_they_are(&self) -> bool {
        self.entering.is_none()
    }

    /// Makes the host's colours those of the plan.
    pub fn enter(&self, colour: &mut Image, threads: &dyn Threads) {
        change(self.entering.as_ref(), colour, threads);
    }

    /// Makes colours of the plan those of the host. Lines of one channel are no colours.
    pub fn leave(&self, result: &mut Image, threads: &dyn Threads) {
        if result.channels() == 4 {
            change(self.leaving.as_ref(), result, threads);
        }
    }
}

fn change(conversion: Option<&Conversion>, image: &mut Image, threads: &dyn Threads) {
    /// Pixels that one job changes.
    const PIXELS: usize = 1 << 14;
    let Some(conversion) = conversion else { return };
    let channels = image.channels() as usize;
    let parts: Vec<Mutex<&mut [f32]>> =
        image.data_mut().chunks_mut(PIXELS * channels).map(Mutex::new).collect();
    threads.run(parts.len(), &|index| {
        let mut part = parts[index].lock().unwrap_or_else(PoisonError::into_inner);
        for pixel in part.chunks_exact_mut(channels) {
            conversion.apply(pixel);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_space_is_an_option_once_and_the_first_stay_where_they_were() {
        assert_eq!(SPACES[..4], [Some(Space::Linear), Some(Space::Srgb), None, Some(Space::Acescg)]);
        for space in Space::ALL {
            assert_eq!(SPACES.iter().filter(|listed| **listed == Some(space)).count(), 1, "{space:?}");
        }
        assert_eq!(SPACES.len(), Space::ALL.len() + 1);
    }

    #[test]
    fn generic_names_leave_the_space_that_is_said() {
        for space in Space::ALL {
            assert_eq!(of_host(preferred(space), space), space);
            assert_eq!(of_host(c"arri_logc4", space), space);
            assert_eq!(of_host(c"lin_p3d65", space), Space::P3);
        }
        assert_eq!(of_host(c"ofx_scene_linear", Space::DisplayP3), Space::Linear);
        assert_eq!(of_host(c"ofx_display_sdr", Space::Rec2020), Space::Srgb);
    }
}
