//! Inks of a print: their light, and the plates that carry them.

use crate::declare::choice::choice;
use crate::declare::spec::Scope;
use crate::kernels::colour::halftone_screen::Plate;
use crate::kernels::colour::ink_separation::Plates;
use crate::kernels::colour::palette_colours::{labs, padded};
use crate::kernels::shared::colour::LUMINANCE;
use crate::stages::palette::{self, Ending, PALETTE};

choice! {
    /// Inks that a picture is printed with.
    pub(super) enum Inks {
        /// One ink.
        One ("one", "One ink"),
        /// Cyan, magenta, yellow and black.
        Process ("cmyk", "Four process inks"),
        /// The first two spot colours.
        TwoSpots ("two_spots", "Two spot colours"),
        /// Three spot colours.
        ThreeSpots ("three_spots", "Three spot colours"),
    }
}

/// Process inks on white paper, gamma-encoded.
const YELLOW: [f32; 4] = [1.0, 0.949, 0.0, 1.0];
const MAGENTA: [f32; 4] = [0.925, 0.0, 0.549, 1.0];
const CYAN: [f32; 4] = [0.0, 0.682, 0.937, 1.0];

/// Place of a plate in the press: the angle of its screen in degrees, where in a cell its rings begin, and the direction in
/// which it is misregistered, degrees counterclockwise from the right; none for the plate to which others are registered.
///
/// Rings of all plates share their centre. A quarter of a cell apart, two inks cover each other about as often as by
/// chance, which is what separation counts on.
#[derive(Clone, Copy, Debug)]
struct Place {
    angle: f32,
    phase: f32,
    moves: Option<f32>,
}

const AT_0: Place = Place { angle: 0.0, phase: 0.0, moves: Some(320.0) };
const AT_75: Place = Place { angle: 75.0, phase: 0.5, moves: Some(200.0) };
const AT_15: Place = Place { angle: 15.0, phase: 0.0, moves: Some(80.0) };
const AT_45: Place = Place { angle: 45.0, phase: 0.25, moves: None };

/// Inks, paper and plates of a print.
#[derive(Clone, Copy, Debug)]
pub(super) struct Press {
    /// Plates in the order of printing, of which `count` are there.
    plates: [Plate; 4],
    count: usize,
    /// Separation of a picture for them.
    pub separation: Plates,
    /// Linear RGB of the paper.
    pub paper: [f32; 3],
}

impl Press {
    /// The press that the parameters of `scope` say.
    pub(super) fn of(scope: &Scope<'_>) -> Self {
        let colours = Colours::of(scope);
        let paper = light(colours.paper);
        let chosen = |color| Ink::on(paper, light(color));
        let [first, second, third] = colours.spots.map(chosen);
        let black = chosen(colours.black);
        let process = |ink| Ink { color: times(light(ink), paper), ..Ink::on([1.0; 3], light(ink)) };
        let none = Ink::on(paper, paper);
        match colours.inks {
            Inks::One => {
                let lights = luminance(black.color) > luminance(paper);
                Self::new(scope, &[(black, AT_45)], paper, Plates::One { lights })
            }
            Inks::Process => {
                let inks = [YELLOW, MAGENTA, CYAN].map(process);
                let separation = Plates::Four {
                    inks: inks.map(|ink| ink.taken),
                    black: luminance(black.taken),
                    replaced: scope.float("grey_replacement"),
                };
                let [y, m, c] = inks;
                Self::new(scope, &[(y, AT_0), (m, AT_75), (c, AT_15), (black, AT_45)], paper, separation)
            }
            Inks::TwoSpots => {
                let separation = Plates::Three([second, first, none].map(|ink| ink.taken));
                Self::new(scope, &[(second, AT_75), (first, AT_45)], paper, separation)
            }
            Inks::ThreeSpots => {
                let plates = [(third, AT_15), (second, AT_75), (first, AT_45)];
                Self::new(scope, &plates, paper, Plates::Three([third, second, first].map(|ink| ink.taken)))
            }
        }
    }

