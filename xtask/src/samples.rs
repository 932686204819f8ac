//! `cargo xtask samples`: the pictures that come with the host, to try looks on: views of the demo scene, plain.

use crate::error::{Context, Result};
use crate::scene;
use crate::setup::{self, VULKAN};
use crate::tools::{build_with_host, heading, host, root, run as run_command, target_dir};
use std::path::PathBuf;

/// Options of `cargo xtask samples`.
#[derive(clap::Args)]
pub struct Options {
    /// Folder that the pictures go to
    #[arg(long, default_value = "host-example/window/samples")]
    out: PathBuf,
}

const SIZE: &str = "960x640";

/// Name of each picture, and where its camera and its sun stand.
const VIEWS: [(&str, &[&str]); 3] = [
    ("statue", &["--azimuth", "-40", "--elevation", "5", "--distance", "0.12", "--target", "-8.2,1.6,8"]),
    ("fountain", &["--azimuth", "-30", "--elevation", "14", "--distance", "0.1", "--target", "9,1.3,14"]),
    ("roofs", &["--azimuth", "25", "--elevation", "30", "--distance", "0.8", "--light", "60,20"]),
];

/// Builds, renders and says where the pictures are.
///
/// # Errors
/// The first step that fails.
pub fn run(options: &Options) -> Result<()> {
    setup::ensure(&[&VULKAN])?;
    heading("build");
    build_with_host("debug", &[scene::PACKAGE])?;
    let (work, out) = (target_dir("samples"), root().join(&options.out));
    std::fs::create_dir_all(&out).context(|| format!("cannot create {}", out.display()))?;
    heading("pictures");
    let city = scene::write(&work.join("scene"))?;
    for (name, view) in VIEWS {
        let (whole, small) = (work.join(format!("{name}.png")), out.join(format!("{name}.jpg")));
        let mut render = host("debug");
        render.args(["render", "--force"]).arg(&city).arg(&whole).args(["--size", SIZE]).args(view);
        run_command(&mut render)?;
        // Of a node that takes no part in the result, apply writes the picture itself, as JPEG.
        let apply = ["apply", "--force", "gaussian", "--set", "mix=0"];
        run_command(host("debug").args(apply).arg(whole).arg(&small))?;
        println!("{}", small.display());
    }
    Ok(())
}
