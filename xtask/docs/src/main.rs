//! `isophote-docs`, run by `cargo xtask docs`: the documentation as a site without scripts. It renders the pages of this
//! folder and some documents of the repository, makes a page for every node and every style from their declarations,
//! with pictures of the demo scene, runs every command that stands on a page, and follows every link.

mod book;
mod error;
mod gallery;
mod glossary;
mod links;
mod looks;
mod maker;
mod markdown;
mod moving;
mod page;
mod reference;
mod scratch;
mod series;
mod shot;
mod shots;
mod studio;
mod styles;
mod template;

use book::pages;
use clap::Parser;
use error::{Error, Result};
use markdown::{APP, PICTURES, Rendered, Site, place_of_copied, place_of_made, render};
use page::Page;
use scratch::Seed;
use shot::Shot;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use studio::{Studio, finish, small};

/// Makes the documentation as a site, and runs every command that stands on it.
#[derive(Parser)]
#[command(bin_name = "cargo xtask docs")]
struct Options {
    /// Folder that the site goes to; what was there is replaced
    #[arg(long, value_name = "DIR", default_value = "target/docs")]
    out: PathBuf,
    /// Size at which pictures are made; large ones are shown smaller
    #[arg(long, value_name = "WxH", default_value = "600x400")]
    size: Size,
    /// Number of frames of moving pictures
    #[arg(long, value_name = "N", default_value_t = 24)]
    frames: u32,
    /// The page for browsers, as `cargo xtask web` makes it, to be a part of the site
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
    /// Folder of the pages that are written
    #[arg(long, value_name = "DIR", hide = true)]
    pages: Option<PathBuf>,
    #[command(flatten)]
    means: Option<Means>,
}

/// What commands and pictures are made with. Without it pages and the links between them are only checked;
/// with a part of it, what lacks is named.
#[derive(clap::Args)]
struct Means {
    /// The sample host
    #[arg(long, value_name = "FILE", hide = true, required = false)]
    host: PathBuf,
    /// The dynamic library
    #[arg(long, value_name = "FILE", hide = true, required = false)]
    library: PathBuf,
    /// The demo scene
    #[arg(long, value_name = "FILE", hide = true, required = false)]
    scene: PathBuf,
    /// Folder of the wheel and the Blender extension
    #[arg(long, value_name = "DIR", hide = true, required = false)]
    packages: PathBuf,
    /// Folder of wheels of others
    #[arg(long, value_name = "DIR", hide = true, required = false)]
    wheels: PathBuf,
    /// Folder of the Python that has Blender as a module; without it, what needs Blender is not run
    #[arg(long, value_name = "DIR", hide = true)]
    blender: Option<PathBuf>,
}

/// Width and height.
#[derive(Clone, Copy, Debug)]
struct Size(u32, u32);

impl std::str::FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let sides = text.split_once('x').and_then(|(w, h)| Some(Self(w.parse().ok()?, h.parse().ok()?)));
        sides
            .filter(|Self(w, h)| (16..=4096).contains(w) && (16..=4096).contains(h))
            .ok_or_else(|| format!("{text} is no size such as 600x400"))
    }
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("isophote-docs: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let root = root.canonicalize().map_err(Error::at(&root))?;
    let sources =
        options.pages.clone().unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("pages"));
    let out = root.join(&options.out);
    let scratch = tempfile::tempdir().map_err(Error::at(&out))?;
    // Whole before it has its name.
    let site = match options.means {
        Some(_) => out.with_extension("partial"),
        None => scratch.path().join("site"),
    };
    replace(&site)?;
    let pictures = site.join(PICTURES);
    std::fs::create_dir_all(&pictures).map_err(Error::at(&pictures))?;

    // What is wrong with pages is found before pictures are made.
    let (pages, shots) = filled_pages(&sources, &root)?;
    let around = Site { root: &root, has_app: options.page.is_some() };
    let rendered: Vec<Rendered> = pages.iter().map(|page| render(page, around)).collect::<Result<_>>()?;
    write(&site, &pages, &rendered)?;
    let Some(means) = &options.means else {
        let links = links::check(&site, &[APP, PICTURES])?;
        println!("{} pages, {} links followed", pages.len(), links.inner);
        return Ok(());
    };

    println!("commands of pages");
    let seed = Seed {
        folder: scratch.path().join("seed"),
        host: &means.host,
        scene: &means.scene,
        library: &means.library,
        root: &root,
        packages: &means.packages,
        wheels: &means.wheels,
        blender: means.blender.as_deref(),
    };
    let counts = commands(&seed, &pages, &rendered, [&root, scratch.path(), &site])?;

    println!("pictures of nodes and looks");
    photograph(options, means, &shots, scratch.path(), &pictures)?;
    add_app(options, &root, &site)?;
    let links = links::check(&site, &[])?;
    let size = size_of(&pictures)?;
    replace(&out)?;
    std::fs::rename(&site, &out).map_err(Error::at(&out))?;
    println!(
        "{} pages, pictures of {:.1} MB; {} blocks of commands run, {} are for people; {} links followed, {} lead \
         elsewhere",
        pages.len(),
        size as f64 / 1e6,
        counts.run,
        counts.by_hand,
        links.inner,
        links.outer
    );
    println!("{}", out.join("index.html").display());
    Ok(())
}

