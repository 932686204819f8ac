//! `isophote-gallery`, run by `cargo xtask gallery`: every node that makes pictures, and every style, on the
//! demo scene, on a model and on a photograph, as an HTML page with the parameters under each picture.
//!
//! The nodes and their parameters come from the catalogue of the library that the host loads; nothing is
//! listed here.

mod error;
mod nodes;
mod page;

use clap::Parser;
use error::{Error, Result};
use nodes::{Shot, makes_pictures, shots, style_of, takes_guides, text};
use page::{escaped, opening, values};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Shows every node that makes pictures, and every style, on the demo scene, on a model and on a photograph.
#[derive(Parser)]
#[command(bin_name = "cargo xtask gallery")]
struct Options {
    /// Folder that the page and its pictures go to
    #[arg(long, default_value = "target/gallery")]
    out: PathBuf,
    /// Only these nodes; may be repeated
    #[arg(long, value_name = "ID")]
    node: Vec<String>,
    /// Pictures to show the nodes on, beside the demo scene; without it a model and a photograph of the
    /// test assets, when they are there
    #[arg(long, value_name = "FILE")]
    picture: Vec<PathBuf>,
    /// Size of rendered pictures
    #[arg(long, value_name = "WxH", default_value = "960x540")]
    size: String,
    /// The sample host
    #[arg(long, value_name = "FILE", hide = true)]
    host: PathBuf,
    /// The demo scene
    #[arg(long, value_name = "FILE", hide = true)]
    scene: PathBuf,
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("isophote-gallery: {error}");
            ExitCode::FAILURE
        }
    }
}

/// A picture that the nodes are shown on.
struct Subject {
    name: String,
    file: PathBuf,
    /// Scene that the picture was rendered from, if it was: its normals, depth and object ids are known then.
    scene: Option<PathBuf>,
}

/// The sample host, as a program.
struct Host<'a> {
    program: &'a Path,
    /// Size of rendered pictures.
    size: &'a str,
}

impl Host<'_> {
    /// Every node with its parameters.
    fn catalogue(&self) -> Result<Vec<Value>> {
        let at = |source| Error::File { path: self.program.to_owned(), source };
        let output = Command::new(self.program).args(["nodes", "--json"]).output().map_err(at)?;
        if !output.status.success() {
            return Err(Error::Host(String::from_utf8_lossy(&output.stderr).into_owned()));
        }
        let all: Value = serde_json::from_slice(&output.stdout)?;
        Ok(all["nodes"].as_array().cloned().unwrap_or_default())
    }

    fn render(&self, scene: &Path, out: &Path) -> Command {
        let mut command = Command::new(self.program);
        command.args(["render", "--force"]).arg(scene).arg(out).args(["--size", self.size]);
        command
    }

    fn apply(&self, style: &str, input: &Path, out: &Path) -> Command {
        let mut command = Command::new(self.program);
        command.args(["apply", "--force"]).arg(style).arg(input).arg(out).args(["--backend", "cpu"]);
        command
    }
}

/// Runs the host to its end.
fn finish(command: &mut Command) -> Result<()> {
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(Error::Host(format!("{command:?} ended with {status}"))),
        Err(source) => Err(Error::File { path: command.get_program().into(), source }),
    }
}

/// The page and where it goes.
struct Gallery<'a> {
    host: Host<'a>,
    out: PathBuf,
    page: String,
}

