//! A file with the pictures that were chosen in it, and their results back into it.

use std::path::Path;
use std::sync::Once;

use isophote_exr_edit::{Decoded, Edit, File, Limits, PartEdit, Sample, Window};

use super::choose::{self, Chosen, Selection};
use super::fault::Fault;
use super::mask::{self, ChosenMask, MaskSource, OnUnknown};
use super::offers::{self, Offers};
use super::picture::{self, Picture};
use crate::pixels::{MOST_PIXELS, Pixels, Samples};
use isophote_files::error::Result;
use isophote_files::output;

/// Most that one file may take, whatever it says of itself. The number of files that are in memory at the same time is
/// decided by what they weigh; see [`Opened::weight`].
pub(super) const LIMITS: Limits = Limits { memory: 16 << 30, pixels: MOST_PIXELS };

/// Motion vectors for a picture from a file of their own, by the names of the graph's inputs.
///
/// # Errors
/// [`Error::Input`](isophote_files::error::Error::Input) for damaged files, those that hold no vectors, and vectors for a picture of
/// another size.
pub fn motion_of(
    path: &Path,
    bytes: Vec<u8>,
    selection: &Selection,
    picture: &Picture,
) -> Result<Vec<(&'static str, Pixels)>> {
    let window = picture.window();
    let read = || -> std::result::Result<_, Fault> {
        let exr = File::parse(bytes, LIMITS)?;
        let sources = choose::motion(&exr, selection)?;
        let mut decoded: Vec<Option<Decoded>> = exr.parts().iter().map(|_| None).collect();
        let mut found = Vec::new();
        for source in &sources {
            let own = exr.parts()[source.part].window;
            // A window that begins elsewhere is a part of the picture.
            let is_scaled = (own.x, own.y) == (window.x, window.y)
                && (own.width < window.width || own.height < window.height);
            if is_scaled {
                return Err(Fault::Choice {
                    problem: format!(
                        "shows {}x{} pixels, and the picture {}x{}",
                        own.width, own.height, window.width, window.height
                    ),
                    fix: "render motion in the picture's size".into(),
                });
            }
            if decoded[source.part].is_none() {
                decoded[source.part] = Some(exr.decode(source.part)?);
            }
            if let Some(pixels) = picture::guide(&exr, &decoded, source, window, None)? {
                found.push((source.guide.id(), pixels));
            }
        }
        Ok(found)
    };
    read().map_err(|fault| fault.of(path))
}

/// The mask of a file of its own, or the one that `source` names in it, over the window that `place` finds for the file's data
/// and display windows.
///
/// # Errors
/// [`Error::Input`](isophote_files::error::Error::Input) for damaged files, those of several channels or without what is named, and
/// where `place` finds no window, which says what is wrong.
pub fn mask_of(
    path: &Path,
    bytes: Vec<u8>,
    (source, on_unknown): (Option<&MaskSource>, OnUnknown),
    place: impl FnOnce(Window, Option<Window>) -> std::result::Result<Window, String>,
) -> Result<Pixels> {
    let read = || -> std::result::Result<_, Fault> {
        let exr = File::parse(bytes, LIMITS)?;
        let named = match source {
            Some(source) => ChosenMask::alone(&exr, folder(path), source)?,
            None => None,
        };
        let main = if named.is_none() { Some(mask::main_channels(&exr)?) } else { None };
        let number = main.as_ref().map_or(0, |(part, _)| *part);
        let part = &exr.parts()[number];
        let window = place(part.window, part.display)
            .map_err(|problem| Fault::Choice { problem, fix: "make masks of the picture's size".into() })?;
        let values = match (named, main) {
            (Some(named), _) => {
                let mut decoded: Vec<Option<Decoded>> = exr.parts().iter().map(|_| None).collect();
                for layer in &named.layers {
                    if decoded[layer.part].is_none() {
                        decoded[layer.part] = Some(exr.decode(layer.part)?);
                    }
                }
                named.read(&exr, &decoded, window, on_unknown, path)?
            }
            (None, Some((part, channels))) => mask::whole(&exr, part, &channels, window)?,
            (None, None) => Vec::new(),
        };
        let (width, height) = (window.width as u32, window.height as u32);
        let unequal = || isophote_exr_edit::Error::Damaged("its channels are of unequal size".into());
        Ok(Pixels::new(width, height, 1, Samples::F32(values)).ok_or_else(unequal)?)
    };
    read().map_err(|fault| fault.of(path))
}

