//! `isophote-icons CATALOGUE DIR`, run by `cargo xtask bundle`: draws the icon of each effect, as PNG and
//! as SVG, under the names by which OpenFX hosts look for them. CATALOGUE is what `isophote nodes --json`
//! prints. `isophote-icons program DIR` draws the icon of the program: `SIDE.png` of each size that desktops want, and
//! `scalable.svg`. The window's own, in `host-example/window/icon`, is one of them.

mod icon;

use icon::{Icon, SIDE};
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
    let [what, folder] = &arguments[..] else {
        eprintln!("usage: isophote-icons CATALOGUE|program DIR");
        return ExitCode::from(2);
    };
    let drawn = if what.as_os_str() == "program" { program(folder) } else { run(what, folder) };
    match drawn {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("isophote-icons: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Sides of the program's icons.
const SIDES: [u32; 7] = [16, 32, 48, 64, 128, 256, 512];

/// The icon of the program.
fn of_program() -> Icon {
    Icon::new("isophote", "smoothing")
}

/// Draws the icon of the program.
fn program(folder: &Path) -> Result<(), Error> {
    let icon = of_program();
    for side in SIDES {
        let path = folder.join(format!("{side}.png"));
        icon.raster(side).save(&path).map_err(|source| Error::Picture { path, source })?;
    }
    let drawing = folder.join("scalable.svg");
    std::fs::write(&drawing, icon.drawing()).map_err(|source| Error::File { path: drawing, source })
}

/// Draws the icons of all effects.
fn run(catalogue: &Path, folder: &Path) -> Result<(), Error> {
    let text = std::fs::read(catalogue).map_err(|source| Error::File { path: catalogue.into(), source })?;
    let value = serde_json::from_slice(&text)
        .map_err(|source| Error::Catalogue { path: catalogue.into(), source })?;
    effects(&value)?.iter().try_for_each(|(id, group)| draw(folder, id, group))
}

/// Ids and groups of the effects, by the rule that the library follows, and of that for looks.
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
    let look = ("look".to_owned(), "styles".to_owned());
    Ok(nodes.iter().filter_map(effect).chain([look]).collect())
}

/// Writes both files of one effect.
fn draw(folder: &Path, id: &str, group: &str) -> Result<(), Error> {
    let icon = Icon::new(id, group);
    let file = |ending: &str| folder.join(format!("org.isophote.{id}.{ending}"));
    let (picture, drawing) = (file("png"), file("svg"));
    icon.raster(SIDE).save(&picture).map_err(|source| Error::Picture { path: picture, source })?;
    std::fs::write(&drawing, icon.drawing()).map_err(|source| Error::File { path: drawing, source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_has_the_icon_of_the_program() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../host-example/window/icon/128.png");
        let picture = image::open(file).expect("the window's icon").into_rgba8();
        assert_eq!(
            picture,
            of_program().raster(picture.width()),
            "draw it anew by `isophote-icons program DIR`"
        );
    }
}
