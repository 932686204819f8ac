//! Rules of a preset for things in pictures, as a control map and as colours of lines.
//!
//! A rule counts as much as its things cover of a pixel, and over those before it. What an artist painted is refined by it: factors
//! of both multiply, and where there are to be no lines there are none; painted colours of lines lie over those of rules.

use crate::stylize::preset::ObjectRule;
use crate::stylize::things;
use isophote_pictures::convert::Conversion;
use isophote_pictures::meaning::{Alpha, Meaning};
use isophote_pictures::pixels::{Pixels, Samples};

/// What a control map has where nothing is wanted.
const NEUTRAL: f32 = 0.5;
/// Channel of the amount of lines, of which 0 is none.
const AMOUNT: usize = 2;
/// Distance in pixels, of a picture 1080 lines high, over which lines beside a thing follow its rules and not those of what is
/// farther away.
const REACH: f32 = 5.0;
/// Least of it in pixels: no line is narrower than a pixel on a small picture.
const LEAST_REACH: f32 = 2.0;
/// Part of a distance from which on something is farther away.
const BEHIND: f32 = 0.01;

/// What a control map has where things are: detail, width of lines, their amount and strength of the medium.
pub type Control = [Option<f32>; 4];

/// A rule for things.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// What a control map has where they are.
    pub control: Control,
    /// Colour of their lines, gamma-encoded RGBA.
    pub line_color: Option<[f32; 4]>,
}

impl From<&ObjectRule> for Rule {
    fn from(rule: &ObjectRule) -> Self {
        Self { control: rule.control, line_color: things::line_color(rule) }
    }
}

impl Rule {
    /// True where a control map says nothing of it.
    pub fn is_neutral(&self) -> bool {
        self.control.iter().all(Option::is_none)
    }
}

/// Rules over a picture of `size`, with what their things cover of it.
#[derive(Clone, Copy, Debug)]
pub struct Ruled<'a> {
    /// The rules.
    pub rules: &'a [Rule],
    /// By rule, from 0 to 1 by pixel; nothing where its things are not known.
    pub coverage: &'a [Option<&'a [f32]>],
    /// Columns and rows of the picture.
    pub size: (u32, u32),
    /// Distance of its pixels, if that is known.
    pub depth: Option<&'a [f32]>,
}

impl Ruled<'_> {
    /// The control map that they are, over what was `painted`; nothing where they ask for none.
    pub fn control(&self, painted: Option<&[f32]>) -> Option<Pixels> {
        if self.rules.iter().all(Rule::is_neutral) {
            return None;
        }
        let mut map = self.map(NEUTRAL, |rule| rule.control);
        refine(&mut map, painted);
        Pixels::new(self.size.0, self.size.1, 4, Samples::F32(map))
    }

    /// The colours of lines that they ask for, of a picture of this `meaning`, under those that were `painted`; nothing where they
    /// ask for none.
    pub fn line_paint(&self, meaning: &Meaning, painted: Option<&[f32]>) -> Option<Pixels> {
        if self.rules.iter().all(|rule| rule.line_color.is_none()) {
            return None;
        }
        let mut map = self.map(0.0, |rule| {
            rule.line_color
                .and_then(|color| multiplied(color, meaning))
                .map_or([None; 4], |color| color.map(Some))
        });
        let is_premultiplied = meaning.is_premultiplied();
        if let Some(painted) = painted {
            let pixels = map.as_chunks_mut::<4>().0.iter_mut().zip(painted.as_chunks::<4>().0);
            // What is no number was not painted.
            for (value, over) in pixels.filter(|(_, over)| over.iter().all(|v| v.is_finite())) {
                let share = over[3].clamp(0.0, 1.0);
                let factor = if is_premultiplied { 1.0 } else { share };
                let over = [factor * over[0], factor * over[1], factor * over[2], share];
                for (value, over) in value.iter_mut().zip(over) {
                    *value = *value * (1.0 - share) + over;
                }
            }
        }
        if !is_premultiplied {
            for [r, g, b, a] in map.as_chunks_mut::<4>().0.iter_mut().filter(|pixel| pixel[3] > 0.0) {
                (*r, *g, *b) = (*r / *a, *g / *a, *b / *a);
            }
        }
        Pixels::new(self.size.0, self.size.1, 4, Samples::F32(map))
    }

    /// The map of what rules say, which has `start` where they say nothing.
    fn map(&self, start: f32, says: impl Fn(&Rule) -> [Option<f32>; 4]) -> Vec<f32> {
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let mut map = vec![start; width * height * 4];
        for (rule, coverage) in self.rules.iter().zip(self.coverage) {
            let said = says(rule);
            for (pixel, covered) in map.chunks_exact_mut(4).zip(coverage.iter().copied().flatten()) {
                for (value, wanted) in pixel.iter_mut().zip(said) {
                    *value += (wanted.unwrap_or(*value) - *value) * covered;
                }
            }
        }
        match self.depth {
            Some(depth) => of_nearest(&map, width, depth),
            None => map,
        }
    }
}

