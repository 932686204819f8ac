//! Meaning of the motion vectors of renderers and compositors, for whoever reads them: from files, or as the images of
//! a host.
//!
//! The library wants pixels, x to the right and y down, from where a thing is to where it is in the other frame. Passes
//! hold what their renderer's authors found natural. A pass that leads one way only stands for the other too, reversed:
//! things hardly change their velocity from frame to frame.

#![forbid(unsafe_code)]

use std::str::FromStr;

/// Direction in which vectors lead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// To the frame before.
    Backward,
    /// To the frame after.
    Forward,
}

impl Way {
    /// The other one.
    pub const fn other(self) -> Self {
        match self {
            Self::Backward => Self::Forward,
            Self::Forward => Self::Backward,
        }
    }
}

/// Meaning of motion vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convention {
    /// Stable name, for scripts and the command line.
    pub name: &'static str,
    /// For people.
    pub label: &'static str,
    /// To the frame before.
    backward: Field,
    /// To the frame after.
    forward: Field,
    units: Units,
    /// True where y counts upwards.
    is_up: bool,
    /// The number that stands for no motion.
    centre: f32,
    /// Number that one unit is stored as, the other way round: vectors are multiplied by it.
    scale: f32,
}

/// Place of the vectors of one way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// Last words of the layer's name in a file, in lower case.
    pub words: &'static [&'static str],
    /// Components of the layer, the first pair that it has.
    pub components: &'static [[&'static str; 2]],
    /// Place of the pair among the channels of an image of that layer alone.
    pub channels: [usize; 2],
    /// -1 where the vectors lead the other way.
    sign: f32,
}

/// Unit of the length of vectors.
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
    Field { words, components: PAIRS, channels: [0, 1], sign }
}

impl Convention {
    /// As compositors have it, and as `isophote render` writes it: layers `backward` and `forward`, pixels, y up.
    pub const OWN: Self = Self {
        name: "isophote",
        label: "Compositor",
        backward: field(&["backward"], 1.0),
        forward: field(&["forward"], 1.0),
        units: Units::Pixels,
        is_up: true,
        centre: 0.0,
        scale: 1.0,
    };

    /// All that have a name. Projects store positions in this list: new ones come last.
    pub const PRESETS: [Self; 6] = [
        Self::OWN,
        // The AOV of an instantaneous shutter: pixels that a thing moves to the next frame.
        Self {
            name: "arnold",
            label: "Arnold",
            backward: field(&["motionvector", "motion_vector"], -1.0),
            forward: field(&["motionvector", "motion_vector"], 1.0),
            ..Self::OWN
        },
        // The pass Vector: X and Y lead to the frame before, Z and W come from the frame after.
        Self {
            name: "blender",
            label: "Blender",
            backward: Field { components: &[["X", "Y"]], ..field(&["vector"], 1.0) },
            forward: Field { components: &[["Z", "W"]], channels: [2, 3], ..field(&["vector"], -1.0) },
            ..Self::OWN
        },
        // Raster space, whose rows count downwards.
        Self {
            name: "renderman",
            label: "RenderMan",
            backward: field(&["motionback"], 1.0),
            forward: field(&["motionfore"], 1.0),
            is_up: false,
            ..Self::OWN
        },
        // Pixels to the next frame around mid-grey, where a pixel is half of the range.
        Self {
            name: "vray",
            label: "V-Ray",
            backward: field(&["velocity"], -1.0),
            forward: field(&["velocity"], 1.0),
            centre: 0.5,
            scale: 2.0,
            ..Self::OWN
        },
        // The pass of the render queue: normalised device coordinates around mid-grey.
        Self {
            name: "unreal",
            label: "Unreal",
            backward: field(&["motionvectors", "finalimagemotionvectors"], -1.0),
            forward: field(&["motionvectors", "finalimagemotionvectors"], 1.0),
            units: Units::Ndc,
            centre: 0.5,
            scale: 2.0,
            ..Self::OWN
        },
    ];

    /// Place of the vectors of a way.
    pub const fn field(&self, way: Way) -> &Field {
        match way {
            Way::Backward => &self.backward,
            Way::Forward => &self.forward,
        }
    }

    /// Rule by which the vectors of a way are read.
    pub const fn rule(self, way: Way) -> Rule {
        Rule { sign: self.field(way).sign, convention: self }
    }

