//! Pictures that come with the program, to try looks on where nothing else is at hand: views of the demo scene of the project's
//! chores, rendered by the program itself (`cargo xtask samples`).

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};

use isophote_files::error::{Error, Result};
use isophote_files::files::{self, Existing};

/// Pixels across and down of the small pictures, whose shape is that of the large ones.
const SMALL: (u32, u32) = (360, 240);

/// A picture that comes with the program.
#[derive(Debug)]
pub struct Sample {
    /// Name for people.
    pub name: &'static str,
    file: &'static str,
    bytes: &'static [u8],
}

/// All of them.
pub static SAMPLES: [Sample; 3] = [
    Sample { name: "A statue", file: "statue.jpg", bytes: include_bytes!("../../samples/statue.jpg") },
    Sample { name: "A fountain", file: "fountain.jpg", bytes: include_bytes!("../../samples/fountain.jpg") },
    Sample { name: "Roofs", file: "roofs.jpg", bytes: include_bytes!("../../samples/roofs.jpg") },
];

impl Sample {
    /// Its file in a folder: written there, unless there is one, so that it can be exported and opened like any other.
    ///
    /// # Errors
    /// [`Error::Input`] and [`Error::Failure`] when it cannot be written.
    pub fn file_in(&self, folder: &Path) -> Result<PathBuf> {
        let file = folder.join(self.file);
        if !file.exists() {
            fs::create_dir_all(folder).map_err(|e| {
                Error::file(folder, format!("cannot be made: {e}"), "open a file of your own")
            })?;
            files::write_bytes(&file, Existing::Replace, self.bytes)?;
        }
        Ok(file)
    }

    /// The picture, small. Takes its time; not for the window's thread.
    fn small(&self) -> ColorImage {
        let Ok(picture) = image::load_from_memory(self.bytes) else { return ColorImage::default() };
        let small = picture.thumbnail(SMALL.0, SMALL.1).to_rgb8();
        let size = [small.width(), small.height()].map(|side| side as usize);
        ColorImage::from_rgb(size, small.as_raw())
    }
}

/// All pictures, small. Takes its time; not for the window's thread.
pub fn small() -> Vec<Arc<ColorImage>> {
    SAMPLES.iter().map(|sample| Arc::new(sample.small())).collect()
}

/// The small pictures as the window has them.
#[derive(Default)]
pub struct Thumbnails {
    textures: Vec<TextureHandle>,
    images: Vec<Arc<ColorImage>>,
}

impl Thumbnails {
    /// Takes over what was made.
    pub fn take(&mut self, images: Vec<Arc<ColorImage>>) {
        self.images = images;
    }

    /// The texture of a sample, once it is there.
    pub fn texture(&mut self, context: &Context, sample: usize) -> Option<TextureId> {
        for image in self.images.drain(..) {
            self.textures.push(context.load_texture("sample", image, TextureOptions::LINEAR));
        }
        self.textures.get(sample).map(TextureHandle::id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_are_pictures_and_a_file_that_is_there_stays() {
        let folder = tempfile::tempdir().unwrap();
        let deep = folder.path().join("deep");
        for (sample, small) in SAMPLES.iter().zip(small()) {
            let file = sample.file_in(&deep).unwrap();
            let whole = image::open(&file).unwrap();
            assert!(whole.width() >= 900, "{}", sample.name);
            assert_eq!(small.size, [SMALL.0 as usize, SMALL.1 as usize], "{}", sample.name);
            fs::write(&file, "mine").unwrap();
            assert_eq!(fs::read(sample.file_in(&deep).unwrap()).unwrap(), b"mine");
        }
        let taken = folder.path().join("file");
        fs::write(&taken, "").unwrap();
        let error = SAMPLES[0].file_in(&taken.join("in")).unwrap_err().to_string();
        assert!(error.contains("cannot be made"), "{error}");
    }
}
