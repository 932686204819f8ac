//! `isophote-icons CATALOGUE DIR`, run by `cargo xtask bundle`: draws the icon of each effect, as PNG and
//! as SVG, under the names by which OpenFX hosts look for them. CATALOGUE is what `isophote nodes --json`
//! prints.

mod icon;

use icon::Icon;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Reason why an icon was not drawn.
#[derive(Debug, thiserror::Error)]
enum Error {
    #[error("{} is no catalogue: {source}", path.display())]
    Catalogue { path: PathBuf, source: serde_json::Error },
    #[error("the catalogue lists no nodes")]
    NoNodes,
    #[error("cannot write {}: {source}", path.display())]
    Picture { path: PathBuf, source: image::ImageError },
    #[error("{}: {source}", path.display())]
    File { path: PathBuf, source: std::io::Error },
}

fn main() -> ExitCode {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [catalogue, folder] = &arguments[..] else {
        eprintln!("usage: isophote-icons CATALOGUE DIR");
        return ExitCode::from(2);
    };
    match run(catalogue, folder) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("isophote-icons: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Draws all icons.
fn run(catalogue: &Path, folder: &Path) -> Result<(), Error> {
    let text = std::fs::read(catalogue).map_err(|source| Error::File { path: catalogue.into(), source })?;
    let value = serde_json::from_slice(&text)
        .map_err(|source| Error::Catalogue { path: catalogue.into(), source })?;
    effects(&value)?.iter().try_for_each(|(id, group)| draw(folder, id, group))
}

/// Ids and groups of the effects, by the rule that the library follows.
fn effects(catalogue: &Value) -> Result<Vec<(String, String)>, Error> {
    let nodes = catalogue["nodes"].as_array().ok_or(Error::NoNodes)?;
    let effect = |node: &Value| {
        let (id, group) = (node["id"].as_str()?, node["group"].as_str()?);
        if id == "tensor_view" {
            return Some(("structure".to_owned(), group.to_owned()));
        }
        let inputs = node["inputs"].as_array()?;
        let colour = |port: &Value| port["kind"] == "color";
        let alone = inputs.iter().any(colour) && inputs.iter().all(|p| colour(p) || p["optional"] == true);
        let shown = node["output"]["kind"] == "color" || node["output"]["kind"] == "scalar";
        (alone && shown).then(|| (id.to_owned(), group.to_owned()))
    };
    Ok(nodes.iter().filter_map(effect).collect())
}

/// Writes both files of one effect.
fn draw(folder: &Path, id: &str, group: &str) -> Result<(), Error> {
    let icon = Icon::new(id, group);
    let file = |ending: &str| folder.join(format!("org.isophote.{id}.{ending}"));
    let (picture, drawing) = (file("png"), file("svg"));
    icon.raster().save(&picture).map_err(|source| Error::Picture { path: picture, source })?;
    std::fs::write(&drawing, icon.drawing()).map_err(|source| Error::File { path: drawing, source })
}
