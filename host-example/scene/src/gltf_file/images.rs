//! Images and textures of a glTF document. One that is missing or cannot be read leaves what it is on plain.

use std::borrow::Cow;
use std::path::Path;

use gltf::texture::{MagFilter, MinFilter, WrappingMode};

use super::accessors::Accessors;
use super::materials::label;
use super::sources;
use crate::decode::decode;
use crate::material::{Sampler, Texture, Wrap};
use crate::model::Scene;
use crate::references::Folders;
use isophote_files::error::{Error, Result};

/// Reads images and textures into the scene.
///
/// # Errors
/// [`Error::Input`] for images that take the scene beyond its memory.
pub fn read(path: &Path, document: &gltf::Document, accessors: &Accessors, scene: &mut Scene) -> Result<()> {
    let folders = Folders::around(path);
    let mut images =
        Images { path, folders, document, accessors, known: vec![None; document.images().len()] };
    for texture in document.textures() {
        let mut problems = Vec::new();
        let mut image = None;
        for source in sources_of(&texture) {
            match images.read(source, scene)? {
                Ok(place) => {
                    image = Some(place);
                    break;
                }
                Err(problem) => problems.push(problem),
            }
        }
        if image.is_none() {
            let problem = if problems.is_empty() { "has no image".to_owned() } else { problems.join("; ") };
            let name = label(texture.name(), texture.index());
            scene.warnings.push(format!("texture {name}: {problem}; it is left out"));
        }
        scene.textures.push(Texture { image, sampler: sampler(&texture.sampler()) });
    }
    // Images that no texture shows are kept for whoever looks for them.
    let mut shown = vec![false; document.images().len()];
    for source in document.textures().flat_map(|texture| sources_of(&texture)) {
        shown.get_mut(source).into_iter().for_each(|shown| *shown = true);
    }
    for image in (0..shown.len()).filter(|image| !shown[*image]) {
        let _ = images.read(image, scene)?;
    }
    Ok(())
}

/// Images of a texture, the one to be preferred first.
fn sources_of(texture: &gltf::Texture) -> Vec<usize> {
    let extension = |name: &str| {
        let source = texture.extension_value(name)?.get("source")?.as_u64()?;
        Some(usize::try_from(source).unwrap_or(usize::MAX))
    };
    let others = ["MSFT_texture_dds", "KHR_texture_basisu", "EXT_texture_avif"].map(extension);
    let first = [extension("EXT_texture_webp"), texture.source().map(|image| image.index())];
    first.into_iter().chain(others).flatten().collect()
}

fn sampler(sampler: &gltf::texture::Sampler) -> Sampler {
    let (linear_min, mipmaps) = match sampler.min_filter() {
        Some(MinFilter::Nearest) => (false, false),
        Some(MinFilter::Linear) => (true, false),
        Some(MinFilter::NearestMipmapNearest | MinFilter::NearestMipmapLinear) => (false, true),
        _ => (true, true),
    };
    Sampler {
        wrap_u: wrap(sampler.wrap_s()),
        wrap_v: wrap(sampler.wrap_t()),
        linear_mag: sampler.mag_filter() != Some(MagFilter::Nearest),
        linear_min,
        mipmaps,
    }
}

fn wrap(mode: WrappingMode) -> Wrap {
    match mode {
        WrappingMode::ClampToEdge => Wrap::Clamp,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
        WrappingMode::Repeat => Wrap::Repeat,
    }
}

/// Images of a document, each read once.
struct Images<'a> {
    path: &'a Path,
    folders: Folders,
    document: &'a gltf::Document,
    accessors: &'a Accessors<'a>,
    /// The scene's image of each of the document's that was read, or a clause saying why there is none.
    known: Vec<Option<std::result::Result<usize, String>>>,
}

impl Images<'_> {
    /// The scene's image, or a clause that names the image and says why there is none.
    fn read(&mut self, index: usize, scene: &mut Scene) -> Result<std::result::Result<usize, String>> {
        match self.known.get(index) {
            None => return Ok(Err(format!("image {index} does not exist"))),
            Some(Some(known)) => return Ok(known.clone()),
            Some(None) => {}
        }
        let source = &self.document.as_json().images[index];
        let file = source.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
        let name = label(source.name.as_deref().or(file), index);
        let budget = self.accessors.budget;
        let decoded = self
            .bytes(source)
            .and_then(|bytes| decode(&name, &bytes, budget).map_err(|problem| problem.to_string()));
        let place = match decoded {
            Ok(image) => {
                scene.images.push(image);
                Ok(scene.images.len() - 1)
            }
            Err(problem) if budget.exceeded() => {
                return Err(Error::file(self.path, format!("image {name}: {problem}"), budget.fix("")));
            }
            Err(problem) => Err(format!("image {name}: {problem}")),
        };
        self.known[index] = Some(place.clone());
        Ok(place)
    }

    fn bytes(&self, source: &gltf::json::Image) -> std::result::Result<Cow<'_, [u8]>, String> {
        match (&source.uri, source.buffer_view) {
            (Some(uri), _) => sources::read_uri(&self.folders, uri, self.accessors.budget)
                .map(Cow::Owned)
                .map_err(|(problem, _)| problem),
            (None, Some(view)) => self
                .document
                .views()
                .nth(view.value())
                .and_then(|view| self.accessors.view(&view))
                .map(Cow::Borrowed)
                .ok_or_else(|| "its bytes reach beyond the end of its buffer".into()),
            (None, None) => Err("it has neither a file nor a buffer view".into()),
        }
    }
}
