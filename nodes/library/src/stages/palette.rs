//! Palettes that ship, and pictures that end in the colours of one.

use crate::declare::choice::choice;
use crate::declare::spec::{Param, Scope};
use crate::kernels::colour::palette_colours::{self, MOST, Options};
use crate::kernels::colour::rgb_to_lab;
use crate::stages::LOOK;
use crate::stages::lines::{SHOW, Show};
use isophote_engine::ImageId;

/// Declares the choices of the palettes that ship: that of the node, which may have colours of one's own, and that of styles, which may
/// have none.
macro_rules! palettes {
    ($($(#[doc = $doc:literal])+ $option:ident ($id:literal, $label:literal) of $colours:ident,)+) => {
        choice! {
            /// Palettes of the node.
            pub(crate) enum Palette {
                $($(#[doc = $doc])+ $option ($id, $label),)+
                /// Colours 1 to 16, as many of them as you say.
                Own ("own", "Your own"),
            }
        }

        choice! {
            /// Palettes that a style may end in.
            pub(crate) enum Ending {
                /// All colours.
                None ("none", "All colours"),
                $($(#[doc = $doc])+ $option ($id, $label),)+
            }
        }

        impl Palette {
            /// Its colours; none for one's own.
            pub(crate) fn colours(self) -> Option<&'static [u32]> {
                match self {
                    $(Self::$option => Some(&$colours),)+
                    Self::Own => None,
                }
            }
        }

        impl Ending {
            /// Its colours, if there are to be no others.
            pub(crate) fn colours(self) -> Option<&'static [u32]> {
                match self {
                    Self::None => None,
                    $(Self::$option => Some(&$colours),)+
                }
            }
        }
    };
}

palettes! {
    /// Sixteen colours of a comic page, with skins and skies.
    Comic ("comic", "Comic sixteen") of COMIC,
    /// Twenty-four colours of body paint, for pictures of all kinds.
    Gouache ("gouache", "Gouache 24") of GOUACHE,
    /// Four greens of an old handheld console.
    Handheld ("handheld", "Handheld greens") of HANDHELD,
    /// Sixteen muted colours of an old home computer.
    HomeComputer ("home_computer", "Home computer 16") of HOME_COMPUTER,
    /// Black, white, cyan and magenta of an early colour screen.
    FourColours ("four_colours", "Early screen four") of FOUR_COLOURS,
    /// The sixty-four colours of an early graphics card: four levels of red, green and blue.
    GraphicsCard ("graphics_card", "Graphics card 64") of GRAPHICS_CARD,
    /// Eight plain colours of a text terminal.
    Terminal ("terminal", "Terminal eight") of TERMINAL,
    /// The blue of a blueprint and the white of its lines.
    Blueprint ("blueprint", "Blueprint two") of BLUEPRINT,
    /// Black ink and warm paper.
    InkAndPaper ("ink_and_paper", "Ink and paper") of INK_AND_PAPER,
    /// Five browns of an old photograph.
    Sepia ("sepia", "Sepia five") of SEPIA,
    /// Six greys of a silver print.
    Silver ("silver", "Silver six") of SILVER,
    /// Twelve pale colours.
    Pastel ("pastel", "Pastel twelve") of PASTEL,
    /// Eight colours from a violet dusk to a yellow sky.
    Sunset ("sunset", "Sunset eight") of SUNSET,
    /// Eight greens and browns of a wood.
    Forest ("forest", "Forest eight") of FOREST,
    /// Ten colours of a city at night, with neon lights.
    NightCity ("night_city", "Night city ten") of NIGHT_CITY,
    /// Three inks and the paper of a riso print.
    Riso ("riso", "Riso four") of RISO,
}

/// Colours as `0xRRGGBB`, gamma-encoded. The first ones of `COMIC` are those that a palette of one's own begins with.
pub(crate) const COMIC: [u32; 16] = [
    0x17141d, 0xfbf7ec, 0xc9302c, 0xf4c542, 0x2d5fa8, 0x3f8a4d, 0xeab38a, 0x7a4a33, 0xf07f3c, 0x8cc8e8,
    0x1f2a5a, 0xc4c6c8, 0xc07c58, 0x7b4a8f, 0x8d939b, 0xf7dcc0,
];
const GOUACHE: [u32; 24] = [
    0x15151c, 0x33323c, 0x5b5c66, 0x8c8f96, 0xbfc2c2, 0xf6f3e8, 0x3a2018, 0x6e3d2a, 0xa8684a, 0xd69a75,
    0xf2cba8, 0x7d1f24, 0xc43d33, 0xe8793f, 0xf2b84b, 0xf7e39a, 0x233a23, 0x47692f, 0x8da54c, 0x1d2850,
    0x2f5a94, 0x6aa2c8, 0xb3d6e6, 0x6a4478,
];
const HANDHELD: [u32; 4] = [0x0f2a1d, 0x306848, 0x86b45a, 0xe2eeb4];
const HOME_COMPUTER: [u32; 16] = [
    0x000000, 0xffffff, 0x68372b, 0x70a4b2, 0x6f3d86, 0x588d43, 0x352879, 0xb8c76f, 0x6f4f25, 0x433900,
    0x9a6759, 0x444444, 0x6c6c6c, 0x9ad284, 0x6c5eb5, 0x959595,
];
const FOUR_COLOURS: [u32; 4] = [0x000000, 0x55ffff, 0xff55ff, 0xffffff];
const TERMINAL: [u32; 8] = [0x0c0d10, 0xc8382e, 0x35a84c, 0xd8b430, 0x2f62cc, 0xae48b4, 0x36b2ba, 0xe6e6e0];
const BLUEPRINT: [u32; 2] = [0x12407b, 0xeaf2fa];
const INK_AND_PAPER: [u32; 2] = [0x17151a, 0xf5f1e6];
const SEPIA: [u32; 5] = [0x2a1a12, 0x5f4029, 0x97714a, 0xc9a878, 0xf1e3c4];
const SILVER: [u32; 6] = [0x111113, 0x39393c, 0x646467, 0x929294, 0xc2c2c2, 0xf4f4f1];
const PASTEL: [u32; 12] = [
    0x5a5470, 0x8a7fa8, 0xb9a8d4, 0xe8c3dc, 0xf6b8b0, 0xfbd5b5, 0xfdf0c4, 0xcfe6b8, 0x9fd0bd, 0xa6d4ec,
    0x7fa3cf, 0xfdfaf5,
];
const SUNSET: [u32; 8] = [0x1c1533, 0x432058, 0x7f2b66, 0xbb3f5f, 0xe3654d, 0xf4944c, 0xf9c463, 0xfdeeb8];
const FOREST: [u32; 8] = [0x121f1a, 0x26412d, 0x46683a, 0x7b9150, 0xb8bd78, 0xeee7c0, 0x573b29, 0x9c6f48];
const NIGHT_CITY: [u32; 10] =
    [0x090b1c, 0x171c44, 0x2c3277, 0x56389a, 0xa03fb0, 0xe8558f, 0xff9d6c, 0xffe2a8, 0x2f8fc0, 0x7fe3e6];
const RISO: [u32; 4] = [0x25356f, 0xe9503f, 0xf2c23c, 0xf6f1e3];

/// Colours of the graphics card: two bits for each of red, green and blue.
const GRAPHICS_CARD: [u32; MOST] = {
    let mut colours = [0; MOST];
    let mut at = 0;
    while at < MOST {
        let bits = at as u32;
        colours[at] = (((bits >> 4) * 0x55) << 16) | (((bits >> 2 & 3) * 0x55) << 8) | ((bits & 3) * 0x55);
        at += 1;
    }
    colours
};

/// A colour as three numbers of 0..=1: those that a picture of eight bits has.
pub(crate) const fn rgb(colour: u32) -> [f32; 3] {
    [(colour >> 16 & 255) as f32 / 255.0, (colour >> 8 & 255) as f32 / 255.0, (colour & 255) as f32 / 255.0]
}

/// Share of the way that tones go to those of a palette, where nothing says another.
pub(crate) const FIT: f32 = 0.5;

/// The palette that a style ends in.
pub(crate) const PALETTE: Param = Param::choice("palette", "Palette", Ending::None.selected())
    .group(LOOK)
    .hint("Draws the result in the colours of a palette and no others; the node Palette takes your own.")
    .doc(
        "Each pixel has the colour that is nearest in CIELAB, its tones brought half the way to those of the palette, as the node `palette` \
         does without dither. Lines that are shown alone keep their colour.",
    );

/// Colours of a palette, gamma-encoded RGB; without memory of their own, which no moving slider takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Colours {
    colours: [[f32; 3]; MOST],
    count: usize,
}

impl Colours {
    /// The first [`MOST`] of some.
    pub(crate) fn new(some: impl Iterator<Item = [f32; 3]>) -> Self {
        let (mut colours, mut count) = ([[0.0; 3]; MOST], 0);
        for (place, colour) in colours.iter_mut().zip(some) {
            *place = colour;
            count += 1;
        }
        Self { colours, count }
    }

    /// Those of a palette that ships.
    pub(crate) fn of_numbers(numbers: &[u32]) -> Self {
        Self::new(numbers.iter().map(|colour| rgb(*colour)))
    }

    /// All of them.
    pub(crate) fn all(&self) -> &[[f32; 3]] {
        &self.colours[..self.count]
    }
}

/// A result in the colours of the palette that `palette` says: no pass where it says none.
pub(crate) fn ended(scope: &mut Scope<'_>, drawn: ImageId) -> ImageId {
    let Some(colours) = scope.option::<Ending>(PALETTE.id).colours() else { return drawn };
    if scope.option::<Show>(SHOW.id) == Show::Lines {
        return drawn;
    }
    let lab = rgb_to_lab::pass(scope.plan, drawn, 1.0);
    palette_colours::pass(scope.plan, lab, &Options::nearest(Colours::of_numbers(colours).all(), FIT))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::declare::choice::Numbered;
    use std::collections::BTreeSet;

    #[test]
    fn palettes_have_colours_that_differ_and_one_is_ones_own() {
        let shipped: Vec<_> = Palette::ALL.iter().filter_map(|palette| palette.colours()).collect();
        assert_eq!(shipped.len(), Palette::ALL.len() - 1);
        for colours in shipped {
            let different: BTreeSet<_> = colours.iter().collect();
            assert!(different.len() == colours.len() && (2..=MOST).contains(&colours.len()), "{colours:x?}");
        }
        assert_eq!(rgb(0xff_80_00), [1.0, 128.0 / 255.0, 0.0]);
    }
}