impl Gallery<'_> {
    /// Adds one node: its defaults on all subjects, its other options on the first.
    fn section(&mut self, node: &Value, style: &str, subjects: &[Subject]) -> Result<()> {
        let id = text(node, "id");
        let _ =
            writeln!(self.page, "<h2 id=\"{id}\">{} <code>{id}</code></h2>", escaped(text(node, "label")));
        let _ =
            writeln!(self.page, "<p>{} § {}</p>", escaped(text(node, "doc")), escaped(text(node, "section")));
        for (index, shot) in shots(node).iter().enumerate() {
            // Options of filters are compared on one picture; defaults and styles are shown on all.
            let is_style = text(node, "group") == "styles";
            let shown = if index == 0 || is_style { subjects } else { &subjects[..1] };
            let _ = writeln!(self.page, "<h3>{}</h3><div class=\"row\">", escaped(&shot.title));
            for (place, subject) in shown.iter().enumerate() {
                // Names of the user's files may hold what no address does.
                let name = format!("{id}-{index}-{place}.png");
                self.picture(node, style, shot, subject, &name)?;
                let _ = writeln!(
                    self.page,
                    "<figure><a href=\"{name}\"><img src=\"{name}\" loading=\"lazy\"></a><figcaption>{}</figcaption></figure>",
                    escaped(&subject.name)
                );
            }
            let _ = writeln!(self.page, "</div><p class=\"values\">{}</p>", values(node, shot));
        }
        Ok(())
    }

    /// Makes one picture; from the scene, where the node uses what only the renderer knows.
    fn picture(&self, node: &Value, style: &str, shot: &Shot, subject: &Subject, name: &str) -> Result<()> {
        let id = text(node, "id");
        let file = self.out.join(name);
        let mut command = match &subject.scene {
            Some(scene) if takes_guides(node) => {
                let mut command = self.host.render(scene, &file);
                command.args(["--style", style]);
                command
            }
            _ => self.host.apply(style, &subject.file, &file),
        };
        for (param, value) in &shot.set {
            // In a graph a parameter is named with its node.
            let param = if style == id { param.clone() } else { format!("{id}.{param}") };
            command.arg("--set").arg(format!("{param}={value}"));
        }
        finish(&mut command)
    }
}

/// Renders, filters and writes the page.
fn run(options: &Options) -> Result<()> {
    let out = root().join(&options.out);
    std::fs::create_dir_all(&out).map_err(|source| Error::File { path: out.clone(), source })?;
    let host = Host { program: &options.host, size: &options.size };
    let subjects = subjects(options, &host, &out)?;
    let nodes = host.catalogue()?;
    let names: Vec<&str> = subjects.iter().map(|s| s.name.as_str()).collect();
    let mut gallery = Gallery { host, out, page: opening(&names) };
    for node in nodes.iter().filter(|node| makes_pictures(node)) {
        let id = text(node, "id");
        if options.node.is_empty() || options.node.iter().any(|n| n == id) {
            println!("== {id}");
            let style = style_of(node, &nodes, &gallery.out)?;
            gallery.section(node, &style, &subjects)?;
        }
    }
    gallery.page.push_str("</body></html>\n");
    let index = gallery.out.join("index.html");
    std::fs::write(&index, gallery.page).map_err(|source| Error::File { path: index.clone(), source })?;
    println!("the gallery is {}", index.display());
    Ok(())
}

/// The root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The demo scene, and the pictures that were named or found.
fn subjects(options: &Options, host: &Host<'_>, out: &Path) -> Result<Vec<Subject>> {
    let rendered = |name: &str, scene: PathBuf| -> Result<Subject> {
        let file = out.join(format!("{name}.png"));
        finish(&mut host.render(&scene, &file))?;
        Ok(Subject { name: name.into(), file, scene: Some(scene) })
    };
    let mut subjects = vec![rendered("scene", options.scene.clone())?];
    if !options.picture.is_empty() {
        for file in &options.picture {
            let name = file.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
            subjects.push(Subject { name, file: file.clone(), scene: None });
        }
        return Ok(subjects);
    }
    let assets = root().join("../shared/assets");
    let helmet = assets.join("gltf/FlightHelmet/FlightHelmet.gltf");
    if helmet.exists() {
        subjects.push(rendered("helmet", helmet)?);
    }
    let photo = assets.join("photo/astronaut.png");
    if photo.exists() {
        subjects.push(Subject { name: "photo".into(), file: photo, scene: None });
    }
    Ok(subjects)
}
