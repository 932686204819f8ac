//! A video that is read from its first frame to its last: a file, or YUV4MPEG on standard input.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::Path;

use super::container::is_pipe;
use super::decode::Origin;
use super::packets::Packets;
use super::probe::{probe, warn_of};
use super::stream::Stream;
use super::y4m::{Header, MAGIC};
use isophote_files::error::{Error, Result};

/// The bytes of a stream.
type Bytes = BufReader<Box<dyn Read + Send>>;

/// A video that was opened.
pub struct Input<'a> {
    path: &'a Path,
    /// Properties that it gives of itself.
    pub stream: Stream,
    content: Content,
}

enum Content {
    /// ffmpeg reads the file.
    Packets(Packets),
    /// A stream that is handed to ffmpeg frame by frame.
    Y4m(Pipe),
}

/// A YUV4MPEG stream after its first line.
pub struct Pipe {
    header: Header,
    bytes: Bytes,
}

impl<'a> Input<'a> {
    /// Opens a file, or standard input for `-`.
    ///
    /// # Errors
    /// [`Error::Input`] for what is no video, [`Error::Failure`] where there is no ffmpeg.
    pub fn open(path: &'a Path) -> Result<Self> {
        if is_pipe(path) {
            return Self::y4m(path, "standard input", None, BufReader::new(Box::new(io::stdin())));
        }
        if !path.is_file() {
            return Err(Error::file(path, "is no file", "name a video"));
        }
        let unreadable =
            |e: io::Error| Error::file(path, format!("cannot be read: {e}"), "name a readable file");
        let file = File::open(path).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        let mut bytes: Bytes = BufReader::new(Box::new(file));
        if bytes.fill_buf().map_err(unreadable)?.starts_with(MAGIC) {
            return Self::y4m(path, &path.display().to_string(), Some(length), bytes);
        }
        let stream = probe(path)?;
        let content = Content::Packets(Packets::of(path, &stream)?);
        Ok(Self { path, stream, content })
    }

    fn y4m(path: &'a Path, name: &str, length: Option<u64>, mut bytes: Bytes) -> Result<Self> {
        let header = Header::read(name, &mut bytes)?;
        warn_of(Path::new(name), &header.unknown);
        Ok(Self { path, stream: header.stream(length), content: Content::Y4m(Pipe { header, bytes }) })
    }

    /// Origin that the decoder reads.
    pub fn origin(&self) -> Origin<'a> {
        match self.content {
            Content::Packets(_) => Origin::File(self.path),
            Content::Y4m(_) => Origin::Piped,
        }
    }

    /// Part that is missing of what the container promises, in words, as far as can be told before anything is decoded.
    ///
    /// # Errors
    /// The complaint of ffmpeg.
    pub fn missing(&self) -> Result<Option<String>> {
        match &self.content {
            Content::Packets(packets) => packets.missing(self.path, &self.stream),
            Content::Y4m(_) => Ok(None),
        }
    }

    /// True where so many decoded frames are fewer than there are.
    pub fn lacks(&self, decoded: u64) -> bool {
        matches!(&self.content, Content::Packets(packets) if packets.lacks(&self.stream, decoded))
    }

    /// The file that may hold sound, subtitles and metadata as well.
    pub fn more(&self) -> Option<&'a Path> {
        Some(self.path).filter(|_| matches!(self.content, Content::Packets(_)))
    }

    /// Pipe to be handed to the decoder.
    pub fn pipe(&mut self) -> Option<&mut Pipe> {
        match &mut self.content {
            Content::Packets(_) => None,
            Content::Y4m(pipe) => Some(pipe),
        }
    }
}

impl Pipe {
    /// Hands all frames on until they end, or nobody takes them. Returns what is wrong with the end.
    pub fn relay(&mut self, mut into: impl Write) -> Option<String> {
        self.header.relay(&mut self.bytes, &mut into)
    }
}
