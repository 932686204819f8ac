//! `cargo xtask demo`: the demo scene plain, as cartoon, as blueprint and as flow visualisation; then a
//! turntable of each, and one contact sheet of all.

use crate::error::{Context, Result};
use crate::scene;
use crate::setup::{self, VULKAN};
use crate::tools::{build, built_library, heading, program, root, run as run_command};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// Options of `cargo xtask demo`.
#[derive(clap::Args)]
pub struct Options {
    /// Folder that the pictures go to
    #[arg(long, default_value = "target/demo")]
    out: PathBuf,
    /// Frames of each turntable
    #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..=1000))]
    frames: u32,
}

/// The example, which draws all frames: the window and what it needs are not compiled.
const EXAMPLE: &str = "isophote-example";
/// The program that makes the contact sheet.
const SHEET: &str = "isophote-demo-sheet";

const PANEL: &str = "960x540";
const TURNTABLE: &str = "640x360";
/// Width of a picture on the contact sheet.
const THUMBNAIL: &str = "320";

/// Name of the pictures, and what `--style` says.
const STYLES: [(&str, &str); 4] = [
    ("plain", "none"),
    ("cartoon", "cartoon"),
    ("blueprint", "blueprint"),
    ("flow", "host-example/graphs/flow.json"),
];

/// Builds, renders and says where the pictures are, each as soon as it is there.
///
/// # Errors
/// The first step that fails.
pub fn run(options: &Options) -> Result<()> {
    setup::ensure(&[&VULKAN])?;
    heading("build");
    // The library comes along with the program of the sheet, which depends on it.
    build("debug", &[EXAMPLE, scene::PACKAGE, SHEET])?;
    let out = root().join(&options.out);
    heading("scene");
    let scene = scene::write(&out.join("scene"))?;

    heading("panels");
    let panels = STYLES.map(|(name, _)| out.join(format!("{name}.png")));
    for (panel, (_, style)) in panels.iter().zip(STYLES) {
        frames(&scene, style, PANEL, 1, |_| panel.clone())?;
        println!("{}", panel.display());
    }

    heading("turntables");
    let turntable = out.join("turntable");
    fs::create_dir_all(&turntable).context(|| format!("cannot create {}", turntable.display()))?;
    let turned = |name: &str, frame: u32| turntable.join(format!("{name}.{frame:04}.png"));
    for (name, style) in STYLES {
        frames(&scene, style, TURNTABLE, options.frames, |frame| turned(name, frame))?;
        println!("{}", turntable.join(format!("{name}.####.png")).display());
    }

    heading("contact sheet");
    let sheet = out.join("contact-sheet.png");
    let columns = STYLES.len().to_string();
    // A column for each style: the panels above, the frames of the turntables below them.
    let pictures = (1..=options.frames).flat_map(|frame| STYLES.map(|(name, _)| turned(name, frame)));
    let mut command = program(SHEET, "debug");
    command.arg(&sheet).args(&panels).args(pictures);
    run_command(command.args(["--columns", &columns, "--width", THUMBNAIL]))?;
    println!("{}", sheet.display());
    Ok(())
}

/// Lets the example write frames of a style, and gives each the name that `place` has for its number.
fn frames(scene: &Path, style: &str, size: &str, count: u32, place: impl Fn(u32) -> PathBuf) -> Result<()> {
    let folder = scene.with_file_name("frames");
    let mut command = program(EXAMPLE, "debug");
    command.env("ISOPHOTE_LIBRARY", built_library("debug"));
    command.current_dir(root()).arg(scene).args(["--style", style, "--size", size]);
    command.args(["--count", &count.to_string(), "--frames"]).arg(&folder);
    run_command(command.stdout(Stdio::null()))?;
    for frame in 1..=count {
        let (from, to) = (folder.join(format!("frame.{frame:04}.png")), place(frame));
        fs::rename(&from, &to).context(|| format!("cannot write {}", to.display()))?;
    }
    fs::remove_dir_all(&folder).context(|| format!("cannot remove {}", folder.display()))
}
