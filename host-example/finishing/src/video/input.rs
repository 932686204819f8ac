//! A video that is read from its first frame to its last: a file, YUV4MPEG on standard input, or animated WebP.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::Path;

use super::container::{is_moving_webp, is_pipe};
use super::decode::Origin;
use super::packets::Packets;
use super::probe::{probe, warn_of, warn_of_fields};
use super::stream::Stream;
use super::timed::Times;
use super::webp::Webp;
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
    /// Frames that are handed to ffmpeg one by one.
    Pipe(Pipe),
}

/// Frames on their way to ffmpeg.
pub enum Pipe {
    /// A YUV4MPEG stream after its first line.
    Y4m(Header, Bytes),
    /// Animated WebP.
    Webp(Webp),
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
        if is_moving_webp(path) {
            let webp = Webp::open(path)?;
            return Ok(Self { path, stream: webp.stream(), content: Content::Pipe(Pipe::Webp(webp)) });
        }
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
        let stream = header.stream(length);
        warn_of_fields(Path::new(name), &stream);
        Ok(Self { path, stream, content: Content::Pipe(Pipe::Y4m(header, bytes)) })
    }

    /// Origin that the decoder reads.
    pub fn origin(&self) -> Origin<'a> {
        match &self.content {
            Content::Packets(_) => Origin::File(self.path),
            Content::Pipe(Pipe::Y4m(..)) => Origin::Piped,
            Content::Pipe(Pipe::Webp(webp)) => Origin::Raw(webp.size()),
        }
    }

    /// Part that is missing of what the container promises, in words, as far as can be told before anything is decoded.
    ///
    /// # Errors
    /// The complaint of ffmpeg.
    pub fn missing(&self) -> Result<Option<String>> {
        match &self.content {
            Content::Packets(packets) => packets.missing(self.path, &self.stream),
            Content::Pipe(_) => Ok(None),
        }
    }

    /// True where so many decoded frames are fewer than there are.
    pub fn lacks(&self, decoded: u64) -> bool {
        match &self.content {
            Content::Packets(packets) => packets.lacks(&self.stream, decoded),
            Content::Pipe(Pipe::Webp(_)) => decoded < self.stream.frames,
            Content::Pipe(Pipe::Y4m(..)) => false,
        }
    }

    /// The file that may hold sound, subtitles and metadata as well, and when its pictures begin.
    pub fn more(&self) -> Option<(&'a Path, f64)> {
        match &self.content {
            Content::Packets(packets) => Some((self.path, packets.first())),
            Content::Pipe(_) => None,
        }
    }

    /// Times of frames that do not last equally long; nothing for others.
    ///
    /// # Errors
    /// The complaint of ffmpeg.
    pub fn times(&self) -> Result<Option<Times>> {
        match &self.content {
            Content::Packets(packets) => {
                let shown = packets.uneven(self.path, &self.stream)?;
                Ok(shown.map(|shown| Times { shown, last: packets.last_length() }))
            }
            Content::Pipe(Pipe::Webp(webp)) => Ok(webp.times()),
            Content::Pipe(Pipe::Y4m(..)) => Ok(None),
        }
    }

    /// Pipe to be handed to the decoder.
    pub fn pipe(&mut self) -> Option<&mut Pipe> {
        match &mut self.content {
            Content::Packets(_) => None,
            Content::Pipe(pipe) => Some(pipe),
        }
    }
}

impl Pipe {
    /// Hands all frames on until they end, or nobody takes them. Returns what is wrong with the end.
    pub fn relay(&mut self, mut into: impl Write) -> Option<String> {
        match self {
            Self::Y4m(header, bytes) => header.relay(bytes, &mut into),
            Self::Webp(webp) => webp.relay(&mut into),
        }
    }
}