/// All pages, and the pictures that they show.
fn filled_pages(sources: &Path, root: &Path) -> Result<(Vec<Page>, Vec<Shot>)> {
    let looks = looks::all()?;
    let mut pages = pages(sources, root)?;
    let mut shots = shots::all(&looks)?;
    for page in &mut pages {
        page.text = gallery::filled(&page.text, &looks)?;
        moving::fill(page)?;
        shots.extend(series::fill(page)?);
    }
    Ok((pages, shots))
}

/// Makes all pictures: of a frame of the demo scene, of a photograph, and of the scene as it turns.
fn photograph(
    options: &Options,
    means: &Means,
    shots: &[Shot],
    scratch: &Path,
    pictures: &Path,
) -> Result<()> {
    let Size(width, height) = options.size;
    let scene = scratch.join("scene.exr");
    let mut command = Command::new(&means.host);
    command.arg("render").arg(&means.scene).arg(&scene).args(["--size", &format!("{width}x{height}")]);
    finish(&mut command)?;
    let photo = scratch.join("photo.png");
    let photographs = Path::new(env!("CARGO_MANIFEST_DIR")).join("pictures");
    studio::resized(&photographs.join("coffee.jpg"), &photo, width)?;
    let gallery = photographs.join("gallery");
    let studio =
        Studio { host: &means.host, scene: &scene, photo: &photo, gallery: &gallery, widest: width, scratch };
    studio.make(shots, pictures)?;
    println!("moving pictures");
    let small = studio::WIDEST_BESIDE.min(width);
    // Wide, as turntables are best seen.
    let size = (small, small * 9 / 16);
    let stage =
        moving::Stage { host: &means.host, scene: &means.scene, scratch, frames: options.frames, size };
    moving::make(&stage, pictures)
}

/// Puts the page for browsers into the site, if it was named.
fn add_app(options: &Options, root: &Path, site: &Path) -> Result<()> {
    let Some(page) = &options.page else { return Ok(()) };
    let (from, to) = (root.join(page), site.join(APP));
    let folder = to.parent().unwrap_or(site);
    std::fs::create_dir_all(folder).map_err(Error::at(folder))?;
    std::fs::copy(&from, &to).map(drop).map_err(Error::at(&from))
}

/// Bytes of the files in a folder.
fn size_of(folder: &Path) -> Result<u64> {
    let mut size = 0;
    for entry in std::fs::read_dir(folder).map_err(Error::at(folder))? {
        size += entry.and_then(|e| e.metadata()).map_err(Error::at(folder))?.len();
    }
    Ok(size)
}

/// Writes all pages and their style sheet.
fn write(site: &Path, pages: &[Page], rendered: &[Rendered]) -> Result<()> {
    let sheet = site.join("site.css");
    std::fs::write(&sheet, template::STYLES).map_err(Error::at(&sheet))?;
    for (page, rendered) in pages.iter().zip(rendered) {
        let file = site.join(format!("{}.html", page.path));
        let folder = file.parent().unwrap_or(site);
        std::fs::create_dir_all(folder).map_err(Error::at(folder))?;
        std::fs::write(&file, template::framed(page, rendered, pages)).map_err(Error::at(&file))?;
    }
    Ok(())
}

/// Runs the commands of all pages, and takes the pictures that they make and the pages show.
fn commands(
    seed: &Seed<'_>,
    pages: &[Page],
    rendered: &[Rendered],
    [root, scratch, site]: [&Path; 3],
) -> Result<scratch::Counts> {
    let mut sum = scratch::Counts::default();
    for (number, (page, rendered)) in pages.iter().zip(rendered).enumerate() {
        let folder = scratch.join(format!("page-{number}"));
        let counts = seed.run(page, &rendered.blocks, &folder)?;
        sum.run += counts.run;
        sum.by_hand += counts.by_hand;
        for file in &rendered.copied {
            let from = root.join(file);
            std::fs::copy(&from, site.join(place_of_copied(file))).map_err(Error::at(&from))?;
        }
        for name in &rendered.made {
            let from = folder.join(name);
            if !from.is_file() {
                return Err(Error::page(&page.path, format!("shows {name}, which its commands do not make")));
            }
            small(&from, &site.join(place_of_made(page, name)), studio::WIDEST)?;
        }
    }
    Ok(sum)
}

fn replace(folder: &Path) -> Result<()> {
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(Error::at(folder))?;
    }
    Ok(())
}
