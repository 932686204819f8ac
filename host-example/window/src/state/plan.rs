//! Plan of an export, as it is chosen before it begins.

use std::path::{Path, PathBuf};

use super::document::Frames;
use super::document::kind::Kind;
use super::formats::{FileChoices, FileFormat, PICTURES, RENDERS, Replaced, VIDEOS, usual_extension};
use isophote_files::frames::{self, Pattern};
use isophote_files::identity::is_same;
use isophote_finishing::writing::ResultArgs;
use isophote_pictures::write::Format;

/// Frames of a turntable, unless others are asked for.
const TURN: u32 = 96;

/// Result that is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// One picture.
    Picture,
    /// All frames, or some.
    Frames,
    /// The camera goes once around a scene.
    Turntable,
    /// A scene's animation.
    Animation,
}

impl What {
    /// Name for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Picture => "A picture",
            Self::Frames => "Frames",
            Self::Turntable => "A turntable",
            Self::Animation => "The animation",
        }
    }
}

/// Plan of an export of the document that is open.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Kind of the document that is open.
    pub kind: Kind,
    /// Result that is made.
    pub what: What,
    /// Kind of the result's file.
    pub format: FileFormat,
    /// Number of the first frame.
    pub first: i64,
    /// Number of the last frame.
    pub last: i64,
    /// Frames that there are.
    pub numbers: Vec<i64>,
    /// Frames of a turntable and of an animation.
    pub counts: [u32; 2],
    /// Frames per second of a video that is made of frames.
    pub rate: f64,
    /// Pixels across and down, of scenes.
    pub size: [u32; 2],
    /// Size, quality and depth of the files.
    pub choices: FileChoices,
    /// The file, or the pattern of the files.
    pub path: String,
    /// Files that would be replaced, while it is asked whether they may be.
    pub asks: Option<Replaced>,
    /// The document.
    input: PathBuf,
}

impl Plan {
    /// A picture of what is open, or all of its frames, beside it. `size` is that of a scene on the screen, `frames` are those
    /// of its animation.
    pub fn new(kind: Kind, input: &Path, numbers: Option<Frames>, size: (u32, u32), frames: u32) -> Self {
        let rate = numbers.as_ref().map_or(24.0, |frames| frames.rate);
        let numbers = numbers.map(|frames| frames.numbers).unwrap_or_default();
        let stem = input.file_stem().unwrap_or_default().to_string_lossy();
        let stem = stem.split(['.', '#', '@', '%']).next().unwrap_or_default().trim_end_matches(['_', '-']);
        let stem = if stem.is_empty() { "picture" } else { stem };
        let mut plan = Self {
            kind,
            what: What::Picture,
            format: PICTURES[0],
            first: numbers.first().copied().unwrap_or(1),
            last: numbers.last().copied().unwrap_or(1),
            numbers: numbers.to_vec(),
            counts: [TURN, frames],
            rate,
            size: [size.0, size.1],
            choices: FileChoices::default(),
            path: input.with_file_name(format!("{stem}-look")).display().to_string(),
            asks: None,
            input: input.to_owned(),
        };
        plan.what = plan.results()[0];
        plan.format = plan.format_of(input).unwrap_or(plan.formats()[0]);
        plan.rename();
        plan
    }

