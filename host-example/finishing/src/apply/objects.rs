//! Rules of a preset for things in pictures, as a control map.
//!
//! A rule counts as much as its things cover of a pixel, and over those before it. What an artist painted is refined by it: factors
//! of both multiply, and where there are to be no lines there are none.

use crate::stylize::preset::ObjectRule;
use crate::stylize::things;

/// What a control map has where nothing is wanted.
const NEUTRAL: f32 = 0.5;
/// Channel of the amount of lines, of which 0 is none.
const AMOUNT: usize = 2;
/// Distance in pixels, of a picture 1080 lines high, over which lines beside a thing follow its rules and not those of what is
/// farther away.
const REACH: f32 = 3.0;
/// Part of a distance from which on something is farther away.
const BEHIND: f32 = 0.01;

/// What a control map has where things are: detail, width of lines, their amount and strength of the medium.
pub type Control = [Option<f32>; 4];

/// A rule for things.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// What a control map has where they are.
    pub control: Control,
    /// True where lines that follow it reach beyond them.
    pub has_lines: bool,
}

impl From<&ObjectRule> for Rule {
    fn from(rule: &ObjectRule) -> Self {
        Self { control: rule.control, has_lines: things::has_lines(rule) }
    }
}

impl Rule {
    /// True where a control map says nothing of it.
    pub fn is_neutral(&self) -> bool {
        self.control.iter().all(Option::is_none)
    }
}

/// Coverage of the things of a rule, and what it says.
#[derive(Clone, Copy, Debug)]
pub struct Covered<'a> {
    /// From 0 to 1 by pixel; nothing where they are not known.
    pub coverage: Option<&'a [f32]>,
    /// What it says.
    pub control: Control,
}

/// The control map of rules for a picture of `width` pixels a row, over what was `painted` for it.
pub fn map(rules: &[Covered<'_>], width: usize, painted: Option<&[f32]>, depth: Option<&[f32]>) -> Vec<f32> {
    let pixels = rules.iter().find_map(|rule| rule.coverage).map_or(0, <[f32]>::len);
    let mut map = vec![NEUTRAL; pixels * 4];
    for rule in rules {
        for (pixel, covered) in map.chunks_exact_mut(4).zip(rule.coverage.into_iter().flatten()) {
            for (value, wanted) in pixel.iter_mut().zip(rule.control) {
                *value += (wanted.unwrap_or(*value) - *value) * covered;
            }
        }
    }
    if let Some(depth) = depth {
        map = of_nearest(&map, 4, width, depth);
    }
    for (index, (value, painted)) in map.iter_mut().zip(painted.into_iter().flatten()).enumerate() {
        // What is no number was not painted.
        let painted = if painted.is_finite() { painted.clamp(0.0, 1.0) } else { NEUTRAL };
        if !(index % 4 == AMOUNT && *value == 0.0) {
            *value = (*value + painted - NEUTRAL).clamp(0.0, 1.0);
        }
    }
    map
}

/// Coverage of things with that of the lines around them: by what is nearest within reach, where the picture has depth.
pub fn with_lines(coverage: &[f32], width: usize, depth: Option<&[f32]>) -> Vec<f32> {
    depth.map_or_else(|| coverage.to_vec(), |depth| of_nearest(coverage, 1, width, depth))
}

/// The map, of so many channels, with the values of the nearest thing within reach: a line between two things lies on both.
fn of_nearest(map: &[f32], channels: usize, width: usize, depth: &[f32]) -> Vec<f32> {
    let height = depth.len() / width.max(1);
    let reach = (REACH * height as f32 / 1080.0).round().max(1.0) as usize;
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
    for (pixel, (near, own)) in result.chunks_exact_mut(channels).zip(both.iter().zip(&own)) {
        if near.0 < own.0 * (1.0 - BEHIND) {
            pixel.copy_from_slice(&map[near.1 * channels..][..channels]);
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

    fn covered(coverage: &[f32], control: Control) -> Covered<'_> {
        Covered { coverage: Some(coverage), control }
    }

    #[test]
    fn the_last_rule_counts_as_much_as_it_covers() {
        let wide = [None, Some(1.0), None, None];
        let fine = [None, Some(0.0), Some(0.0), None];
        let (whole, half) = ([1.0, 1.0, 0.0], [0.0, 0.5, 0.0]);
        let map = map(&[covered(&whole, wide), covered(&half, fine)], 3, None, None);
        assert_eq!(map, [0.5, 1.0, 0.5, 0.5, 0.5, 0.5, 0.25, 0.5, 0.5, 0.5, 0.5, 0.5]);
    }

    #[test]
    fn what_is_painted_refines_rules_and_brings_no_lines_back() {
        let rule = [Some(0.75), None, Some(0.0), None];
        let painted = [0.75, 0.25, 1.0, f32::NAN];
        assert_eq!(map(&[covered(&[1.0], rule)], 1, Some(&painted), None), [1.0, 0.25, 0.0, 0.5]);
    }

    #[test]
    fn a_line_between_two_things_follows_the_nearer_one() {
        let rule = [None, None, Some(0.0), None];
        let coverage = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        let amounts = |depth: &[f32]| -> Vec<f32> {
            let map = map(&[covered(&coverage, rule)], 6, None, Some(depth));
            map.chunks_exact(4).map(|pixel| pixel[2]).collect()
        };
        assert_eq!(amounts(&[1.0, 1.0, 1.0, 5.0, 5.0, 5.0]), [0.0, 0.0, 0.0, 0.0, 0.5, 0.5]);
        let far = [1.0, 1.0, 1.0, 5.0, 5.0, 5.0];
        assert_eq!(with_lines(&coverage, 6, Some(&far)), [1.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
        assert_eq!(with_lines(&coverage, 6, None), coverage);
        assert_eq!(amounts(&[5.0, 5.0, 5.0, 1.0, 1.0, 1.0]), [0.0, 0.0, 0.5, 0.5, 0.5, 0.5]);
        // A surface that leads away is one thing, and what has no depth is behind all.
        assert_eq!(amounts(&[1.0, 1.001, 1.002, 1.003, 1.004, 1.005]), [0.0, 0.0, 0.0, 0.5, 0.5, 0.5]);
        assert_eq!(amounts(&[0.0, 0.0, f32::NAN, 3.0, 3.0, 3.0]), [0.0, 0.0, 0.5, 0.5, 0.5, 0.5]);
    }
}
