//! A scene of the project's own, so that a machine without assets has something to render.
//!
//! It is a piece of an antique city: a temple with fluted columns, a paved square with a
//! mosaic, a fountain and a market, houses, a gate, a portico, trees and distant hills. It was made
//! to try the filters: strong edges, smooth curved surfaces, fine repeated detail, foliage that
//! looks like noise, low contrast (marble, haze) and high contrast (mosaic, stripes, doorways). It
//! also uses the features of glTF that a renderer must know: textures of every role, alpha masks,
//! emission, instances, lights, skins, morph targets and all three interpolations.

mod city;
mod elements;
mod error;
mod houses;
mod life;
mod market;
mod materials;
mod mesh;
mod nature;
mod noise;
mod obj;
mod square;
mod temple;
mod textures;
mod writer;

#[cfg(test)]
mod tests;

pub use error::{Error, Result};

use std::fs;
use std::path::Path;
use textures::Texture;

/// Name of the file that holds the whole scene.
pub const SCENE: &str = "city.gltf";

/// Name of the file that holds one house.
pub const HOUSE: &str = "house.obj";

/// Files of the scene: name and contents. What another file names comes before it.
pub type Files = Vec<(String, Vec<u8>)>;

/// Makes the scene and writes it to the folder, creating it when it is not there.
///
/// # Errors
/// [`Error::Encode`] and [`Error::Write`]; no file is left half written.
pub fn write_to(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).map_err(|source| Error::Write { path: folder.to_owned(), source })?;
    generate()?.iter().try_for_each(|(name, contents)| write(folder, name, contents))
}

/// Makes the scene in memory.
///
/// # Errors
/// [`Error::Encode`].
pub fn generate() -> Result<Files> {
    let mut files: Files = textures::paint_all()?
        .into_iter()
        .map(|(texture, contents)| (Texture::file_name(texture).to_owned(), contents))
        .collect();
    let house = obj::write(&city::corner_house(), "house.mtl");
    files.push(("house.mtl".into(), house.materials.into_bytes()));
    files.push((HOUSE.into(), house.geometry.into_bytes()));
    let mut writer = writer::Writer::default();
    city::city(&mut writer);
    let (document, buffer) = writer.finish("city.bin");
    files.push(("city.bin".into(), buffer));
    files.push((SCENE.into(), document.into_bytes()));
    Ok(files)
}

/// Writes a file beside its final name and then renames it, so that no reader sees half of it.
fn write(folder: &Path, name: &str, contents: &[u8]) -> Result<()> {
    let path = folder.join(name);
    let beside = folder.join(format!(".{name}.{}.part", std::process::id()));
    let written = fs::write(&beside, contents).and_then(|()| fs::rename(&beside, &path));
    if written.is_err() {
        // What failed is reported; that the remains may stay as well adds nothing.
        let _ = fs::remove_file(&beside);
    }
    written.map_err(|source| Error::Write { path, source })
}
