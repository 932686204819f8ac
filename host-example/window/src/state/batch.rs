//! Plan of one look on several pictures, as it is chosen before it begins.

use std::path::{Path, PathBuf};

use super::formats::{FileChoices, Replaced};
use isophote_files::identity::is_same;
use isophote_finishing::naming;
use isophote_finishing::writing::{FileKind, ResultArgs};
use isophote_pictures::write::Format;

/// Several pictures that the look is to be used on, each by itself.
#[derive(Clone, Debug)]
pub struct Batch {
    /// The pictures; at least two.
    pub pictures: Vec<PathBuf>,
    /// Pattern of the sequence that they are the frames of, where they can be that.
    pub sequence: Option<PathBuf>,
    /// Folder of the results.
    pub folder: String,
    /// Kind of the files; that of each picture where none is chosen.
    pub kind: Option<FileKind>,
    /// Size, quality and depth of the files.
    pub choices: FileChoices,
    /// Files that would be replaced, while it is asked whether they may be.
    pub asks: Option<Replaced>,
}

impl Batch {
    /// Pictures whose results go to a folder beside theirs.
    pub fn new(pictures: Vec<PathBuf>, sequence: Option<PathBuf>) -> Self {
        let own = pictures.first().and_then(|first| std::path::absolute(first).ok());
        let own = own.as_deref().and_then(Path::parent).map(Path::to_owned).unwrap_or_default();
        let name = own.file_name().unwrap_or_default().to_string_lossy().into_owned();
        // Nothing lies beside the folder of all folders.
        let folder = match name.as_str() {
            "" => own.join("stylized"),
            name => own.with_file_name(format!("{name} stylized")),
        };
        let folder = folder.display().to_string();
        Self { pictures, sequence, folder, kind: None, choices: FileChoices::default(), asks: None }
    }

    /// The kind as the writer of pictures knows it, where one is chosen.
    pub fn format(&self) -> Option<Format> {
        self.kind.and_then(|kind| Format::of(&Path::new("a").with_extension(kind.extension())).ok())
    }

    /// True where results go into the EXR files that are read, beside their other layers.
    pub fn are_among_layers(&self) -> bool {
        let is_exr = |path: &PathBuf| Format::of(path).is_ok_and(|of| of == Format::Exr);
        self.pictures.iter().any(is_exr) && matches!(self.kind, None | Some(FileKind::Exr))
    }

    /// Options of `apply`.
    pub fn options(&self) -> ResultArgs {
        let choices = if self.are_among_layers() { &FileChoices::default() } else { &self.choices };
        ResultArgs { format: self.kind, ..choices.options(self.format(), None) }
    }

    /// The results.
    fn results(&self) -> impl Iterator<Item = (&Path, PathBuf)> {
        let folder = Path::new(self.folder.trim());
        self.pictures.iter().map(move |file| (file.as_path(), naming::in_folder(folder, file, self.kind)))
    }

    /// Asks before files are replaced; says whether it may begin.
    pub fn may_begin(&mut self) -> bool {
        if self.asks.is_some() {
            return true;
        }
        let there: Vec<_> = self.results().filter(|(_, result)| result.exists()).collect();
        let is_own = there.iter().any(|(file, result)| is_same(file, result));
        self.asks = match there.len() {
            0 => None,
            _ if is_own => Some(Replaced::Original),
            count => Some(Replaced::Others(count)),
        };
        self.asks.is_none()
    }

    /// Reason why it cannot be done, in a sentence.
    pub fn problem(&self) -> Option<&'static str> {
        let folder = Path::new(self.folder.trim());
        if folder.as_os_str().is_empty() {
            return Some("Name a folder for the results.");
        }
        (folder.exists() && !folder.is_dir()).then_some("There is a file of this name, and no folder.")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_go_to_a_folder_beside_and_nothing_is_replaced_unasked() {
        let folder = tempfile::tempdir().unwrap();
        let photos = folder.path().join("holiday");
        std::fs::create_dir(&photos).unwrap();
        let files = ["a.png", "b.jpg"].map(|name| photos.join(name));
        files.iter().for_each(|file| std::fs::write(file, "x").unwrap());
        let mut batch = Batch::new(files.to_vec(), None);
        let beside = folder.path().join("holiday stylized");
        assert_eq!(Path::new(&batch.folder), beside);
        assert!(batch.problem().is_none() && batch.may_begin() && batch.options().words().is_empty());
        std::fs::create_dir(&beside).unwrap();
        std::fs::write(beside.join("b.jpg"), "x").unwrap();
        assert!(!batch.may_begin() && batch.asks == Some(Replaced::Others(1)));
        (batch.asks, batch.kind) = (None, Some(FileKind::Tiff));
        assert!(batch.may_begin(), "other names are free");
        (batch.folder, batch.kind) = (photos.display().to_string(), None);
        assert!(!batch.may_begin() && batch.asks == Some(Replaced::Original));
        batch.folder = files[0].display().to_string();
        assert!(batch.problem().is_some());
        batch.kind = Some(FileKind::Jpeg);
        batch.choices.quality = 60;
        assert_eq!(batch.options().words().join(" "), "--quality 60 --format jpeg");
    }
}
