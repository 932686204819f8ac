//! Plan of an export, as it is chosen before it begins.

use std::path::{Path, PathBuf};

use super::document::Frames;
use super::document::kind::Kind;
use isophote_files::frames;
use isophote_finishing::video;

/// Frames of a turntable, unless others are asked for.
const TURN: u32 = 96;
/// Extensions of videos.
const VIDEOS: [&str; 4] = ["mp4", "mov", "mkv", "webm"];

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
    /// Extension of the result.
    pub format: &'static str,
    /// Number of the first frame.
    pub first: i64,
    /// Number of the last frame.
    pub last: i64,
    /// Frames that there are.
    pub numbers: Vec<i64>,
    /// Frames of a turntable and of an animation.
    pub counts: [u32; 2],
    /// Pixels across and down, of scenes.
    pub size: [u32; 2],
    /// The file, or the pattern of the files.
    pub path: String,
}

impl Plan {
    /// A picture of what is open, or all of its frames, beside it. `size` is that of a scene on the screen, `frames` are those
    /// of its animation.
    pub fn new(kind: Kind, input: &Path, numbers: Option<Frames>, size: (u32, u32), frames: u32) -> Self {
        let numbers = numbers.map(|frames| frames.numbers).unwrap_or_default();
        let stem = input.file_stem().unwrap_or_default().to_string_lossy();
        let stem = stem.split(['.', '#', '@', '%']).next().unwrap_or_default().trim_end_matches(['_', '-']);
        let stem = if stem.is_empty() { "picture" } else { stem };
        let mut plan = Self {
            kind,
            what: What::Picture,
            format: "",
            first: numbers.first().copied().unwrap_or(1),
            last: numbers.last().copied().unwrap_or(1),
            numbers: numbers.to_vec(),
            counts: [TURN, frames],
            size: [size.0, size.1],
            path: input.with_file_name(format!("{stem}-look")).display().to_string(),
        };
        let own = input.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let own = if own == "tiff" || own == "jpeg" {
            own.replace("tiff", "tif").replace("jpeg", "jpg")
        } else {
            own
        };
        plan.what = plan.choices()[0];
        plan.format = plan.formats().iter().find(|format| **format == own).unwrap_or(&plan.formats()[0]);
        plan.rename();
        plan
    }

    /// Results that can be made.
    pub fn choices(&self) -> &'static [What] {
        match self.kind {
            Kind::Scene if self.counts[1] > 0 => &[What::Picture, What::Turntable, What::Animation],
            Kind::Scene => &[What::Picture, What::Turntable],
            Kind::Picture => &[What::Picture],
            Kind::Sequence | Kind::Video => &[What::Frames],
        }
    }

    /// The extensions that it may have.
    pub fn formats(&self) -> &'static [&'static str] {
        match (self.kind, self.what) {
            (Kind::Scene, What::Picture) => &["png", "exr"],
            (Kind::Scene, _) => &["png", "exr", "mp4", "mov", "mkv", "webm"],
            (Kind::Picture, _) => &["png", "jpg", "tif", "exr"],
            (Kind::Sequence, _) => &["png", "jpg", "tif", "exr", "mp4", "mov", "mkv", "webm"],
            (Kind::Video, _) => &VIDEOS,
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
        let known = |extension: &str| {
            VIDEOS.contains(&extension) || ["png", "jpg", "jpeg", "tif", "tiff", "exr"].contains(&extension)
        };
        let path = PathBuf::from(&self.path);
        let has_extension =
            path.extension().and_then(|e| e.to_str()).is_some_and(|e| known(&e.to_lowercase()));
        let bare = if has_extension { path.with_extension("") } else { path };
        let bare = bare.display().to_string();
        let bare = bare.trim_end_matches('#').trim_end_matches('.');
        let numbers = if self.is_several_files() { ".####" } else { "" };
        self.path = format!("{bare}{numbers}.{}", self.format);
    }

    /// True where every frame becomes a file.
    pub fn is_several_files(&self) -> bool {
        self.what != What::Picture && !VIDEOS.contains(&self.format)
    }

    /// True where a file is there already that would be replaced.
    pub fn replaces(&self) -> bool {
        !self.is_several_files() && Path::new(&self.path).exists()
    }

    /// Frames, as `--frames` takes them; nothing for all that there are.
    pub fn frames(&self) -> Option<String> {
        match self.what {
            What::Turntable => Some(self.counts[0].to_string()),
            What::Animation => Some(self.counts[1].to_string()),
            What::Frames if self.kind == Kind::Sequence => {
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
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        if !self.formats().contains(&extension.as_str()) && extension != "jpeg" && extension != "tiff" {
            return Some("The name has another extension than can be made.");
        }
        if video::becomes_video(path) && self.kind != Kind::Video && !VIDEOS.contains(&self.format) {
            return Some("Choose a video above, or name a picture.");
        }
        if self.what == What::Frames && self.first > self.last {
            return Some("The last frame comes before the first.");
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_follow_what_is_made() {
        let mut plan = Plan::new(Kind::Scene, Path::new("/a/house.gltf"), None, (640, 480), 48);
        assert_eq!((plan.path.as_str(), plan.frames()), ("/a/house-look.png", None));
        plan.choose(What::Turntable);
        assert_eq!((plan.path.as_str(), plan.frames().as_deref()), ("/a/house-look.####.png", Some("96")));
        plan.format = "mp4";
        plan.rename();
        assert_eq!(plan.path, "/a/house-look.mp4");
        plan.choose(What::Picture);
        assert_eq!(plan.path, "/a/house-look.png");
        plan.path = "/none/such.png".into();
        assert_eq!(plan.problem(), Some("There is no such folder."));
        let photo = Plan::new(Kind::Picture, Path::new("b.c.JPEG"), None, (1, 1), 0);
        assert_eq!(photo.path, "b-look.jpg");
    }

    #[test]
    fn some_frames_are_named_and_all_are_not() {
        let frames = Frames { numbers: vec![7, 8, 10, 11].into(), cached: Vec::new(), rate: 24.0 };
        let mut plan = Plan::new(Kind::Sequence, Path::new("shot.####.exr"), Some(frames), (1, 1), 0);
        assert_eq!((plan.path.as_str(), plan.frames()), ("shot-look.####.exr", None));
        (plan.first, plan.last) = (8, 10);
        assert_eq!(plan.frames().as_deref(), Some("8,10"));
        plan.last = 7;
        assert!(plan.problem().is_some());
    }
}
