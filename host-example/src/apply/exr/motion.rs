//! Motion vectors of renderers: which layers hold them, and what their numbers mean.
//!
//! The library wants pixels, x to the right and y down, from where a thing is to where it is in the other frame. Files
//! hold what their renderer's authors found natural. A field that leads one way only stands for the other too, reversed:
//! things hardly change their velocity from frame to frame.

use std::str::FromStr;

use super::names::Group;
use crate::pixels::{Pixels, Samples};

/// What a file's motion vectors mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convention {
    /// For messages and `--motion-convention`.
    pub name: &'static str,
    /// To the frame before.
    backward: Field,
    /// To the frame after.
    forward: Field,
    units: Units,
    /// Whether y counts upwards.
    is_up: bool,
    /// The number that stands for no motion.
    centre: f32,
    /// What one unit is stored as, the other way round: vectors are multiplied by it.
    scale: f32,
}

/// Where the vectors of one direction are.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Field {
    /// Last words of the layer's name, in lower case.
    words: &'static [&'static str],
    /// Components, the first pair that the layer has.
    components: &'static [[&'static str; 2]],
    /// -1 where the vectors lead the other way.
    sign: f32,
}

/// What a vector of length 1 is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Units {
    Pixels,
    /// The picture's width and height.
    Normalised,
    /// Half of the picture's width and height, as normalised device coordinates are from -1 to 1.
    Ndc,
}

/// Names of components that hold x and y.
const PAIRS: &[[&str; 2]] = &[["u", "v"], ["X", "Y"], ["R", "G"]];

const fn field(words: &'static [&'static str], sign: f32) -> Field {
    Field { words, components: PAIRS, sign }
}

/// As compositors have it, and as `isophote render` writes it: layers `backward` and `forward`, pixels, y up.
const OWN: Convention = Convention {
    name: "isophote",
    backward: field(&["backward"], 1.0),
    forward: field(&["forward"], 1.0),
    units: Units::Pixels,
    is_up: true,
    centre: 0.0,
    scale: 1.0,
};

/// All that have a name.
const PRESETS: [Convention; 6] = [
    OWN,
    // The AOV of an instantaneous shutter: pixels that a thing moves to the next frame.
    Convention {
        name: "arnold",
        backward: field(&["motionvector", "motion_vector"], -1.0),
        forward: field(&["motionvector", "motion_vector"], 1.0),
        ..OWN
    },
    // The pass Vector: X and Y lead to the frame before, Z and W come from the frame after.
    Convention {
        name: "blender",
        backward: Field { words: &["vector"], components: &[["X", "Y"]], sign: 1.0 },
        forward: Field { words: &["vector"], components: &[["Z", "W"]], sign: -1.0 },
        ..OWN
    },
    // Raster space, whose rows count downwards.
    Convention {
        name: "renderman",
        backward: field(&["motionback"], 1.0),
        forward: field(&["motionfore"], 1.0),
        is_up: false,
        ..OWN
    },
    // Pixels to the next frame around mid-grey, where a pixel is half of the range.
    Convention {
        name: "vray",
        backward: field(&["velocity"], -1.0),
        forward: field(&["velocity"], 1.0),
        centre: 0.5,
        scale: 2.0,
        ..OWN
    },
    // The pass of the render queue: normalised device coordinates around mid-grey.
    Convention {
        name: "unreal",
        backward: field(&["motionvectors", "finalimagemotionvectors"], -1.0),
        forward: field(&["motionvectors", "finalimagemotionvectors"], 1.0),
        units: Units::Ndc,
        centre: 0.5,
        scale: 2.0,
        ..OWN
    },
];

/// How to write a convention.
const FIX: &str = "write isophote, arnold, blender, renderman, vray or unreal, and with commas what differs: \
                   units=pixels|normalised|ndc, y=up|down, direction=backward|forward, sign=1|-1, centre=NUMBER, scale=NUMBER";

impl FromStr for Convention {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || FIX.to_owned();
        let mut words = text.split(',').map(str::trim);
        let name = words.next().unwrap_or_default();
        let mut convention = *PRESETS.iter().find(|p| p.name == name).ok_or_else(wrong)?;
        let (mut reversed, mut leads) = (1.0, None);
        for word in words {
            let (key, value) = word.split_once('=').ok_or_else(wrong)?;
            let number = || value.parse::<f32>().ok().filter(|n| n.is_finite()).ok_or_else(wrong);
            match (key, value) {
                ("units", "pixels") => convention.units = Units::Pixels,
                ("units", "normalised") => convention.units = Units::Normalised,
                ("units", "ndc") => convention.units = Units::Ndc,
                ("y", "up") => convention.is_up = true,
                ("y", "down") => convention.is_up = false,
                ("direction", "backward") => leads = Some(1.0),
                ("direction", "forward") => leads = Some(-1.0),
                ("sign", "1" | "+1") => reversed = 1.0,
                ("sign", "-1") => reversed = -1.0,
                ("centre" | "center", _) => convention.centre = number()?,
                ("scale", _) => convention.scale = number()?,
                _ => return Err(wrong()),
            }
        }
        if let Some(sign) = leads {
            // One field, whichever it is, that stands for both ways.
            convention.backward.sign = sign;
            convention.forward = Field { sign: -sign, ..convention.backward };
        }
        convention.backward.sign *= reversed;
        convention.forward.sign *= reversed;
        Ok(convention)
    }
}

/// Vectors that a file has.
#[derive(Clone, Debug)]
pub struct Found {
    /// The channels of x and y.
    pub channels: Vec<usize>,
    /// How they are turned into the library's.
    pub rule: Rule,
}

/// How a vector is turned into the library's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    convention: Convention,
    sign: f32,
}

/// The vectors to the frame before, or after, in a group of channels; of the layer that was asked for where `is_named`, and
/// in the convention that was asked for where there is one.
pub fn find(group: &Group, is_forward: bool, is_named: bool, asked: Option<Convention>) -> Option<Found> {
    let word = group.word();
    let side = |c: &Convention| if is_forward { c.forward } else { c.backward };
    let has = |c: &Convention| {
        let field = side(c);
        let knows = field.words.contains(&word.as_str());
        if !knows && !is_named {
            return None;
        }
        let channels = field.components.iter().find_map(|pair| group.all(*pair))?;
        Some(Found { channels, rule: Rule { convention: *c, sign: field.sign } })
    };
    match asked {
        Some(convention) => has(&convention),
        None => {
            let mut known = PRESETS.iter().filter(|c| side(c).words.contains(&word.as_str()));
            known.find_map(has).or_else(|| if is_named { has(&OWN) } else { None })
        }
    }
}

impl Rule {
    /// Vectors of x and y for a picture of this size, in the library's convention; what is not finite stays so, for unknown.
    pub fn applied(self, mut vectors: Vec<f32>, (width, height): (u32, u32)) -> Option<Pixels> {
        let Convention { units, is_up, centre, scale, .. } = self.convention;
        let unit = match units {
            Units::Pixels => [1.0; 2],
            Units::Normalised => [width as f32, height as f32],
            Units::Ndc => [width as f32 * 0.5, height as f32 * 0.5],
        };
        let factor = scale * self.sign;
        let [x, y] = [factor * unit[0], if is_up { -factor } else { factor } * unit[1]];
        for vector in vectors.chunks_exact_mut(2) {
            vector[0] = (vector[0] - centre) * x;
            vector[1] = (vector[1] - centre) * y;
        }
        Pixels::new(width, height, 2, Samples::F32(vectors))
    }
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
        let pixels = found.rule.applied(vector, (1, 1)).unwrap().to_f32();
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