    /// Results that can be made.
    pub fn results(&self) -> &'static [What] {
        match self.kind {
            Kind::Scene if self.counts[1] > 0 => &[What::Picture, What::Turntable, What::Animation],
            Kind::Scene => &[What::Picture, What::Turntable],
            Kind::Picture => &[What::Picture],
            Kind::Sequence | Kind::Video => &[What::Frames],
        }
    }

    /// The kinds of files that it can become.
    pub fn formats(&self) -> Vec<FileFormat> {
        match (self.kind, self.what) {
            (Kind::Scene, What::Picture) => RENDERS.to_vec(),
            (Kind::Scene, _) => [&RENDERS[..], &VIDEOS].concat(),
            (Kind::Picture, _) => PICTURES.to_vec(),
            (Kind::Sequence, _) => [&PICTURES[..], &VIDEOS].concat(),
            (Kind::Video, _) => [&VIDEOS[..], &PICTURES].concat(),
        }
    }

    /// The first of these kinds that has the extension of a file.
    fn format_of(&self, file: &Path) -> Option<FileFormat> {
        let extension = usual_extension(&file.extension()?.to_string_lossy());
        self.formats().into_iter().find(|format| format.extension == extension)
    }

    /// Name of a kind for people.
    pub fn name_of(&self, format: FileFormat) -> String {
        match self.what == What::Picture || format.is_video {
            true => format.name.to_owned(),
            false => format!("{}, numbered", format.name),
        }
    }

    /// Makes something else.
    pub fn choose(&mut self, what: What) {
        self.what = what;
        if !self.formats().contains(&self.format) {
            self.format = self.formats()[0];
        }
        self.rename();
    }

    /// Gives the result the name that what it is asks for: an extension, and a place for numbers.
    pub fn rename(&mut self) {
        let path = PathBuf::from(&self.path);
        let extension = path.extension().map(|extension| usual_extension(&extension.to_string_lossy()));
        let known = PICTURES.iter().chain(&VIDEOS).map(|format| format.extension);
        let has_extension =
            extension.is_some_and(|extension| known.into_iter().any(|known| known == extension));
        let bare = if has_extension { path.with_extension("") } else { path };
        let bare = bare.display().to_string();
        let bare = bare.trim_end_matches('#').trim_end_matches('.');
        let numbers = if self.is_several_files() { ".####" } else { "" };
        self.path = format!("{bare}{numbers}.{}", self.format.extension);
        self.asks = None;
    }

    /// Follows a name that was typed: its extension says which kind of file is meant.
    pub fn follow_name(&mut self) {
        let named = PathBuf::from(&self.path);
        let is_other = named
            .extension()
            .is_some_and(|extension| usual_extension(&extension.to_string_lossy()) != self.format.extension);
        if let Some(format) = self.format_of(&named).filter(|_| is_other) {
            self.format = format;
        }
        self.asks = None;
    }

    /// Takes the file that was chosen in a dialog of the system, which may lack its extension or the place for numbers.
    pub fn place(&mut self, file: &Path) {
        self.path = file.display().to_string();
        self.follow_name();
        if !self.is_several_files() || Pattern::in_name(file).is_ok_and(|pattern| pattern.is_none()) {
            self.rename();
        }
    }

    /// True where every frame becomes a file.
    pub fn is_several_files(&self) -> bool {
        self.what != What::Picture && !self.format.is_video
    }

    /// True where frames become a video, whose rate can be chosen.
    pub fn has_rate(&self) -> bool {
        self.kind == Kind::Sequence && self.format.is_video
            || self.kind == Kind::Scene && self.what != What::Picture
    }

    /// True where its frames can be a part of those that there are.
    pub fn has_range(&self) -> bool {
        !self.numbers.is_empty()
            && (self.kind == Kind::Sequence || self.kind == Kind::Video && !self.format.is_video)
    }

    /// True where it goes into the EXR file that is read, beside its other layers.
    pub fn is_among_layers(&self) -> bool {
        self.format.written() == Some(Format::Exr)
            && Format::of(&self.input).is_ok_and(|of| of == Format::Exr)
    }

    /// Size and kind of its files as options of `apply`.
    pub fn options(&self) -> ResultArgs {
        match (self.kind, self.is_among_layers()) {
            (Kind::Scene, _) => {
                let options = self.choices.options(self.format.written(), self.format.codec);
                ResultArgs { file: options.file, ..ResultArgs::default() }
            }
            (_, true) => ResultArgs::default(),
            _ => self.choices.options(self.format.written(), self.format.codec),
        }
    }

    /// Files that are there already and would be replaced.
    pub fn replaced(&self) -> Option<Replaced> {
        let path = Path::new(&self.path);
        if !self.is_several_files() {
            let is_own = path.exists() && is_same(path, &self.input);
            let other = path.exists().then_some(Replaced::Others(1));
            return if is_own { Some(Replaced::Original) } else { other };
        }
        let to = Pattern::or_added(path).ok()?;
        let there = to.on_disk().ok()?;
        let made = |number: &&i64| match (self.kind, self.what) {
            (Kind::Scene, What::Animation) => (1..=i64::from(self.counts[1])).contains(*number),
            (Kind::Scene, _) => (1..=i64::from(self.counts[0])).contains(*number),
            _ => (self.first..=self.last).contains(*number),
        };
        let replaced: Vec<i64> = there.iter().filter(made).copied().collect();
        let from = Pattern::new(&self.input).ok().flatten();
        let is_own =
            |number: &i64| from.as_ref().is_some_and(|from| is_same(&from.file(*number), &to.file(*number)));
        match replaced.len() {
            0 => None,
            _ if replaced.iter().any(is_own) => Some(Replaced::Original),
            count => Some(Replaced::Others(count)),
        }
    }

    /// Asks before files are replaced; says whether it may begin.
    pub fn may_begin(&mut self) -> bool {
        if self.asks.is_none() {
            self.asks = self.replaced();
            return self.asks.is_none();
        }
        true
    }

    /// Frames, as `--frames` takes them; nothing for all that there are.
    pub fn frames(&self) -> Option<String> {
        match self.what {
            What::Turntable => Some(self.counts[0].to_string()),
            What::Animation => Some(self.counts[1].to_string()),
            What::Frames if self.has_range() => {
                let chosen = |number: &&i64| (self.first..=self.last).contains(*number);
                let some: Vec<i64> = self.numbers.iter().filter(chosen).copied().collect();
                (some.len() < self.numbers.len()).then(|| frames::range_expression(&some))
            }
            What::Frames | What::Picture => None,
        }
    }

    /// Reason why it cannot be made, in a sentence.
    pub fn problem(&self) -> Option<&'static str> {
        let path = Path::new(&self.path);
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        if path.file_name().is_none() {
            return Some("It has no name.");
        }
        if folder.is_some_and(|folder| !folder.is_dir()) {
            return Some("There is no such folder.");
        }
        let extension = usual_extension(&path.extension().unwrap_or_default().to_string_lossy());
        if extension != self.format.extension {
            return Some("The name has another extension than can be made.");
        }
        if self.has_range() && self.first > self.last {
            return Some("The last frame comes before the first.");
        }
        if self.kind == Kind::Video && self.replaced() == Some(Replaced::Original) {
            return Some("A video cannot take its own place. Choose another name.");
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::formats::Scaling;
    use isophote_finishing::writing::{Codec, Depth};

    #[test]
    fn names_follow_what_is_made() {
        let mut plan = Plan::new(Kind::Scene, Path::new("/a/house.gltf"), None, (640, 480), 48);
        // As paths: the system joins them with what it likes.
        let path = |plan: &Plan| PathBuf::from(&plan.path);
        assert_eq!((path(&plan), plan.frames()), ("/a/house-look.png".into(), None));
        plan.choose(What::Turntable);
        assert_eq!((path(&plan), plan.frames().as_deref()), ("/a/house-look.####.png".into(), Some("96")));
        plan.format = VIDEOS[0];
        plan.rename();
        assert_eq!(path(&plan), Path::new("/a/house-look.mp4"));
        plan.choose(What::Picture);
        assert_eq!(path(&plan), Path::new("/a/house-look.png"));
        plan.path = "/none/such.png".into();
        assert_eq!(plan.problem(), Some("There is no such folder."));
        let photo = Plan::new(Kind::Picture, Path::new("b.c.JPEG"), None, (1, 1), 0);
        assert_eq!(photo.path, "b-look.jpg");
    }

    #[test]
    fn the_kind_of_file_follows_the_name() {
        let mut photo = Plan::new(Kind::Picture, Path::new("b.png"), None, (1, 1), 0);
        photo.path = "c.JPEG".into();
        photo.follow_name();
        assert_eq!((photo.format.name, photo.problem()), ("JPEG", None));
        photo.place(Path::new("d"));
        assert_eq!(photo.path, "d.jpg");
        photo.place(Path::new("d.tif"));
        assert_eq!((photo.path.as_str(), photo.format.name), ("d.tif", "TIFF"));
        photo.path = "d.mp4".into();
        photo.follow_name();
        assert!(photo.problem().is_some());
    }

    #[test]
    fn some_frames_are_named_and_all_are_not() {
        let frames = Frames { numbers: vec![7, 8, 10, 11].into(), cached: Vec::new(), rate: 12.0 };
        let mut plan = Plan::new(Kind::Sequence, Path::new("shot.####.exr"), Some(frames), (1, 1), 0);
        assert_eq!((plan.path.as_str(), plan.frames()), ("shot-look.####.exr", None));
        (plan.first, plan.last) = (8, 10);
        assert_eq!(plan.frames().as_deref(), Some("8,10"));
        plan.last = 7;
        assert!(plan.problem().is_some());
        assert!(plan.rate == 12.0 && !plan.has_rate() && plan.is_among_layers());
        plan.format = VIDEOS[3];
        plan.rename();
        assert!(plan.has_rate() && plan.path == "shot-look.mov");
        assert_eq!(plan.options().words(), ["--codec", Codec::Prores.id()]);
    }

    #[test]
    fn what_is_chosen_becomes_options_and_what_is_usual_does_not() {
        let mut photo = Plan::new(Kind::Picture, Path::new("b.jpg"), None, (1, 1), 0);
        assert!(photo.options().words().is_empty());
        photo.choices = FileChoices { quality: 70, depth: Some(Depth::Sixteen), ..photo.choices };
        assert_eq!(photo.options().words(), ["--quality", "70"]);
        photo.format = PICTURES[0];
        photo.choices.scaling = Scaling::Half;
        assert_eq!(photo.options().words().join(" "), "--depth 16 --resize 50%");
    }

    #[test]
    fn what_is_there_is_asked_for_and_the_original_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["a.png", "b.png", "s.0001.png", "s.0002.png"] {
            std::fs::write(at(name), "x").unwrap();
        }
        let mut plan = Plan::new(Kind::Picture, &at("a.png"), None, (1, 1), 0);
        assert!(plan.may_begin() && plan.asks.is_none());
        plan.place(&at("b.png"));
        assert!(!plan.may_begin() && plan.asks == Some(Replaced::Others(1)));
        assert!(plan.may_begin(), "it was asked");
        plan.place(&at("a.png"));
        assert!(!plan.may_begin() && plan.asks == Some(Replaced::Original));
        let frames = Frames { numbers: vec![1, 2].into(), cached: Vec::new(), rate: 24.0 };
        let mut plan = Plan::new(Kind::Sequence, &at("s.####.png"), Some(frames), (1, 1), 0);
        assert_eq!(plan.replaced(), None);
        plan.place(&at("s.####.png"));
        assert_eq!(plan.replaced(), Some(Replaced::Original));
    }
}
