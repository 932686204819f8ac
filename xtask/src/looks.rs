//! `cargo xtask looks`: every look that ships with the host, on the demo scene and on pictures, as one sheet.

use crate::error::{Context, Failure, Result};
use crate::scene;
use crate::setup::{self, VULKAN};
use crate::tools::{build_with_host, heading, host, root, run as run_command};
use std::path::{Path, PathBuf};

/// Options of `cargo xtask looks`.
#[derive(clap::Args)]
pub struct Options {
    /// Pictures beside the demo scene, of its shape: 3 to 2
    pictures: Vec<PathBuf>,
    /// Folder that the pictures go to
    #[arg(long, default_value = "target/looks")]
    out: PathBuf,
}

/// Size of the scene's picture. Lengths are its pixels: as small as thumbnails are, marks that keep to the
/// picture's height would not be seen.
const SIZE: &str = "720x480";
/// Width of a picture on the sheet.
const THUMBNAIL: &str = "170";
/// Most pictures in a row of the sheet.
const COLUMNS: usize = 10;

/// Builds, stylizes and says where the sheet is.
///
/// # Errors
/// The first step that fails.
pub fn run(options: &Options) -> Result<()> {
    setup::ensure(&[&VULKAN])?;
    heading("build");
    build_with_host("debug", &[scene::PACKAGE])?;
    let out = root().join(&options.out);
    std::fs::create_dir_all(&out).context(|| format!("cannot create {}", out.display()))?;
    heading("scene");
    let frame = out.join("scene.exr");
    let city = scene::write(&out.join("scene"))?;
    run_command(host("debug").args(["render", "--force", "--size", SIZE]).arg(city).arg(&frame))?;

    heading("looks");
    let looks = list()?;
    let sources: Vec<&Path> =
        std::iter::once(frame.as_path()).chain(options.pictures.iter().map(PathBuf::as_path)).collect();
    let mut sheet = host("debug");
    sheet.args(["sheet", "--force", "--width", THUMBNAIL]).arg(out.join("looks.png"));
    sheet.args(["--columns", &(COLUMNS / sources.len() * sources.len()).max(1).to_string()]);
    for (look, name) in &looks {
        for (number, source) in sources.iter().enumerate() {
            let result = out.join(format!("{}.{number}.png", look.trim_start_matches("look:")));
            let mut apply = host("debug");
            apply.args(["apply", "--force", look]).arg(source).arg(&result);
            run_command(apply.args(["--lengths", "pixels", "--backend", "cpu"]))?;
            sheet.arg(result).args(["--label", if number == 0 { name } else { " " }]);
        }
        println!("{name}");
    }
    run_command(&mut sheet)?;
    println!("{}", out.join("looks.png").display());
    Ok(())
}

/// The looks as they take the place of styles, with their names.
fn list() -> Result<Vec<(String, String)>> {
    let mut command = host("debug");
    let output = command.args(["preset", "list"]).output().context(|| "the host cannot be started".into())?;
    let text = String::from_utf8_lossy(&output.stdout);
    let looks: Vec<(String, String)> = text
        .lines()
        .filter_map(|line| {
            let mut columns = line.split("  ").map(str::trim).filter(|column| !column.is_empty());
            let look = columns.next().filter(|look| look.starts_with("look:"))?;
            Some((look.to_owned(), columns.next()?.to_owned()))
        })
        .collect();
    if looks.is_empty() {
        return Err(Failure("the host lists no looks".into()));
    }
    Ok(looks)
}
