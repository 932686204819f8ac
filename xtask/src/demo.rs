//! `cargo xtask demo`: the demo scene plain, as cartoon, as blueprint and as flow visualisation; then a
//! turntable of each, and one contact sheet of all.

use crate::error::{Context, Result};
use crate::scene;
use crate::setup::{self, VULKAN};
use crate::tools::{build_with_host, heading, host, root, run as run_command};
use std::path::{Path, PathBuf};

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
    build_with_host("debug", &[scene::PACKAGE])?;
    let out = root().join(&options.out);
    heading("scene");
    let scene = scene::write(&out.join("scene"))?;

    heading("panels");
    let panels = STYLES.map(|(name, _)| out.join(format!("{name}.png")));
    for (panel, (_, style)) in panels.iter().zip(STYLES) {
        render(&scene, panel, style, PANEL, &[])?;
        println!("{}", panel.display());
    }

    heading("turntables");
    let turntable = out.join("turntable");
    std::fs::create_dir_all(&turntable).context(|| format!("cannot create {}", turntable.display()))?;
    let frames = options.frames.to_string();
    for (name, style) in STYLES {
        let pattern = turntable.join(format!("{name}.####.png"));
        render(&scene, &pattern, style, TURNTABLE, &["--frames", &frames, "--turntable"])?;
        println!("{}", pattern.display());
    }

    heading("contact sheet");
    let sheet = out.join("contact-sheet.png");
    let columns = STYLES.len().to_string();
    // A column for each style: the panels above, the frames of the turntables below them.
    let pictures = (1..=options.frames)
        .flat_map(|frame| STYLES.map(|(name, _)| turntable.join(format!("{name}.{frame:04}.png"))));
    let mut command = host("debug");
    command.args(["sheet", "--force"]).arg(&sheet).args(&panels).args(pictures);
    run_command(command.args(["--columns", &columns, "--width", THUMBNAIL]))?;
    println!("{}", sheet.display());
    Ok(())
}

fn render(scene: &Path, out: &Path, style: &str, size: &str, more: &[&str]) -> Result<()> {
    let mut command = host("debug");
    command.current_dir(root()).args(["render", "--force"]).arg(scene).arg(out);
    run_command(command.args(["--style", style, "--size", size]).args(more))
}
