//! How a scene is seen and lit: options that `render` and `view` have in common.

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

use clap::Args;
use glam::Vec3;

use isophote_files::error::{Error, Result};
use isophote_pictures::space::srgb_decode;
use isophote_render::background::Background;
use isophote_scene::camera::{self, Direction, Framing};
use isophote_scene::environment::Environment;
use isophote_scene::{Scene, floor};

/// Camera, light and background.
#[derive(Args, Debug)]
pub struct StagingArgs {
    /// Camera of the file to look through, by the name of its node, by its own or by number from 0 [default: the first,
    /// unless one of the options of the default camera is given].
    #[arg(long, value_name = "NAME", conflicts_with_all = ["azimuth", "elevation", "distance", "target", "fov"])]
    camera: Option<String>,
    /// Degrees by which the default camera and turntables are turned to the right around the scene [default: 0].
    #[arg(long, value_name = "DEGREES", value_parser = finite, allow_negative_numbers = true)]
    azimuth: Option<f32>,
    /// Height of the default camera and turntables above the horizon in degrees, below 90 [default: 16].
    #[arg(long, value_name = "DEGREES", value_parser = finite, allow_negative_numbers = true)]
    elevation: Option<f32>,
    /// How far away the default camera and turntables are, as a factor on the distance from which the scene fills the
    /// picture, from 0.1 to 100 [default: 1].
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    distance: Option<f32>,
    /// What the default camera and turntables look at, in the scene's units [default: the middle of the scene].
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    target: Option<Vec3>,
    /// Vertical field of view of the default camera and turntables in degrees, from 1 to 150 [default: 34.4].
    #[arg(long, value_name = "DEGREES", value_parser = field_of_view)]
    fov: Option<f32>,
    /// Where the sun is: degrees to the right of the camera as it stands before anything moves, from -360 to 360 (0 is
    /// behind it), and above the horizon, from -90 to 90 [default: the sun of the file, or -60,40].
    #[arg(long, value_name = "AZIMUTH,ELEVATION", value_parser = light, allow_hyphen_values = true)]
    light: Option<Direction>,
    /// Brightness of the scene in stops, from -16 to 16. What EXR files hold of the scene is as bright as it is.
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, value_parser = stops, allow_negative_numbers = true)]
    exposure: f32,
    /// What is behind the scene: sky, transparent, a colour #rrggbb that is shown as it is, or an equirectangular picture
    /// of the surroundings (Radiance HDR or EXR), which lights the scene, too.
    #[arg(long, value_name = "sky|transparent|#rrggbb|FILE", default_value = "sky")]
    background: Behind,
    /// Lets the scene cast its shadow on an invisible ground at its lowest point [default: if it has neither a floor nor
    /// lights of its own].
    #[arg(long, overrides_with = "no_ground")]
    ground: bool,
    /// Lets the scene cast no shadow on an invisible ground.
    #[arg(long, overrides_with = "ground")]
    no_ground: bool,
}

/// What is behind the scene, as it is written.
#[derive(Clone, Debug, PartialEq)]
enum Behind {
    Sky,
    Transparent,
    /// Linear light.
    Color(Vec3),
    File(PathBuf),
}

impl FromStr for Behind {
    type Err = &'static str;

    fn from_str(text: &str) -> std::result::Result<Self, Self::Err> {
        let refusal =
            "write sky, transparent, a colour such as '#aabbcc', or the name of an .hdr or .exr file";
        match text {
            "sky" => return Ok(Self::Sky),
            "transparent" => return Ok(Self::Transparent),
            _ => {}
        }
        if let Some(digits) = text.strip_prefix('#') {
            let is_color = digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit());
            let number = u32::from_str_radix(digits, 16).ok().filter(|_| is_color).ok_or(refusal)?;
            let [_, rgb @ ..] = number.to_be_bytes();
            return Ok(Self::Color(rgb.map(|v| srgb_decode(f32::from(v) / 255.0)).into()));
        }
        let path = PathBuf::from(text);
        let extension = path.extension().unwrap_or_default();
        let is_known = ["hdr", "exr"].iter().any(|known| extension.eq_ignore_ascii_case(known));
        if is_known { Ok(Self::File(path)) } else { Err(refusal) }
    }
}

impl StagingArgs {
    /// How the default camera and turntables frame the scene.
    pub fn framing(&self) -> Framing {
        let usual = Framing::default();
        let or = |degrees: Option<f32>, usual: f32| degrees.map_or(usual, f32::to_radians);
        Framing {
            direction: Direction {
                azimuth: usual.direction.azimuth + or(self.azimuth, 0.0),
                elevation: or(self.elevation, usual.direction.elevation),
            },
            distance: self.distance.unwrap_or(usual.distance),
            vertical_fov: or(self.fov, usual.vertical_fov),
            target: self.target,
        }
    }

