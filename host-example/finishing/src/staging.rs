//! Options of scenes: how one is read, seen, lit and moved. They are declared here once, read from command lines by
//! `render` and `view`, and written as command lines by the window.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

use clap::{Args, ValueEnum};
use glam::Vec3;

use crate::options::{flag, words};
use crate::stylize::preset;
use isophote_files::error::{Error, Result};
use isophote_files::output;
use isophote_pictures::transfer::{srgb_decode, srgb_encode};
use isophote_render::background::Background;
use isophote_scene::camera::{self, Direction, Framing};
use isophote_scene::environment::Environment;
use isophote_scene::{Scene, floor};

/// Options for reading scenes.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub struct ReadingArgs {
    /// Image that colours an OBJ without textures.
    #[arg(long, value_name = "FILE")]
    pub texture: Option<PathBuf>,
    /// Axis of the file that points up.
    #[arg(long, value_name = "AXIS", default_value = "y")]
    pub up: Up,
}

/// An axis that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Up {
    /// As in glTF and in most programs for animation.
    #[default]
    Y,
    /// As in CAD programs and scanners.
    Z,
}

impl ReadingArgs {
    /// The options as they are written, without those that say the usual.
    pub fn words(&self) -> Vec<String> {
        words::<Self>(|id| match id {
            "texture" => self.texture.as_ref().map(|file| file.display().to_string()),
            "up" => (self.up == Up::Z).then(|| "z".to_owned()),
            _ => None,
        })
    }

    /// Loads a scene and prints its warnings.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn load(&self, path: &Path) -> Result<Scene> {
        let mut scene = Scene::load(path, self.texture.as_deref())?;
        if self.up == Up::Z {
            scene.turn_z_up();
        }
        for warning in &scene.warnings {
            output::warn(format_args!("{}: {warning}", path.display()));
        }
        Ok(scene)
    }
}

/// Moment and animation of a scene that are shown.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub struct MotionArgs {
    /// Plays the file's animation, in a loop.
    #[arg(long)]
    pub animate: bool,
    /// Animation that plays, by name or by number from 0; the first if not given.
    #[arg(long, value_name = "NAME")]
    pub animation: Option<String>,
    /// Time of frame 1 in the animation in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, allow_negative_numbers = true)]
    pub start: f32,
}

impl MotionArgs {
    /// The options as they are written, without those that say the usual.
    pub fn words(&self) -> Vec<String> {
        words::<Self>(|id| match id {
            "animate" => flag(self.animate),
            "animation" => self.animation.clone(),
            "start" => (self.start != 0.0).then(|| format!("{:.4}", self.start)),
            _ => None,
        })
    }

    /// Index of the animation that plays, if one does.
    ///
    /// # Errors
    /// [`Error::Input`] for an animation that the scene, which was read from `file`, does not have.
    pub fn choose(&self, file: &Path, scene: &Scene) -> Result<Option<usize>> {
        match &self.animation {
            Some(name) => {
                let known: Vec<&str> = scene.animations.iter().map(|a| a.name.as_str()).collect();
                scene.find_animation(name).map(Some).ok_or_else(|| {
                    let fix = if known.is_empty() {
                        "the scene has no animations".to_owned()
                    } else {
                        format!("choose from {}", known.join(", "))
                    };
                    Error::input("--animation", format!("'{name}' is not an animation of the scene"), fix)
                })
            }
            None if self.animate && scene.animations.is_empty() => {
                Err(Error::file(file, "has no animation to play", "leave out --animate or use --turntable"))
            }
            None => Ok(self.animate.then_some(0)),
        }
    }
}

