//! OpenEXR files, of which the picture alone is changed.
//!
//! A file is read as headers and chunks whose bytes are kept. Chunks of parts that hold the picture are taken
//! apart into channels; when the result is written, these chunks are put together again with the picture's channels
//! replaced and everything else as it was, and all other bytes are copied. So nothing needs to be understood to
//! survive.

mod blocks;
mod choose;
mod codec;
mod container;
mod cursor;
pub mod fresh;
mod names;
mod picture;
mod planes;

use std::path::Path;

pub use self::choose::{Guide, GuideChoice, Selection};
pub use self::picture::Picture;

use self::choose::Chosen;
use self::container::{Channel, Container};
use self::planes::{Content, Decoded};
use crate::error::{Error, Result};
use crate::pixels::Pixels;

/// Why a file is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fault {
    /// It is not what it says.
    Damaged(String),
    /// It is of a kind that is not read or written.
    Unsupported {
        /// What is so.
        problem: String,
        /// How to put it right.
        mend: String,
    },
}

impl Fault {
    fn damaged(problem: impl Into<String>) -> Self {
        Self::Damaged(problem.into())
    }

    fn unsupported(problem: impl Into<String>) -> Self {
        Self::Unsupported { problem: problem.into(), mend: "convert it".into() }
    }

    fn of(self, path: &Path) -> Error {
        match self {
            Self::Damaged(problem) => super::read::malformed(path, "EXR", problem),
            Self::Unsupported { problem, mend } => Error::file(path, problem, mend),
        }
    }
}

/// Whether all chunks of a file are there.
pub fn is_whole(bytes: Vec<u8>) -> bool {
    Container::new(bytes).is_ok()
}

/// A file taken apart, of which nothing is decoded yet.
#[derive(Debug)]
pub struct Opened {
    container: Container,
    selection: Selection,
    chosen: Vec<Chosen>,
}

impl Opened {
    /// Takes a file apart.
    ///
    /// # Errors
    /// [`Error::Input`] for damaged files, and when there is no such layer, view, alpha or guide.
    pub fn new(path: &Path, bytes: Vec<u8>, selection: &Selection) -> Result<Self> {
        let open = || -> std::result::Result<Self, Fault> {
            let container = Container::new(bytes)?;
            let chosen = choose::choose(&container, selection)?;
            Ok(Self { container, selection: selection.clone(), chosen })
        };
        open().map_err(|fault| fault.of(path))
    }

    /// Size of the largest picture.
    pub fn size(&self) -> Option<(u32, u32)> {
        let windows = self.chosen.iter().map(|c| self.container.parts[c.group.part].window);
        let sizes = windows.map(|w| (w.width as u32, w.height as u32));
        sizes.max_by_key(|(w, h)| u64::from(*w) * u64::from(*h))
    }

    /// Bytes of memory that the file and its pictures take from being decoded to being written, about.
    pub fn weight(&self) -> u64 {
        let mut parts: Vec<usize> = Vec::new();
        let mut total = self.container.bytes.len() as u64;
        for picture in &self.chosen {
            let part = &self.container.parts[picture.group.part];
            let pixels = (part.window.width * part.window.height) as u64;
            // As read, as result and as planes of floats; guides are floats.
            total += pixels * 4 * (2 + 2 + 4 + 4) + pixels * 12 * picture.guides.len() as u64;
            parts.extend(picture.guides.iter().map(|g| g.part).chain([picture.group.part]));
        }
        parts.sort_unstable();
        parts.dedup();
        for part in parts.iter().map(|p| &self.container.parts[*p]) {
            // Decoded, and encoded again.
            total += 2 * part.chunks.iter().map(|c| c.block.bytes(&part.channels) as u64).sum::<u64>();
        }
        total
    }

    /// Decodes the parts that are needed.
    ///
    /// # Errors
    /// [`Error::Input`] for damaged files and for kinds of files that cannot be written back.
    pub fn decode(self, path: &Path) -> Result<ExrFile> {
        ExrFile::of(self).map_err(|fault| fault.of(path))
    }
}

