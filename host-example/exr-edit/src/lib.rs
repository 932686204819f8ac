//! Changes some channels of an OpenEXR file and keeps every other byte.
//!
//! A file is read as headers and chunks whose bytes are kept ([`File`]). Chunks of the parts that are asked for are
//! decompressed ([`Decoded`]) into planes, one for each channel ([`Plane`]). An [`Edit`] says what the channels of a
//! part hold in the file that is written; [`File::write`] compresses the chunks of the parts that have one and copies
//! all other bytes. So nothing needs to be understood to survive. [`create::write`] writes new files.
//!
//! Planes are rows from the top of the data window, `width / sampling` by `height / sampling` samples.
//!
//! # Memory
//!
//! [`Limits`] bound what a file may make its reader allocate. The size of every allocation that follows from the
//! file's contents is reserved before it is made, and refused with [`Error::Memory`] where the limit does not allow
//! it. Sizes that the length of the file cannot account for are refused as [`Error::Damaged`] even before.
//!
//! ```
//! use isophote_exr_edit::create::{self, Picture};
//! use isophote_exr_edit::{Edit, File, Limits, PartEdit, Plane};
//!
//! // A file of 2 by 1 pixels with colour and an id.
//! let grey = |v: f32| Plane::Float(vec![v, v]);
//! let channels = vec![
//!     ("R".to_owned(), grey(0.5)),
//!     ("G".to_owned(), grey(0.25)),
//!     ("id".to_owned(), Plane::Uint(vec![7, 4_000_000_000])),
//! ];
//! let mut bytes = std::io::Cursor::new(Vec::new());
//! create::write(&Picture { width: 2, height: 1, channels, ..Picture::default() }, &mut bytes)?;
//!
//! // Red is doubled; nothing else is touched.
//! let file = File::parse(bytes.into_inner(), Limits { memory: 1 << 20, ..Limits::default() })?;
//! let part = &file.parts()[0];
//! let decoded = file.decode(0)?;
//! let red = part.channel("R").expect("there is a red channel");
//! let mut edit = Edit::of(part);
//! edit.replace("R", decoded.plane(red)?.to_f32().iter().map(|v| v * 2.0).collect())?;
//! let mut out = Vec::new();
//! file.write(&[PartEdit { decoded: &decoded, edit: &edit }], &mut out)?;
//!
//! let again = File::parse(out, Limits::default())?;
//! let decoded = again.decode(0)?;
//! assert_eq!(decoded.plane(red)?, Plane::Float(vec![1.0, 1.0]));
//! let id = part.channel("id").expect("there is an id channel");
//! assert_eq!(decoded.plane(id)?, Plane::Uint(vec![7, 4_000_000_000]));
//! # Ok::<(), isophote_exr_edit::Error>(())
//! ```

#![forbid(unsafe_code)]

mod codec;
mod compression;
mod content;
pub mod create;
mod cursor;
mod error;
mod file;
mod layout;
mod limits;
mod part;

pub use content::{Decoded, Edit, PartEdit, Plane};
pub use error::{Error, Result};
pub use file::File;
pub use layout::{Channel, Sample, Window};
pub use limits::Limits;
pub use part::Part;

/// The example of the front page is compiled with the others.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct FrontPage;