    fn new(scope: &Scope<'_>, plates: &[(Ink, Place)], paper: [f32; 3], separation: Plates) -> Self {
        let [overprint, angle, far] = ["overprint", "angle", "misregistration"].map(|id| scope.float(id));
        let blank = Plate { angle: 0.0, moved: [0.0; 2], phase: 0.0, keep: [1.0; 3], add: [0.0; 3] };
        let mut all = [blank; 4];
        for (plate, (ink, place)) in all.iter_mut().zip(plates) {
            let (keep, add) = ink.printed(overprint);
            let moved = place.moves.map_or([0.0; 2], |direction| {
                let (sin, cos) = direction.to_radians().sin_cos();
                [far * cos, -far * sin]
            });
            *plate = Plate { angle: place.angle + angle, moved, phase: place.phase, keep, add };
        }
        Self { plates: all, count: plates.len().min(4), separation, paper }
    }

    /// The plates in the order of printing.
    pub(super) fn plates(&self) -> &[Plate] {
        &self.plates[..self.count]
    }
}

/// Colours of a print, gamma-encoded, and which of them it has.
#[derive(Clone, Copy, Debug)]
struct Colours {
    inks: Inks,
    paper: [f32; 4],
    /// That of the only ink, and of the black one.
    black: [f32; 4],
    spots: [[f32; 4]; 3],
}

impl Colours {
    /// Those that the parameters of `scope` say, or those of a palette.
    fn of(scope: &Scope<'_>) -> Self {
        let inks = scope.option("inks");
        if let Some(numbers) = scope.option::<Ending>(PALETTE.id).colours() {
            return Self::of_palette(palette::Colours::of_numbers(numbers).all(), inks);
        }
        let [paper, black] = ["paper_color", "ink_color"].map(|id| scope.color(id));
        Self { inks, paper, black, spots: ["spot_1", "spot_2", "spot_3"].map(|id| scope.color(id)) }
    }

    /// The lightest colour of a palette as paper, and the darkest and those that differ most from all before them as inks. Where
    /// there are no more, the rest of the inks look like the paper.
    fn of_palette(palette: &[[f32; 3]], inks: Inks) -> Self {
        let colours = padded(palette);
        let labs = labs(&colours);
        let by_lightness = |a: &usize, b: &usize| labs[*a][0].total_cmp(&labs[*b][0]);
        let paper = (0..palette.len()).max_by(by_lightness).unwrap_or_default();
        let darkest = (0..palette.len()).min_by(by_lightness).unwrap_or_default();
        // Distance from the nearest of those that are taken.
        let mut apart = labs.map(|lab| distance(lab, labs[paper]));
        let mut spots = [colours[paper]; 3];
        for (number, spot) in spots.iter_mut().enumerate() {
            let farthest =
                (0..palette.len()).max_by(|a, b| apart[*a].total_cmp(&apart[*b])).unwrap_or_default();
            let taken = if number == 0 { darkest } else { farthest };
            if apart[taken] > 0.0 {
                *spot = colours[taken];
            }
            for (apart, lab) in apart.iter_mut().zip(&labs) {
                *apart = apart.min(distance(*lab, labs[taken]));
            }
        }
        let inks = if inks == Inks::Process { Inks::ThreeSpots } else { inks };
        Self { inks, paper: colours[paper], black: spots[0], spots }
    }
}

