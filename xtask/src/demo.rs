//! `cargo xtask demo`: the demo scene plain, as cartoon, as blueprint and as flow visualisation;
//! a turntable of each and one contact sheet of all.

use crate::error::{Context, Result};
use crate::setup::{self, VULKAN};
use crate::tools::{cargo, heading, host, root, run as run_command};
use image::imageops::{FilterType, overlay, resize};
use image::{Rgb, RgbImage};
use std::path::{Path, PathBuf};

/// Options of `cargo xtask demo`.
#[derive(clap::Args)]
pub struct Options {
    /// Where the pictures go
    #[arg(long, default_value = "target/demo")]
    out: PathBuf,
    /// Frames of each turntable
    #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..=1000))]
    frames: u32,
}

const PANEL: (u32, u32) = (960, 540);
const TURNTABLE: (u32, u32) = (640, 360);
const THUMBNAIL: (u32, u32) = (160, 90);
const THUMBNAILS_PER_ROW: u32 = 12;

/// Name of the pictures, and what `--style` says.
const STYLES: [(&str, &str); 4] = [
    ("plain", "none"),
    ("cartoon", "cartoon"),
    ("blueprint", "blueprint"),
    ("flow", "host-example/graphs/flow.json"),
];

/// Builds, renders and says where the pictures are.
///
/// # Errors
/// The first step that fails.
pub fn run(options: &Options) -> Result<()> {
    setup::ensure(&[&VULKAN])?;
    heading("build");
    cargo(&["build", "--workspace", "--lib", "--bins"])?;
    let out = root().join(&options.out);
    let scene = out.join("scene");
    crate::scene::run(&crate::scene::Options { out: scene.clone() })?;
    let file = scene.join("city.gltf");

    let mut panels = Vec::new();
    let mut turntables = Vec::new();
    for (name, style) in STYLES {
        heading(name);
        let panel = out.join(format!("{name}.png"));
        render(&file, &panel, style, PANEL, &[])?;
        panels.push(panel);
        let pattern = out.join("turntable").join(format!("{name}.####.png"));
        let frames = options.frames.to_string();
        render(&file, &pattern, style, TURNTABLE, &["--frames", &frames, "--turntable"])?;
        turntables
            .extend((1..=options.frames).map(|i| out.join("turntable").join(format!("{name}.{i:04}.png"))));
    }

    let sheet = out.join("contact-sheet.png");
    contact_sheet(&panels, turntables.into_iter(), options.frames)?
        .save(&sheet)
        .context(|| format!("cannot write {}", sheet.display()))?;
    println!("\nthe pictures are in {}\nall of them on one sheet: {}", out.display(), sheet.display());
    Ok(())
}

fn render(scene: &Path, out: &Path, style: &str, size: (u32, u32), more: &[&str]) -> Result<()> {
    if let Some(folder) = out.parent() {
        std::fs::create_dir_all(folder).context(|| format!("cannot create {}", folder.display()))?;
    }
    let mut command = host("debug");
    command.current_dir(root()).arg("render").arg(scene).arg(out);
    command.args(["--style", style, "--size", &format!("{}x{}", size.0, size.1)]).args(more);
    run_command(&mut command)
}

fn contact_sheet(panels: &[PathBuf], frames: impl Iterator<Item = PathBuf>, count: u32) -> Result<RgbImage> {
    let rows = count.div_ceil(THUMBNAILS_PER_ROW);
    let panel_rows = (panels.len() as u32).div_ceil(2);
    let width = (2 * PANEL.0).max(THUMBNAILS_PER_ROW * THUMBNAIL.0);
    let top = panel_rows * PANEL.1;
    let height = top + rows * THUMBNAIL.1 * panels.len() as u32;
    let mut sheet = RgbImage::from_pixel(width, height, Rgb([255; 3]));
    let open = |path: &Path| {
        image::open(path).map(|i| i.to_rgb8()).context(|| format!("cannot read {}", path.display()))
    };
    for (i, path) in panels.iter().enumerate() {
        let i = i as u32;
        overlay(&mut sheet, &open(path)?, i64::from(i % 2 * PANEL.0), i64::from(i / 2 * PANEL.1));
    }
    for (i, path) in frames.enumerate() {
        let (style, frame) = (i as u32 / count, i as u32 % count);
        let thumbnail = resize(&open(&path)?, THUMBNAIL.0, THUMBNAIL.1, FilterType::Triangle);
        let row = style * rows + frame / THUMBNAILS_PER_ROW;
        let (x, y) = (frame % THUMBNAILS_PER_ROW * THUMBNAIL.0, top + row * THUMBNAIL.1);
        overlay(&mut sheet, &thumbnail, i64::from(x), i64::from(y));
    }
    Ok(sheet)
}