/// A colour of a rule in the numbers of a picture, multiplied by its alpha.
fn multiplied(color: [f32; 4], meaning: &Meaning) -> Option<[f32; 4]> {
    let own = Pixels::new(1, 1, 4, Samples::F32(color.to_vec()))?;
    let straight = Meaning { alpha: Alpha::Straight, ..meaning.clone() };
    let change = Conversion::between(&Meaning::display(), &straight);
    let pixels = change.map_or_else(|| own.clone(), |change| change.apply(&own).0).to_f32();
    let [r, g, b, a] = *pixels.first_chunk::<4>()?;
    Some([r * a, g * a, b * a, a])
}

/// A control map with what was painted over it.
fn refine(map: &mut [f32], painted: Option<&[f32]>) {
    for (index, (value, painted)) in map.iter_mut().zip(painted.into_iter().flatten()).enumerate() {
        // What is no number was not painted.
        let painted = if painted.is_finite() { painted.clamp(0.0, 1.0) } else { NEUTRAL };
        if !(index % 4 == AMOUNT && *value == 0.0) {
            *value = (*value + painted - NEUTRAL).clamp(0.0, 1.0);
        }
    }
}

/// The map with the values of the nearest thing within reach: a line between two things lies on both.
fn of_nearest(map: &[f32], width: usize, depth: &[f32]) -> Vec<f32> {
    let height = depth.len() / width.max(1);
    let reach = (REACH * height as f32 / 1080.0).round().max(LEAST_REACH) as usize;
    let known = |depth: &f32| if depth.is_finite() && *depth > 0.0 { *depth } else { f32::INFINITY };
    let own: Vec<(f32, usize)> = depth.iter().map(known).zip(0..).collect();
    // Rows, then columns: the nearest of the nearest.
    let mut rows = own.clone();
    for (to, from) in rows.chunks_exact_mut(width).zip(own.chunks_exact(width)) {
        for by in 1..=reach.min(width - 1) {
            nearer(&mut to[by..], &from[..width - by]);
            nearer(&mut to[..width - by], &from[by..]);
        }
    }
    let mut both = rows.clone();
    for by in 1..=reach.min(height - 1) {
        let (whole, part) = (by * width, (height - by) * width);
        nearer(&mut both[whole..], &rows[..part]);
        nearer(&mut both[..part], &rows[whole..]);
    }
    let mut result = map.to_vec();
    for (pixel, (near, own)) in result.chunks_exact_mut(4).zip(both.iter().zip(&own)) {
        if near.0 < own.0 * (1.0 - BEHIND) {
            pixel.copy_from_slice(&map[near.1 * 4..][..4]);
        }
    }
    result
}