/// Camera, light and background.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub struct StagingArgs {
    /// Camera of the file to look through, by the name of its node, by its own or by number from 0 [default: the first,
    /// unless one of the options of the default camera is given].
    #[arg(long, value_name = "NAME", conflicts_with_all = ["azimuth", "elevation", "distance", "target", "fov"])]
    pub camera: Option<String>,
    /// Degrees by which the default camera and turntables are turned to the right around the scene [default: 0].
    #[arg(long, value_name = "DEGREES", value_parser = finite, allow_negative_numbers = true)]
    pub azimuth: Option<f32>,
    /// Height of the default camera and turntables above the horizon in degrees, below 90 [default: 16].
    #[arg(long, value_name = "DEGREES", value_parser = finite, allow_negative_numbers = true)]
    pub elevation: Option<f32>,
    /// Distance of the default camera and turntables, as a factor on the distance from which the scene fills the
    /// picture, from 0.1 to 100 [default: 1].
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    pub distance: Option<f32>,
    /// Point that the default camera and turntables look at, in the scene's units [default: the middle of the scene].
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub target: Option<Vec3>,
    /// Vertical field of view of the default camera and turntables in degrees, from 1 to 150 [default: 34.4].
    #[arg(long, value_name = "DEGREES", value_parser = field_of_view)]
    pub fov: Option<f32>,
    /// Direction of the sun: degrees to the right of the camera as it stands before anything moves, from -360 to 360 (0
    /// is behind it), and above the horizon, from -90 to 90 [default: the sun of the file, or -60,40].
    #[arg(long, value_name = "AZIMUTH,ELEVATION", value_parser = light, allow_hyphen_values = true)]
    pub light: Option<Direction>,
    /// Brightness of the scene in stops, from -16 to 16. EXR files keep the scene's own brightness unless they are tone-mapped.
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, value_parser = stops, allow_negative_numbers = true)]
    pub exposure: f32,
    /// Background of the scene: sky, transparent, a colour #rrggbb that is shown as it is, or an equirectangular
    /// picture of the surroundings (Radiance HDR or EXR), which lights the scene, too.
    #[arg(long, value_name = "sky|transparent|#rrggbb|FILE", default_value = "sky")]
    pub background: Behind,
    /// Lets the scene cast its shadow on an invisible ground at its lowest point [default: if it has neither a floor nor
    /// lights of its own].
    #[arg(long, overrides_with = "no_ground")]
    pub ground: bool,
    /// Lets the scene cast no shadow on an invisible ground.
    #[arg(long, overrides_with = "ground")]
    pub no_ground: bool,
}

/// Background of the scene, as it is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Behind {
    /// The sky that lights it.
    #[default]
    Sky,
    /// Nothing.
    Transparent,
    /// A colour in linear light.
    Color(Vec3),
    /// A picture of the surroundings.
    File(PathBuf),
}

impl Behind {
    /// The word for it.
    fn word(&self) -> String {
        match self {
            Self::Sky => "sky".to_owned(),
            Self::Transparent => "transparent".to_owned(),
            Self::Color(color) => {
                let [r, g, b] = color.to_array().map(|v| (srgb_encode(v) * 255.0).round() as u8);
                format!("#{r:02x}{g:02x}{b:02x}")
            }
            Self::File(path) => path.to_string_lossy().into_owned(),
        }
    }
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
        if text.starts_with('#') {
            // What is behind the scene has nothing behind it.
            let [rgb @ .., alpha] = preset::color(text).ok_or(refusal)?;
            return if alpha == 1.0 { Ok(Self::Color(rgb.map(srgb_decode).into())) } else { Err(refusal) };
        }
        let path = PathBuf::from(text);
        let extension = path.extension().unwrap_or_default();
        let is_known = ["hdr", "exr"].iter().any(|known| extension.eq_ignore_ascii_case(known));
        if is_known { Ok(Self::File(path)) } else { Err(refusal) }
    }
}

impl StagingArgs {
    /// The options as they are written, without those that say the usual.
    pub fn words(&self) -> Vec<String> {
        words::<Self>(|id| match id {
            "camera" => self.camera.clone(),
            "azimuth" => self.azimuth.map(|v| format!("{v:.3}")),
            "elevation" => self.elevation.map(|v| format!("{v:.3}")),
            "distance" => self.distance.map(|v| format!("{v:.4}")),
            "target" => self.target.map(|Vec3 { x, y, z }| format!("{x},{y},{z}")),
            "fov" => self.fov.map(|v| v.to_string()),
            "light" => self
                .light
                .map(|sun| format!("{:.2},{:.2}", sun.azimuth.to_degrees(), sun.elevation.to_degrees())),
            "exposure" => (self.exposure != 0.0).then(|| format!("{:.3}", self.exposure)),
            "background" => (self.background != Behind::Sky).then(|| self.background.word()),
            "ground" => flag(self.ground),
            "no_ground" => flag(self.no_ground),
            _ => None,
        })
    }