/// The folder of a file.
pub(super) fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// Warns once that results are compressed otherwise than the pictures that they are made from.
fn tell_recompressed([old, new]: [&str; 2]) {
    static TOLD: Once = Once::new();
    TOLD.call_once(|| {
        output::warn(format_args!(
            "{old} compression loses something each time; results take {new}, and layers that are kept lose nothing more"
        ));
    });
}

/// True where all chunks of a file are there.
pub fn is_whole(bytes: Vec<u8>) -> bool {
    File::parse(bytes, LIMITS).is_ok()
}

/// A file taken apart, of which nothing is decoded yet.
#[derive(Debug)]
pub struct Opened {
    exr: File,
    selection: Selection,
    chosen: Vec<Chosen>,
}

impl Opened {
    /// Takes a file apart.
    ///
    /// # Errors
    /// [`Error::Input`](isophote_files::error::Error::Input) for damaged files, and when there is no such layer, view, alpha or guide.
    pub fn new(path: &Path, bytes: Vec<u8>, selection: &Selection) -> Result<Self> {
        let open = || -> std::result::Result<Self, Fault> {
            let exr = File::parse(bytes, LIMITS)?;
            let chosen = choose::choose(&exr, folder(path), selection)?;
            Ok(Self { exr, selection: selection.clone(), chosen })
        };
        open().map_err(|fault| fault.of(path))
    }

    /// Choices that the file offers, and those made.
    pub fn offers(&self) -> Offers {
        offers::offers(&self.exr, &self.chosen)
    }

    /// Size of the largest picture.
    pub fn size(&self) -> Option<(u32, u32)> {
        let windows = self.chosen.iter().map(|c| self.exr.parts()[c.group.part].window);
        let sizes = windows.map(|w| (w.width as u32, w.height as u32));
        sizes.max_by_key(|(w, h)| u64::from(*w) * u64::from(*h))
    }

    /// Width of a pixel over its height, of the largest picture that tells one that can be.
    pub fn pixel_aspect(&self) -> f64 {
        let parts = self.chosen.iter().map(|c| &self.exr.parts()[c.group.part]);
        let largest = parts.max_by_key(|part| part.window.width * part.window.height);
        let aspect = largest.and_then(|part| part.pixel_aspect).map_or(1.0, f64::from);
        if (0.01..=100.0).contains(&aspect) { aspect } else { 1.0 }
    }

    /// Bytes of memory that the file and its pictures take from being decoded to being written, about.
    pub fn weight(&self) -> u64 {
        let mut parts: Vec<usize> = Vec::new();
        let mut total = self.exr.length() as u64;
        for picture in &self.chosen {
            let part = &self.exr.parts()[picture.group.part];
            let pixels = (part.window.width * part.window.height) as u64;
            let is_half = picture.colors.iter().all(|c| part.channels[*c].sample == Sample::Half);
            let bytes = if is_half { 2 } else { 4 };
            // As read, as result and twice as floats; guides are floats.
            total += pixels * 4 * (2 * bytes + 4 + 4) + pixels * 16 * picture.guides.len() as u64;
            // A mask with the planes that it is made of.
            total += pixels * 4 * 3 * picture.masks.len() as u64;
            parts.extend(picture.parts());
        }
        parts.sort_unstable();
        parts.dedup();
        for part in parts.iter().map(|p| &self.exr.parts()[*p]) {
            // Decoded, and encoded again.
            total += 2 * part.decoded_bytes();
        }
        total
    }