/// A file with the pictures that were asked for.
#[derive(Debug)]
pub struct ExrFile {
    container: Container,
    selection: Selection,
    chosen: Vec<Chosen>,
    decoded: Vec<Option<Decoded>>,
    /// New channels and contents of each part.
    changed: Vec<Option<(Vec<Channel>, Vec<Content>)>>,
}

impl ExrFile {
    fn of(Opened { container, selection, chosen }: Opened) -> std::result::Result<Self, Fault> {
        if let Some(layer) = &selection.into {
            for picture in &chosen {
                let part = &container.parts[picture.group.part];
                let prefix = picture::into_name(part, picture, layer, "");
                if part.channels.iter().any(|c| c.name.starts_with(&prefix)) {
                    return Err(Fault::Unsupported {
                        problem: format!("has a layer '{layer}' already"),
                        mend: "choose another name for --into".into(),
                    });
                }
                if prefix.len() > 250 {
                    return Err(Fault::unsupported(format!("cannot hold a layer of the name '{layer}'")));
                }
            }
        }
        let mut decoded: Vec<Option<Decoded>> = container.parts.iter().map(|_| None).collect();
        for picture in &chosen {
            let needed = picture.guides.iter().map(|g| g.part).chain([picture.group.part]);
            for part in needed {
                if decoded[part].is_none() {
                    decoded[part] = Some(Decoded::new(&container, &container.parts[part])?);
                }
            }
        }
        let changed = container.parts.iter().map(|_| None).collect();
        Ok(Self { container, selection, chosen, decoded, changed })
    }

    /// The pictures, one for each view that was asked for.
    ///
    /// # Errors
    /// [`Error::Input`] when channels are of unequal size.
    pub fn pictures(&self, path: &Path) -> Result<Vec<Picture>> {
        let read = |chosen| picture::read(&self.container, &self.decoded, chosen);
        let pictures: Option<Vec<Picture>> = self.chosen.iter().map(read).collect();
        pictures.ok_or_else(|| Fault::damaged("its channels are of unequal size").of(path))
    }

    /// Samples a pixel that the result of a picture must have.
    pub fn result_channels(&self, picture: usize, scalar: bool) -> u32 {
        picture::result_channels(&self.chosen[picture], &self.selection, scalar)
    }

    /// Puts the result of a picture into its place.
    pub fn replace(&mut self, picture: usize, result: &Pixels) {
        let chosen = &self.chosen[picture];
        let part = chosen.group.part;
        let before = self.changed[part].take();
        let changed = picture::replaced(&self.container.parts[part], chosen, &self.selection, result, before);
        self.changed[part] = Some(changed);
    }

    /// The whole file with all results.
    ///
    /// # Errors
    /// The reason as text: of the disk, or of a codec.
    pub fn write(&self, out: &mut impl std::io::Write) -> std::result::Result<(), String> {
        let mut data: Vec<Option<Vec<Vec<u8>>>> = Vec::new();
        for (at, changed) in self.changed.iter().enumerate() {
            let part = &self.container.parts[at];
            data.push(match (changed, &self.decoded[at]) {
                (Some((channels, contents)), Some(decoded)) => {
                    let encoded = decoded.encode(&self.container, part, channels, contents);
                    Some(encoded.map_err(|fault| match fault {
                        Fault::Damaged(problem) | Fault::Unsupported { problem, .. } => problem,
                    })?)
                }
                _ => None,
            });
        }
        let data = std::cell::RefCell::new(data);
        let take =
            |part: usize, chunk: usize| Some(std::mem::take(&mut data.borrow_mut()[part].as_mut()?[chunk]));
        let channels = |part: usize| self.changed[part].as_ref().map(|(channels, _)| channels.clone());
        self.container.write(channels, take, out).map_err(|e| e.to_string())
    }
}