/// Depths with their places, each the nearer of two.
fn nearer(to: &mut [(f32, usize)], from: &[(f32, usize)]) {
    for (to, from) in to.iter_mut().zip(from) {
        if from.0 < to.0 {
            *to = *from;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What maps of rules over a row of pixels have, by `of` of them.
    fn row(
        rules: &[(&[f32], Rule)],
        depth: Option<&[f32]>,
        of: impl Fn(Ruled<'_>) -> Option<Pixels>,
    ) -> Vec<f32> {
        let coverage: Vec<Option<&[f32]>> = rules.iter().map(|(coverage, _)| Some(*coverage)).collect();
        let own: Vec<Rule> = rules.iter().map(|(_, rule)| *rule).collect();
        let size = (rules[0].0.len() as u32, 1);
        let ruled = Ruled { rules: &own, coverage: &coverage, size, depth };
        of(ruled).expect("they ask for a map").to_f32()
    }

    fn rule(control: Control) -> Rule {
        Rule { control, line_color: None }
    }

    #[test]
    fn the_last_rule_counts_as_much_as_it_covers() {
        let wide = rule([None, Some(1.0), None, None]);
        let fine = rule([None, Some(0.0), Some(0.0), None]);
        let map = row(&[(&[1.0, 1.0, 0.0], wide), (&[0.0, 0.5, 0.0], fine)], None, |r| r.control(None));
        assert_eq!(map, [0.5, 1.0, 0.5, 0.5, 0.5, 0.5, 0.25, 0.5, 0.5, 0.5, 0.5, 0.5]);
    }

    #[test]
    fn what_is_painted_refines_rules_and_brings_no_lines_back() {
        let none = rule([Some(0.75), None, Some(0.0), None]);
        let painted = [0.75, 0.25, 1.0, f32::NAN];
        let map = row(&[(&[1.0], none)], None, |r| r.control(Some(&painted)));
        assert_eq!(map, [1.0, 0.25, 0.0, 0.5]);
    }

    #[test]
    fn lines_have_the_colours_of_rules_under_painted_ones() {
        let red = Rule { control: [None; 4], line_color: Some([1.0, 0.0, 0.0, 1.0]) };
        let covered: [f32; 4] = [0.0, 0.5, 1.0, 1.0];
        let painted =
            [0.0, 0.0, 0.0, 0.0].repeat(3).into_iter().chain([0.0, 0.0, 1.0, 0.25]).collect::<Vec<_>>();
        let of = |meaning: &Meaning| row(&[(&covered, red)], None, |r| r.line_paint(meaning, Some(&painted)));
        let straight = [[0.0; 4], [1.0, 0.0, 0.0, 0.5], [1.0, 0.0, 0.0, 1.0], [0.75, 0.0, 0.25, 1.0]];
        assert_eq!(of(&Meaning::display()), straight.concat());
        // Multiplied by alpha, a painted blue of a quarter is four times as bright.
        let light = of(&Meaning::light());
        let wanted = [[0.0; 4], [0.5, 0.0, 0.0, 0.5], [1.0, 0.0, 0.0, 1.0], [0.75, 0.0, 1.0, 1.0]].concat();
        assert!(light.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-6), "{light:?}");
    }

    #[test]
    fn a_line_between_two_things_follows_the_nearer_one() {
        let none = rule([None, None, Some(0.0), None]);
        let coverage = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        let amounts = |depth: &[f32]| -> Vec<f32> {
            let map = row(&[(&coverage, none)], Some(depth), |r| r.control(None));
            map.chunks_exact(4).map(|pixel| pixel[2]).collect()
        };
        assert_eq!(amounts(&[1.0, 1.0, 1.0, 5.0, 5.0, 5.0]), [0.0, 0.0, 0.0, 0.0, 0.0, 0.5]);
        assert_eq!(amounts(&[5.0, 5.0, 5.0, 1.0, 1.0, 1.0]), [0.0, 0.5, 0.5, 0.5, 0.5, 0.5]);
        // A surface that leads away is one thing, and what has no depth is behind all.
        assert_eq!(amounts(&[1.0, 1.001, 1.002, 1.003, 1.004, 1.005]), [0.0, 0.0, 0.0, 0.5, 0.5, 0.5]);
        assert_eq!(amounts(&[0.0, 0.0, f32::NAN, 3.0, 3.0, 3.0]), [0.0, 0.5, 0.5, 0.5, 0.5, 0.5]);
    }
}