    /// Decodes the parts that are needed.
    ///
    /// # Errors
    /// [`Error::Input`](isophote_files::error::Error::Input) for damaged files and for kinds of files that cannot be written back.
    pub fn decode(self, path: &Path) -> Result<ExrFile> {
        ExrFile::of(self).map_err(|fault| fault.of(path))
    }
}

/// A file with the pictures that were asked for.
#[derive(Debug)]
pub struct ExrFile {
    exr: File,
    selection: Selection,
    chosen: Vec<Chosen>,
    decoded: Vec<Option<Decoded>>,
    /// Changes of each part.
    edits: Vec<Option<Edit>>,
}

impl ExrFile {
    fn of(Opened { exr, selection, chosen }: Opened) -> std::result::Result<Self, Fault> {
        if let Some(layer) = &selection.into {
            for picture in &chosen {
                let part = &exr.parts()[picture.group.part];
                let prefix = picture::into_name(part, picture, layer, "");
                if part.channels.iter().any(|c| c.name.starts_with(&prefix)) {
                    return Err(Fault::Choice {
                        problem: format!("has a layer '{layer}' already"),
                        fix: "choose another name for --into".into(),
                    });
                }
                if prefix.len() > 250 {
                    return Err(Fault::Choice {
                        problem: format!("cannot hold a layer of the name '{layer}'"),
                        fix: "choose another name for --into".into(),
                    });
                }
            }
        }
        let mut decoded: Vec<Option<Decoded>> = exr.parts().iter().map(|_| None).collect();
        for picture in &chosen {
            for part in picture.parts() {
                if decoded[part].is_none() {
                    decoded[part] = Some(exr.decode(part)?);
                }
            }
        }
        let edits = exr.parts().iter().map(|_| None).collect();
        Ok(Self { exr, selection, chosen, decoded, edits })
    }

    /// The pictures, one for each view that was asked for.
    ///
    /// # Errors
    /// [`Error::Input`](isophote_files::error::Error::Input) when channels are of unequal size.
    pub fn pictures(&self, path: &Path) -> Result<Vec<Picture>> {
        let read = |chosen| picture::read(&self.exr, &self.decoded, chosen, &self.selection, path);
        let pictures: std::result::Result<Vec<Picture>, Fault> = self.chosen.iter().map(read).collect();
        pictures.map_err(|fault| fault.of(path))
    }

    /// Samples a pixel that the result of a picture must have; one with alpha keeps it in a layer of its own.
    pub fn result_channels(&self, picture: usize, scalar: bool, has_alpha: bool) -> u32 {
        picture::result_channels(&self.chosen[picture], &self.selection, scalar, has_alpha)
    }

    /// Puts the result of a picture into its place.
    ///
    /// # Errors
    /// The reason as text, when the result does not fit the file.
    pub fn replace(&mut self, picture: usize, result: &Pixels) -> std::result::Result<(), String> {
        let chosen = &self.chosen[picture];
        let part = &self.exr.parts()[chosen.group.part];
        let edit = self.edits[chosen.group.part].get_or_insert_with(|| Edit::of(part));
        picture::replace(edit, part, chosen, &self.selection, result).map_err(|e| e.to_string())
    }

    /// The whole file with all results.
    ///
    /// # Errors
    /// The reason as text: of the disk, or of a codec.
    pub fn write(&self, out: &mut impl std::io::Write) -> std::result::Result<(), String> {
        let changed = (0..self.edits.len()).filter(|part| self.edits[*part].is_some());
        changed.filter_map(|part| self.exr.recompressed(part)).for_each(tell_recompressed);
        let both = self.decoded.iter().zip(&self.edits);
        let edits: Vec<PartEdit<'_>> = both
            .filter_map(|(decoded, edit)| Some(PartEdit { decoded: decoded.as_ref()?, edit: edit.as_ref()? }))
            .collect();
        self.exr.write(&edits, out).map_err(|e| e.to_string())
    }
}
