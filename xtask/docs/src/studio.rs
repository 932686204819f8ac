//! Makes pictures: what nodes, controls and looks make of one frame of the demo scene or of a photograph, as small JPEG files.

use crate::error::{Error, Result};
use crate::shot::{Shot, Style, Subject};
use image::DynamicImage;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::FilterType;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Quality of the files: lines stay clean, and a picture takes some tens of kilobytes.
const QUALITY: u8 = 82;

/// The widest picture of a page.
pub const WIDEST: u32 = 960;

/// The widest of those that stand beside each other.
pub const WIDEST_BESIDE: u32 = 480;

/// Maker of pictures.
pub struct Studio<'a> {
    /// The sample host.
    pub host: &'a Path,
    /// The frame, with everything that guides filters.
    pub scene: &'a Path,
    /// The photograph.
    pub photo: &'a Path,
    /// Folder of the photographs of the gallery.
    pub gallery: &'a Path,
    /// Width at which they are shown at most.
    pub widest: u32,
    /// A folder for what is in between.
    pub scratch: &'a Path,
}

impl Studio<'_> {
    /// Makes all pictures, several at a time.
    ///
    /// # Errors
    /// The first that cannot be made.
    pub fn make(&self, shots: &[Shot], out: &Path) -> Result<()> {
        let next = AtomicUsize::new(0);
        let failed = Mutex::new(None);
        let lanes = std::thread::available_parallelism().map_or(1, usize::from);
        std::thread::scope(|scope| {
            for _ in 0..lanes {
                scope.spawn(|| {
                    while let Some(shot) = shots.get(next.fetch_add(1, Ordering::Relaxed)) {
                        if let Err(error) = self.picture(shot, out) {
                            // Nobody needs the others then.
                            next.store(shots.len(), Ordering::Relaxed);
                            *failed.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(error);
                        }
                    }
                });
            }
        });
        failed.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).map_or(Ok(()), Err)
    }

    fn picture(&self, shot: &Shot, out: &Path) -> Result<()> {
        let made = self.scratch.join(format!("{}.png", shot.name));
        let style = match &shot.style {
            Style::Named(name) => PathBuf::from(name),
            Style::Graph(text) => {
                let file = self.scratch.join(format!("{}.json", shot.name));
                std::fs::write(&file, text).map_err(Error::at(&file))?;
                file
            }
        };
        let (subject, widest) = match shot.subject {
            Subject::Scene => (self.scene.to_owned(), WIDEST_BESIDE),
            Subject::Photo => (self.photo.to_owned(), WIDEST_BESIDE),
            Subject::Gallery(stem) => {
                let small = self.scratch.join(format!("{}-before.png", shot.name));
                resized(&self.gallery.join(format!("{stem}.jpg")), &small, self.widest)?;
                (small, WIDEST)
            }
        };
        let mut command = Command::new(self.host);
        command.arg("apply").arg(style).arg(&subject).arg(&made);
        // Lengths are those of so small a picture: marks as fine as on large ones would not be seen.
        command.args(["--lengths", "pixels", "--backend", "cpu", "--threads", "1"]);
        for (param, value) in &shot.set {
            command.arg("--set").arg(format!("{param}={value}"));
        }
        finish(&mut command)?;
        small(&made, &out.join(format!("{}.jpg", shot.name)), widest)
    }
}

/// Runs a command to its end.
///
/// # Errors
/// [`Error::Program`] with what it wrote.
pub fn finish(command: &mut Command) -> Result<()> {
    let program = PathBuf::from(command.get_program());
    let output = command.output().map_err(Error::at(&program))?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    Err(Error::Program { command: format!("{command:?}"), said })
}

/// A picture at another width, as any kind of file.
///
/// # Errors
/// [`Error::Picture`] where it cannot be read or written.
pub fn resized(from: &Path, to: &Path, width: u32) -> Result<()> {
    let picture = image::open(from).map_err(Error::picture(from))?;
    let picture =
        if picture.width() > width { picture.resize(width, u32::MAX, FilterType::Lanczos3) } else { picture };
    picture.save(to).map_err(Error::picture(to))
}

/// A picture as a small JPEG file, at most so wide.
///
/// # Errors
/// [`Error::Picture`] where it cannot be read or written.
pub fn small(from: &Path, to: &Path, widest: u32) -> Result<()> {
    let mut picture = image::open(from).map_err(Error::picture(from))?;
    if picture.width() > widest {
        picture = picture.resize(widest, u32::MAX, FilterType::Lanczos3);
    }
    let mut file = BufWriter::new(File::create(to).map_err(Error::at(to))?);
    let encoder = JpegEncoder::new_with_quality(&mut file, QUALITY);
    DynamicImage::ImageRgb8(picture.to_rgb8()).write_with_encoder(encoder).map_err(Error::picture(to))?;
    // Dropped, it would not tell of a full disk.
    file.flush().map_err(Error::at(to))
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn a_picture_that_does_not_fit_on_the_disk_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let from = folder.path().join("a.png");
        image::RgbImage::new(8, 8).save(&from).unwrap();
        small(&from, &folder.path().join("a.jpg"), WIDEST).unwrap();
        assert!(small(&from, Path::new("/dev/full"), WIDEST).is_err());
    }
}