/// Square of the distance between two colours.
fn distance(a: [f32; 4], b: [f32; 4]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// An ink, linear RGB.
#[derive(Clone, Copy, Debug)]
struct Ink {
    /// Factors on the light of what lies below it where it is transparent, 0..=1.
    keep: [f32; 3],
    /// Light that it adds there. Of channels that are lighter than the paper it covers what lies below, the more the lighter
    /// they are.
    add: [f32; 3],
    /// Light where it lies on the paper.
    color: [f32; 3],
    /// Light that it takes from the paper, shares of it.
    taken: [f32; 3],
}

impl Ink {
    /// The ink that looks like `color` on the paper.
    fn on(paper: [f32; 3], color: [f32; 3]) -> Self {
        let [mut keep, mut add, mut taken] = [[0.0; 3]; 3];
        for channel in 0..3 {
            let (paper, color) = (paper[channel], color[channel]);
            if color > paper {
                keep[channel] = paper / color;
                add[channel] = color - paper * keep[channel];
            } else {
                keep[channel] = color / paper.max(1e-6);
            }
            taken[channel] = (1.0 - color / paper.max(1e-6)).max(0.0);
        }
        Self { keep, add, color, taken }
    }

    /// Factors on what lies below and light that is added, from covering at an `overprint` of 0 to transparent at 1.
    fn printed(self, overprint: f32) -> ([f32; 3], [f32; 3]) {
        let (mut keep, mut add) = (self.keep, self.add);
        for channel in 0..3 {
            keep[channel] *= overprint;
            add[channel] = self.color[channel] + (add[channel] - self.color[channel]) * overprint;
        }
        (keep, add)
    }
}

/// A gamma-encoded colour of 0..=1 as linear RGB.
fn light([r, g, b, _]: [f32; 4]) -> [f32; 3] {
    [r, g, b].map(|v| if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) })
}

fn times(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

fn luminance(color: [f32; 3]) -> f32 {
    color.iter().zip(LUMINANCE).map(|(v, weight)| v * weight).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inks_look_on_paper_as_they_were_chosen_whatever_the_overprint() {
        let (paper, colors) = ([0.8, 0.5, 0.0], [[0.1, 0.5, 0.0], [0.9, 0.2, 0.3], [0.0; 3], [1.0; 3]]);
        for color in colors {
            for overprint in [0.0, 0.3, 1.0] {
                let (keep, add) = Ink::on(paper, color).printed(overprint);
                for channel in 0..3 {
                    let seen = paper[channel] * keep[channel] + add[channel];
                    assert!((seen - color[channel]).abs() < 1e-6, "{seen} for {color:?} at {overprint}");
                }
            }
        }
    }

    #[test]
    fn palettes_give_the_paper_and_the_inks_that_differ_most() {
        // Navy, coral, yellow, a darker yellow and cream.
        let palette = palette::Colours::of_numbers(&[0xf2c23c, 0x25356f, 0xd8ac34, 0xf6f1e3, 0xe9503f]);
        let palette = palette.all();
        let colour = |at: usize| [palette[at][0], palette[at][1], palette[at][2], 1.0];
        let colours = Colours::of_palette(palette, Inks::Process);
        assert_eq!((colours.inks, colours.paper, colours.black), (Inks::ThreeSpots, colour(3), colour(1)));
        assert_eq!(colours.spots[0], colour(1));
        assert!(colours.spots[1..] == [colour(4), colour(0)] || colours.spots[1..] == [colour(0), colour(4)]);
        let two = Colours::of_palette(&palette[1..4], Inks::One);
        assert_eq!((two.inks, two.spots), (Inks::One, [colour(1), colour(2), colour(3)]));
    }

    #[test]
    fn covering_inks_hide_what_lies_below_and_transparent_ones_multiply_it() {
        let ink = Ink::on([1.0; 3], [0.5, 0.2, 0.0]);
        assert_eq!(ink.printed(0.0), ([0.0; 3], [0.5, 0.2, 0.0]));
        assert_eq!(ink.printed(1.0), ([0.5, 0.2, 0.0], [0.0; 3]));
        assert_eq!(ink.taken, [0.5, 0.8, 1.0]);
        // What is hardly lighter than the paper hides hardly anything, and takes nothing.
        let ink = Ink::on([0.9; 3], [0.91, 0.9, 0.45]);
        assert!(ink.printed(1.0).0[0] > 0.98 && ink.taken == [0.0, 0.0, 0.5]);
    }
}