    /// Framing of the scene by the default camera and by turntables.
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
    pub fn find_camera(&self, scene: &Scene) -> Result<Option<usize>> {
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

    /// Background of the scene, read from its file where it has one.
    ///
    /// # Errors
    /// [`Error::Input`] for a picture that cannot be read or does not show all directions.
    pub fn read_background(&self) -> Result<Background> {
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

    /// True where the scene casts its shadow on an invisible ground.
    pub fn has_ground(&self, scene: &Scene) -> bool {
        self.ground || !self.no_ground && floor::lacks_floor(scene)
    }
}

type Read<T> = std::result::Result<T, String>;

/// A number within bounds, or what to write.
fn number(text: &str, bounds: std::ops::RangeInclusive<f32>, what: &str) -> Read<f32> {
    let number = text.trim().parse().ok().filter(|number| bounds.contains(number));
    number.ok_or_else(|| format!("write {what} from {} to {}", bounds.start(), bounds.end()))
}

fn finite(text: &str) -> Read<f32> {
    number(text, -1e6..=1e6, "degrees")
}

fn factor(text: &str) -> Read<f32> {
    number(text, 0.1..=100.0, "a factor")
}

fn field_of_view(text: &str) -> Read<f32> {
    number(text, 1.0..=150.0, "degrees")
}

fn stops(text: &str) -> Read<f32> {
    number(text, -16.0..=16.0, "stops")
}

fn point(text: &str) -> Read<Vec3> {
    let parts: Vec<f32> =
        text.split(',').map(|part| number(part, -1e9..=1e9, "a coordinate")).collect::<Read<_>>()?;
    <[f32; 3]>::try_from(parts).map(Vec3::from).map_err(|_| "write three coordinates such as 0,1.5,0".into())
}

fn light(text: &str) -> Read<Direction> {
    let (azimuth, elevation) = text.split_once(',').ok_or("write azimuth and elevation such as -60,40")?;
    Ok(Direction {
        azimuth: number(azimuth, -360.0..=360.0, "an azimuth in degrees")?.to_radians(),
        elevation: number(elevation, -90.0..=90.0, "an elevation in degrees")?.to_radians(),
    })
}

#[cfg(test)]
mod tests {
    use clap::Command;

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

    /// Options that a command line gives.
    #[derive(Debug, clap::Parser)]
    struct Parsed {
        #[command(flatten)]
        reading: ReadingArgs,
        #[command(flatten)]
        motion: MotionArgs,
        #[command(flatten)]
        staging: StagingArgs,
    }

    fn parsed(words: Vec<String>) -> Parsed {
        clap::Parser::try_parse_from(["scene".to_owned()].into_iter().chain(words)).unwrap()
    }

    /// Options of a kind, as long names.
    fn declared<A: Args>() -> Vec<String> {
        let command = A::augment_args(Command::new("options"));
        command.get_arguments().filter_map(|option| Some(format!("--{}", option.get_long()?))).collect()
    }

    #[test]
    fn every_option_is_written_as_it_is_read() {
        let reading = ReadingArgs { texture: Some("a b.png".into()), up: Up::Z };
        let motion = MotionArgs { animate: true, animation: Some("Run".into()), start: -1.5 };
        let framed = StagingArgs {
            azimuth: Some(-12.5),
            elevation: Some(20.25),
            distance: Some(1.5),
            target: Some(Vec3::new(-1.0, 2.5, 3.0)),
            fov: Some(40.0),
            light: Some(light("-90,30").unwrap()),
            exposure: -1.25,
            background: "#204060".parse().unwrap(),
            ground: true,
            ..StagingArgs::default()
        };
        let seen = StagingArgs { camera: Some("2".into()), no_ground: true, ..StagingArgs::default() };
        let words = [reading.words(), motion.words()].concat();
        let missing: Vec<String> = [declared::<ReadingArgs>(), declared::<MotionArgs>()]
            .concat()
            .into_iter()
            .filter(|name| !words.contains(name))
            .collect();
        assert!(missing.is_empty(), "{missing:?} are never written");
        let both = [framed.words(), seen.words()].concat();
        let missing: Vec<String> =
            declared::<StagingArgs>().into_iter().filter(|name| !both.contains(name)).collect();
        assert!(missing.is_empty(), "{missing:?} are never written");
        let again = parsed([words, framed.words()].concat());
        assert_eq!((again.reading, again.motion), (reading, motion));
        assert_eq!(again.staging.words(), framed.words());
        assert_eq!(parsed(seen.words()).staging, seen);
        for background in ["transparent", "sky", "a/b.HDR"] {
            let staging = StagingArgs { background: background.parse().unwrap(), ..StagingArgs::default() };
            assert_eq!(parsed(staging.words()).staging, staging);
        }
    }

    #[test]
    fn the_usual_is_not_written() {
        let Parsed { reading, motion, staging } = parsed(Vec::new());
        assert_eq!(
            (&reading, &motion, &staging),
            (&ReadingArgs::default(), &MotionArgs::default(), &StagingArgs::default())
        );
        assert!([reading.words(), motion.words(), staging.words()].concat().is_empty());
    }
}
