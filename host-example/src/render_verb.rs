//! `isophote render`: a scene to a sequence of pictures.

use std::f32::consts::TAU;
use std::fs;
use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::RenderArgs;
use crate::error::{Error, Result};
use crate::loader::Library;
use crate::output::{self, Precision};
use crate::render::Renderer;
use crate::render::gpu::Gpu;
use crate::render::look::Look;
use crate::render::readback::Readback;
use crate::render::targets::Target;
use crate::scene::Scene;
use crate::scene::camera::{self, Direction, Orbit, View};
use crate::scene::pose::Pose;
use crate::stylize::Stylizer;
use crate::stylize::style::Style;

/// Runs the verb.
///
/// # Errors
/// [`Error::Input`] for bad input before anything is rendered, [`Error::Failure`] when the device fails.
pub fn run(args: &RenderArgs) -> Result<()> {
    output::check_extension(&args.out)?;
    output::check_writable(&args.out)?;
    let library = (args.style != "none").then(Library::open).transpose()?;
    let style = library.as_ref().map(|l| Style::load(l, &args.style, &args.set)).transpose()?;
    if let (None, Some(setting)) = (&style, args.set.first()) {
        return Err(Error::input(
            format!("--set {setting}"),
            "the style none has no parameters",
            "choose a style with --style",
        ));
    }
    if !args.fps.is_finite() || args.fps <= 0.0 || !args.start.is_finite() {
        return Err(Error::input(
            "--fps, --start",
            "must be finite, and frames per second above 0",
            "use 24 and 0",
        ));
    }
    if !args.azimuth.is_finite() || !args.elevation.is_finite() {
        return Err(Error::input("--azimuth, --elevation", "must be finite", "give angles in degrees"));
    }
    let scene = Scene::load(&args.scene, args.texture.as_deref())?;
    for warning in &scene.warnings {
        eprintln!("warning: {}: {warning}", args.scene.display());
    }
    let animation = choose_animation(args, &scene)?;
    let gpu = Gpu::open()?;
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, &scene, args.size)?;
    gpu.check()?;
    let mut stylizer = match (&library, style) {
        (Some(library), Some(style)) => {
            let device = isophote_engine::gpu::Device::wrap(gpu.device.clone(), gpu.queue.clone());
            Some(Stylizer::new(&device, library, style, args.size)?)
        }
        _ => None,
    };
    if let Some(stylizer) = &mut stylizer {
        stylizer.bind(renderer.targets())?;
    }
    if let Some(folder) = &args.aov {
        fs::create_dir_all(folder)
            .map_err(|e| Error::file(folder, format!("cannot be made: {e}"), "name a writable folder"))?;
    }
    let camera = Camera::choose(args, &scene);
    let mut pose = Pose::at_rest(&scene);
    let look = Look::for_scene(&scene, &pose);
    let mut readback = Readback::default();
    let count = args.frames as usize;
    let bar = progress_bar(count);
    for frame in 0..count {
        pose.update(&scene, animation, args.start + frame as f32 / args.fps);
        let view = camera.view(&scene, &pose, frame as f32 / count as f32);
        if let Some(stylizer) = &mut stylizer {
            stylizer.at_frame(frame as i64 + 1)?;
            if stylizer.update()? {
                stylizer.bind(renderer.targets())?;
            }
        }
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        renderer.encode(&mut encoder, &scene, &pose, &view, &look);
        if let Some(stylizer) = &stylizer {
            stylizer.encode(&mut encoder)?;
        }
        gpu.queue.submit([encoder.finish()]);
        let result = stylizer.as_ref().map_or(&renderer.targets().color.view, Stylizer::output);
        let picture = readback.read(&gpu, result.texture())?;
        output::save(&output::frame_path(&args.out, frame + 1, count), &picture)?;
        if let Some(folder) = &args.aov {
            save_aovs(&gpu, &mut readback, &renderer, folder, frame + 1)?;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(())
}

fn choose_animation(args: &RenderArgs, scene: &Scene) -> Result<Option<usize>> {
    match &args.animation {
        Some(name) => {
            let known: Vec<&str> = scene.animations.iter().map(|a| a.name.as_str()).collect();
            scene.find_animation(name).map(Some).ok_or_else(|| {
                let mend = if known.is_empty() {
                    "the scene has no animations".to_owned()
                } else {
                    format!("choose from {}", known.join(", "))
                };
                Error::input("--animation", format!("'{name}' is not an animation of the scene"), mend)
            })
        }
        None if args.animate && scene.animations.is_empty() => Err(Error::file(
            &args.scene,
            "has no animation to play",
            "leave out --animate or use --turntable",
        )),
        None => Ok(args.animate.then_some(0)),
    }
}

/// Where the pictures are taken from.
enum Camera {
    File(usize, Orbit),
    Framing(Orbit),
    Turntable(Orbit),
}

impl Camera {
    fn choose(args: &RenderArgs, scene: &Scene) -> Self {
        let aspect = args.size.0 as f32 / args.size.1 as f32;
        let direction = Direction {
            azimuth: Direction::default().azimuth + args.azimuth.to_radians(),
            elevation: args.elevation.to_radians(),
        };
        match camera::file_camera(scene) {
            _ if args.turntable => Self::Turntable(Orbit::turntable(scene, aspect, direction)),
            Some(node) => Self::File(node, Orbit::framing(scene, aspect, direction)),
            None => Self::Framing(Orbit::framing(scene, aspect, direction)),
        }
    }

    /// The view at a share of the sequence in [0, 1).
    fn view(&self, scene: &Scene, pose: &Pose, share: f32) -> View {
        match self {
            Self::File(node, fallback) => {
                View::from_node(scene, pose, *node).unwrap_or_else(|| fallback.view())
            }
            Self::Framing(orbit) => orbit.view(),
            Self::Turntable(orbit) => orbit.turned(share * TAU).view(),
        }
    }
}

fn save_aovs(
    gpu: &Gpu,
    readback: &mut Readback,
    renderer: &Renderer,
    folder: &Path,
    number: usize,
) -> Result<()> {
    let targets = renderer.targets();
    let layers: [(&str, &Target, &[&str], Precision); 4] = [
        ("normal", &targets.normal, &["N.X", "N.Y", "N.Z"], Precision::Half),
        ("depth", &targets.depth, &["Z"], Precision::Float),
        ("object_id", &targets.object_id, &["id"], Precision::Float),
        ("motion", &targets.motion, &["motion.X", "motion.Y"], Precision::Float),
    ];
    for (name, target, channels, precision) in layers {
        let picture = readback.read(gpu, &target.texture)?;
        output::save_exr(&folder.join(format!("{name}.{number:04}.exr")), &picture, channels, precision)?;
    }
    Ok(())
}

/// A bar on standard error, for sequences only, and none where no terminal listens.
fn progress_bar(count: usize) -> ProgressBar {
    if count < 2 {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(count as u64);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} frame {pos} of {len}, {eta} left") {
        bar.set_style(style);
    }
    bar
}