    /// Node of the camera of the file that the scene is seen through, if it is not the default camera.
    ///
    /// # Errors
    /// [`Error::Input`] for a camera that the file does not have, with those that it has.
    pub fn camera(&self, scene: &Scene) -> Result<Option<usize>> {
        let framed = [self.azimuth, self.elevation, self.distance, self.fov];
        match &self.camera {
            Some(name) => camera::find_file_camera(scene, name).map(Some).ok_or_else(|| {
                let fix = match camera::list_file_cameras(scene) {
                    known if known.is_empty() => "the scene has no cameras".to_owned(),
                    known => format!("choose from {}", known.join(", ")),
                };
                Error::input("--camera", format!("'{name}' is not a camera of the scene"), fix)
            }),
            None if framed.iter().any(Option::is_some) || self.target.is_some() => Ok(None),
            None => Ok(camera::file_camera(scene)),
        }
    }

    /// What is behind the scene.
    ///
    /// # Errors
    /// [`Error::Input`] for a picture that cannot be read or does not show all directions.
    pub fn background(&self) -> Result<Background> {
        Ok(match &self.background {
            Behind::Sky => Background::Sky,
            Behind::Transparent => Background::Transparent,
            Behind::Color(color) => Background::Color(*color),
            Behind::File(path) => Background::Environment(Arc::new(Environment::read(path)?)),
        })
    }

    /// The file of the picture of the surroundings.
    pub fn surroundings(&self) -> Option<PathBuf> {
        match &self.background {
            Behind::File(path) => Some(path.clone()),
            _ => None,
        }
    }

    /// Whether the scene casts its shadow on an invisible ground.
    pub fn ground(&self, scene: &Scene) -> bool {
        self.ground || !self.no_ground && floor::lacks_floor(scene)
    }

    /// Where the sun is, seen from the camera, if not where it usually is.
    pub fn light(&self) -> Option<Direction> {
        self.light
    }

    /// Brightness of the scene in stops.
    pub fn exposure(&self) -> f32 {
        self.exposure
    }
}

type Parsed<T> = std::result::Result<T, String>;

/// A number within bounds, or what to write.
fn number(text: &str, bounds: std::ops::RangeInclusive<f32>, what: &str) -> Parsed<f32> {
    let number = text.trim().parse().ok().filter(|number| bounds.contains(number));
    number.ok_or_else(|| format!("write {what} from {} to {}", bounds.start(), bounds.end()))
}

fn finite(text: &str) -> Parsed<f32> {
    number(text, -1e6..=1e6, "degrees")
}

fn factor(text: &str) -> Parsed<f32> {
    number(text, 0.1..=100.0, "a factor")
}

fn field_of_view(text: &str) -> Parsed<f32> {
    number(text, 1.0..=150.0, "degrees")
}

fn stops(text: &str) -> Parsed<f32> {
    number(text, -16.0..=16.0, "stops")
}

fn point(text: &str) -> Parsed<Vec3> {
    let parts: Vec<f32> =
        text.split(',').map(|part| number(part, -1e9..=1e9, "a coordinate")).collect::<Parsed<_>>()?;
    <[f32; 3]>::try_from(parts).map(Vec3::from).map_err(|_| "write three coordinates such as 0,1.5,0".into())
}

fn light(text: &str) -> Parsed<Direction> {
    let (azimuth, elevation) = text.split_once(',').ok_or("write azimuth and elevation such as -60,40")?;
    Ok(Direction {
        azimuth: number(azimuth, -360.0..=360.0, "an azimuth in degrees")?.to_radians(),
        elevation: number(elevation, -90.0..=90.0, "an elevation in degrees")?.to_radians(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_out_of_range_is_refused_with_the_range() {
        let left = light("-90, 30").unwrap();
        assert!((left.vector() + left.vector().with_y(-0.5)).x < -1.7);
        for bad in ["", "30", "a,b", "30,91", "361,0", "nan,0", "0,inf", "1,2,3"] {
            assert!(light(bad).is_err(), "{bad}");
        }
        assert_eq!(point("1,-2, 3.5"), Ok(Vec3::new(1.0, -2.0, 3.5)));
        for bad in ["", "1,2", "1,2,3,4", "a,b,c", "nan,0,0", "inf,0,0"] {
            assert!(point(bad).is_err(), "{bad}");
        }
        assert_eq!(stops("-1.5"), Ok(-1.5));
        assert!(stops("17").is_err());
        assert_eq!(factor("2"), Ok(2.0));
        assert_eq!(factor("0"), Err("write a factor from 0.1 to 100".into()));
        assert_eq!(field_of_view("179"), Err("write degrees from 1 to 150".into()));
        assert!(finite("nan").is_err() && finite("-30").is_ok());
    }

    #[test]
    fn backgrounds_are_words_colours_and_files() {
        let parse = |text: &str| text.parse::<Behind>();
        assert_eq!(parse("transparent"), Ok(Behind::Transparent));
        assert_eq!(parse("#ff0000"), Ok(Behind::Color(Vec3::X)));
        assert_eq!(parse("a/b.HDR"), Ok(Behind::File("a/b.HDR".into())));
        for bad in ["", "blue", "#12345", "#1234567", "#+12345", "#gggggg", "a.png"] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }
}
