//! Motion vectors in files: which layers hold them. What their numbers mean is the affair of [`isophote_motion`].

use super::names::Group;
use crate::pixels::{Pixels, Samples};
use isophote_motion::{Convention, Rule, Way};

/// Vectors that a file has.
#[derive(Clone, Debug)]
pub struct Found {
    /// The channels of x and y.
    pub channels: Vec<usize>,
    /// Rule by which they are turned into the library's.
    pub rule: Rule,
}

/// The vectors to the frame before, or after, in a group of channels; of the layer that was asked for where `is_named`, and
/// in the convention that was asked for where there is one.
pub fn find(group: &Group, is_forward: bool, is_named: bool, asked: Option<Convention>) -> Option<Found> {
    let word = group.word();
    let way = if is_forward { Way::Forward } else { Way::Backward };
    let has = |c: &Convention| {
        let field = c.field(way);
        let knows = field.words.contains(&word.as_str());
        if !knows && !is_named {
            return None;
        }
        let channels = field.components.iter().find_map(|pair| group.all(*pair))?;
        Some(Found { channels, rule: c.rule(way) })
    };
    match asked {
        Some(convention) => has(&convention),
        None => {
            let mut known =
                Convention::PRESETS.iter().filter(|c| c.field(way).words.contains(&word.as_str()));
            known.find_map(has).or_else(|| if is_named { has(&Convention::OWN) } else { None })
        }
    }
}

/// Vectors of x and y for a picture of this size, in the library's convention.
pub fn applied(rule: Rule, mut vectors: Vec<f32>, (width, height): (u32, u32)) -> Option<Pixels> {
    rule.apply(&mut vectors, [width as f32, height as f32]);
    Pixels::new(width, height, 2, Samples::F32(vectors))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(layer: &str, components: &[&str]) -> Group {
        let members = components.iter().enumerate().map(|(at, c)| ((*c).to_owned(), at)).collect();
        Group { part: 0, prefix: layer.into(), layer: layer.into(), view: None, members }
    }

    fn read(
        layer: &str,
        components: &[&str],
        stored: [f32; 4],
        is_forward: bool,
        asked: Option<&str>,
    ) -> [f32; 2] {
        let asked = asked.map(|text| text.parse().unwrap());
        let found = find(&group(layer, components), is_forward, false, asked).unwrap();
        let vector = found.channels.iter().map(|c| stored[*c]).collect();
        let pixels = applied(found.rule, vector, (1, 1)).unwrap().to_f32();
        [pixels[0], pixels[1]]
    }

    /// A thing that moves 3 pixels to the right and 1 upwards in every frame, as each renderer stores it.
    #[test]
    fn the_same_motion_is_read_from_every_renderer() {
        let xyzw = ["X", "Y", "Z", "W"];
        let rg = ["R", "G", "B"];
        let cases: [(&str, &[&str], [f32; 4]); 6] = [
            ("backward", &["u", "v"], [-3.0, -1.0, 0.0, 0.0]),
            ("motionvector", &rg, [3.0, 1.0, 0.0, 0.0]),
            ("ViewLayer.Vector", &xyzw, [-3.0, -1.0, -3.0, -1.0]),
            ("motionBack", &["X", "Y", "Z"], [-3.0, 1.0, 0.0, 0.0]),
            ("velocity", &rg, [2.0, 1.0, 0.0, 0.0]),
            // Half of a picture of one pixel is the unit.
            ("FinalImageMotionVectors", &rg, [3.5, 1.5, 0.0, 0.0]),
        ];
        for (layer, components, stored) in cases {
            assert_eq!(read(layer, components, stored, false, None), [-3.0, 1.0], "{layer}");
        }
        for (layer, components, stored) in [
            ("forward", &["u", "v"][..], [3.0, 1.0, 0.0, 0.0]),
            ("motionvector", &rg, [3.0, 1.0, 0.0, 0.0]),
            ("Vector", &xyzw, [-3.0, -1.0, -3.0, -1.0]),
            ("motionFore", &["X", "Y", "Z"], [3.0, -1.0, 0.0, 0.0]),
            ("velocity", &rg, [2.0, 1.0, 0.0, 0.0]),
        ] {
            assert_eq!(read(layer, components, stored, true, None), [3.0, -1.0], "{layer}");
        }
    }

    #[test]
    fn conventions_are_told_by_what_differs() {
        let stored = [6.0, 2.0, 0.0, 0.0];
        let read = |asked: &str| read("backward", &["u", "v"], stored, false, Some(asked));
        assert_eq!(read("isophote"), [6.0, -2.0]);
        assert_eq!(read("isophote,y=down"), [6.0, 2.0]);
        assert_eq!(read("isophote,sign=-1"), [-6.0, 2.0]);
        assert_eq!(read("isophote,direction=forward"), [-6.0, 2.0]);
        assert_eq!(read("isophote,centre=1,scale=0.5,units=ndc"), [1.25, -0.25]);
        for bad in ["", "maya", "arnold,y=left", "arnold,units=miles", "arnold,scale=wide", "arnold,up"] {
            assert!(bad.parse::<Convention>().is_err(), "{bad}");
        }
    }
}
