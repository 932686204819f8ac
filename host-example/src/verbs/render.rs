//! `isophote render`: a scene to a sequence of pictures.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::shared::{SceneArgs, parse_size};
use crate::error::{Error, Result};
use crate::frames::Pattern;
use crate::loader::Library;
use crate::output::{self, Precision};
use crate::render::targets::{Target, Targets};
use crate::scene::Scene;
use crate::scene::camera::Direction;
use crate::shot::{Options, Shot};
use crate::stylize::style::{Setting, Style};

/// Options of `render`.
#[derive(Args, Debug)]
pub struct RenderArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The picture: .png or .exr; with several frames, #### or an added .0001 stands for the number.
    out: PathBuf,
    /// Size of the picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse_size)]
    size: (u32, u32),
    /// Number of frames.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: u32,
    /// Turns the camera once around the scene over all frames.
    #[arg(long)]
    turntable: bool,
    /// Plays the file's animation, in a loop.
    #[arg(long)]
    animate: bool,
    /// Which animation plays, by name or by number from 0; the first if not given.
    #[arg(long, value_name = "NAME")]
    animation: Option<String>,
    /// Time of the first frame of the animation in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, allow_negative_numbers = true)]
    start: f32,
    /// Frames per second of the animation.
    #[arg(long, value_name = "N", default_value_t = 24.0)]
    fps: f32,
    /// Degrees by which the default camera and turntables are turned to the right around the scene.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_negative_numbers = true)]
    azimuth: f32,
    /// Height of the default camera and turntables above the horizon in degrees, below 90.
    #[arg(long, value_name = "DEGREES", default_value_t = 16.0, allow_negative_numbers = true)]
    elevation: f32,
    /// Also writes normal, depth, object_id and motion of each frame as EXR into this folder.
    #[arg(long, value_name = "DIR")]
    aov: Option<PathBuf>,
    /// How frames are stylized: none, the id of a node, or a graph file or preset (.json).
    #[arg(long, default_value = "none")]
    style: String,
    /// Sets a parameter of the style; node.id=value for one node of a graph. May be repeated.
    #[arg(long, value_name = "ID=VALUE")]
    set: Vec<Setting>,
}

/// Runs the verb.
///
/// # Errors
/// [`Error::Input`] for bad input before anything is rendered, [`Error::Failure`] when the device fails.
pub fn run(args: &RenderArgs) -> Result<()> {
    args.check()?;
    let library = (args.style != "none").then(Library::open).transpose()?;
    let style = match &library {
        Some(library) => Some((library, Style::load(library, &args.style, &args.set)?)),
        None => None,
    };
    let scene = args.scene.load()?;
    let options = args.options(&scene)?;
    let mut shot = Shot::new(scene, style, options)?;
    if let Some(folder) = &args.aov {
        fs::create_dir_all(folder)
            .map_err(|e| Error::file(folder, format!("cannot be made: {e}"), "name a writable folder"))?;
    }
    let pattern = match Pattern::new(&args.out)? {
        None if args.frames == 1 => None,
        _ => Some(Pattern::or_added(&args.out)?),
    };
    let bar = progress_bar(args.frames);
    for frame in 0..args.frames {
        let number = i64::from(frame) + 1;
        let picture = shot.draw(frame as usize)?;
        let file = pattern.as_ref().map_or_else(|| args.out.clone(), |pattern| pattern.file(number));
        output::save(&file, &picture)?;
        if let Some(folder) = &args.aov {
            save_aovs(&mut shot, folder, number)?;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(())
}

impl RenderArgs {
    /// Refuses what can be refused without a library, a scene or a device.
    fn check(&self) -> Result<()> {
        output::check_extension(&self.out)?;
        output::check_writable(&self.out)?;
        if let (true, Some(setting)) = (self.style == "none", self.set.first()) {
            return Err(Error::input(
                format!("--set {setting}"),
                "the style none has no parameters",
                "choose a style with --style",
            ));
        }
        if !self.fps.is_finite() || self.fps <= 0.0 || !self.start.is_finite() {
            return Err(Error::input(
                "--fps, --start",
                "must be finite, and frames per second above 0",
                "use 24 and 0",
            ));
        }
        if !self.azimuth.is_finite() || !self.elevation.is_finite() {
            return Err(Error::input("--azimuth, --elevation", "must be finite", "give angles in degrees"));
        }
        Ok(())
    }

    fn options(&self, scene: &Scene) -> Result<Options> {
        Ok(Options {
            size: self.size,
            frames: self.frames as usize,
            turntable: self.turntable,
            direction: Direction {
                azimuth: Direction::default().azimuth + self.azimuth.to_radians(),
                elevation: self.elevation.to_radians(),
            },
            animation: choose_animation(self, scene)?,
            start: self.start,
            fps: self.fps,
        })
    }
}

fn choose_animation(args: &RenderArgs, scene: &Scene) -> Result<Option<usize>> {
    match &args.animation {
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
        None if args.animate && scene.animations.is_empty() => Err(Error::file(
            &args.scene.scene,
            "has no animation to play",
            "leave out --animate or use --turntable",
        )),
        None => Ok(args.animate.then_some(0)),
    }
}

/// What the renderer knows of a pixel besides its colour: name of the file, target, channels, precision.
type Aov = (&'static str, fn(&Targets) -> &Target, &'static [&'static str], Precision);

const AOVS: [Aov; 4] = [
    ("normal", |targets| &targets.normal, &["N.X", "N.Y", "N.Z"], Precision::Half),
    ("depth", |targets| &targets.depth, &["Z"], Precision::Float),
    ("object_id", |targets| &targets.object_id, &["id"], Precision::Float),
    ("motion", |targets| &targets.motion, &["motion.X", "motion.Y"], Precision::Float),
];

fn save_aovs(shot: &mut Shot, folder: &Path, number: i64) -> Result<()> {
    for (name, target, channels, precision) in AOVS {
        let picture = shot.read(target)?;
        output::save_exr(&folder.join(format!("{name}.{number:04}.exr")), &picture, channels, precision)?;
    }
    Ok(())
}

/// A bar on standard error, for sequences only, and none where no terminal listens.
fn progress_bar(count: u32) -> ProgressBar {
    if count < 2 {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(count.into());
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} frame {pos} of {len}, {eta} left") {
        bar.set_style(style);
    }
    bar
}