    /// The image to read the vectors of a way from, where they are in it, and how they are read: of two images, those of
    /// the passes to the frame before and to the one after, of as many channels as said (0 where there is none).
    ///
    /// A convention of one pass for both ways has them in either image. Of others a pass leads one way, and stands for the
    /// other reversed.
    pub fn among(&self, way: Way, [backward, forward]: [usize; 2]) -> Option<(Way, [usize; 2], Rule)> {
        let channels = |of: Way| if of == Way::Forward { forward } else { backward };
        let holds = |of: Way, field: &Field| field.channels.iter().all(|c| *c < channels(of));
        let (own, other) = (self.field(way), self.field(way.other()));
        if holds(way, own) {
            return Some((way, own.channels, self.rule(way)));
        }
        if own.words == other.words && holds(way.other(), own) {
            return Some((way.other(), own.channels, self.rule(way)));
        }
        [way.other(), way]
            .into_iter()
            .find(|of| holds(*of, other))
            .map(|of| (of, other.channels, self.rule(way.other()).reversed()))
    }
}

/// Form in which a convention is written.
const FIX: &str = "write isophote, arnold, blender, renderman, vray or unreal, and with commas what differs: \
                   units=pixels|normalised|ndc, y=up|down, direction=backward|forward, sign=1|-1, centre=NUMBER, scale=NUMBER";

impl FromStr for Convention {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || FIX.to_owned();
        let mut words = text.split(',').map(str::trim);
        let name = words.next().unwrap_or_default();
        let mut convention = *Self::PRESETS.iter().find(|p| p.name == name).ok_or_else(wrong)?;
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

/// Rule by which a vector is turned into the library's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    convention: Convention,
    sign: f32,
}

impl Rule {
    /// The same for vectors that lead the other way.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self { sign: -self.sign, ..self }
    }

    /// Turns vectors, x and y in turn, of a picture of this size into the library's; what is not finite stays so, for
    /// unknown.
    pub fn apply(self, vectors: &mut [f32], [width, height]: [f32; 2]) {
        let Convention { units, is_up, centre, scale, .. } = self.convention;
        let unit = match units {
            Units::Pixels => [1.0; 2],
            Units::Normalised => [width, height],
            Units::Ndc => [width * 0.5, height * 0.5],
        };
        let factor = scale * self.sign;
        let [x, y] = [factor * unit[0], if is_up { -factor } else { factor } * unit[1]];
        for vector in vectors.chunks_exact_mut(2) {
            vector[0] = (vector[0] - centre) * x;
            vector[1] = (vector[1] - centre) * y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The vectors of a way that are read from images of these pixels, one to the frame before and one to the one after.
    fn read(name: &str, way: Way, images: [&[f32]; 2]) -> Option<[f32; 2]> {
        let convention: Convention = name.parse().unwrap();
        let (from, channels, rule) = convention.among(way, images.map(<[f32]>::len))?;
        let image = images[usize::from(from == Way::Forward)];
        let mut vector = channels.map(|c| image[c]);
        rule.apply(&mut vector, [1.0; 2]);
        Some(vector)
    }

    /// A thing that moves 3 pixels to the right and 1 upwards in every frame.
    #[test]
    fn one_image_stands_for_both_ways() {
        for (name, image) in [
            ("isophote", [-3.0, -1.0, 0.0, 0.0]),
            ("arnold", [3.0, 1.0, 0.0, 0.0]),
            ("blender", [-3.0, -1.0, -3.0, -1.0]),
            ("renderman", [-3.0, 1.0, 0.0, 0.0]),
            ("vray", [2.0, 1.0, 0.0, 0.0]),
            ("unreal", [3.5, 1.5, 0.0, 0.0]),
        ] {
            // A pass of two components may come with three channels.
            for image in [&image[..], &image[..3]] {
                assert_eq!(read(name, Way::Backward, [image, &[]]), Some([-3.0, 1.0]), "{name}");
                assert_eq!(read(name, Way::Forward, [image, &[]]), Some([3.0, -1.0]), "{name}");
            }
        }
        let forward: &[f32] = &[3.0, 1.0, 0.0];
        assert_eq!(read("isophote", Way::Backward, [&[], forward]), Some([-3.0, 1.0]));
        assert_eq!(read("arnold", Way::Backward, [&[], forward]), Some([-3.0, 1.0]));
        assert_eq!(read("isophote", Way::Forward, [&[-2.0, 0.0], forward]), Some([3.0, -1.0]));
        assert_eq!(read("isophote", Way::Forward, [&[], &[1.0]]), None);
    }

    #[test]
    fn names_are_those_of_the_list() {
        for preset in Convention::PRESETS {
            assert_eq!(preset.name.parse(), Ok(preset));
            assert!(FIX.contains(preset.name), "{}", preset.name);
        }
    }
}
