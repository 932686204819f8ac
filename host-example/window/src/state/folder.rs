//! Files beside the one that is open: those of its folder that the window can open, in the order in which people count.

use std::cmp::Ordering;
use std::collections::HashMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::document::kind;
use isophote_files::frames;

/// Files of the folder of the one that is open, and steps from one to the next.
#[derive(Debug, Default)]
pub struct Beside {
    /// The files, once they are known, with the one that they were read for.
    known: Option<(PathBuf, Vec<PathBuf>)>,
    /// The file that is open or about to be.
    at: Option<PathBuf>,
    /// Steps that were asked for before the files were known.
    steps: i64,
    /// Patterns of numbered pictures of which one was opened by itself: they count one by one.
    apart: Vec<PathBuf>,
}

impl Beside {
    /// Another file is open.
    pub fn open(&mut self, file: Option<&Path>, is_picture: bool) {
        self.at = file.map(Path::to_owned);
        self.steps = 0;
        if let Some(pattern) = self.at.as_deref().filter(|_| is_picture).and_then(pattern)
            && !self.apart.contains(&pattern)
        {
            self.apart.push(pattern);
        }
    }

    /// Patterns of numbered pictures that count one by one.
    pub fn apart(&self) -> &[PathBuf] {
        &self.apart
    }

    /// Takes over the files beside one; returns the file that is to be opened, if there is one.
    pub fn take(&mut self, of: PathBuf, files: Vec<PathBuf>) -> Option<PathBuf> {
        self.known = Some((of, files));
        let steps = std::mem::take(&mut self.steps);
        if steps == 0 { None } else { self.step(steps) }
    }

    /// Goes so many files on; returns the file that is to be opened. At the ends there is none.
    pub fn step(&mut self, by: i64) -> Option<PathBuf> {
        let Some((index, count)) = self.place() else {
            self.steps += by;
            return None;
        };
        let wanted = (index as i64 + by).clamp(0, count as i64 - 1) as usize;
        let (_, files) = self.known.as_ref()?;
        let file = files.get(wanted).filter(|_| wanted != index)?.clone();
        self.at = Some(file.clone());
        Some(file)
    }

    /// Index of the file that is open, and the number of all.
    pub fn place(&self) -> Option<(usize, usize)> {
        let ((_, files), at) = (self.known.as_ref()?, self.at.as_ref()?);
        let index = files.iter().position(|file| file == at)?;
        Some((index, files.len()))
    }
}

/// Files of these names in the folder of `file` that can be opened. Numbered pictures count as one, which is their pattern, but
/// for those that are `apart`.
pub fn files(file: &Path, names: Vec<OsString>, apart: &[PathBuf]) -> Vec<PathBuf> {
    let paths = names.into_iter().filter(|name| !name.to_string_lossy().starts_with('.'));
    let paths: Vec<PathBuf> = paths.map(|name| file.with_file_name(name)).collect();
    let mut counts: HashMap<PathBuf, usize> = HashMap::new();
    for pattern in paths.iter().filter_map(|path| pattern(path)) {
        *counts.entry(pattern).or_default() += 1;
    }
    let together = |path: &Path| {
        let pattern = pattern(path)?;
        (counts[&pattern] > 1 && !apart.contains(&pattern)).then_some(pattern)
    };
    let known = paths.iter().filter(|path| kind::is_known(path));
    let mut files: Vec<PathBuf> = known.map(|path| together(path).unwrap_or_else(|| path.clone())).collect();
    files.sort_by(|a, b| natural(&name(a), &name(b)));
    files.dedup();
    files
}

/// Pattern of a numbered picture.
fn pattern(path: &Path) -> Option<PathBuf> {
    Some(path.with_file_name(frames::numbered(path.file_name()?)?))
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Order of names as people count: numbers within by what they are, letters whatever their case.
fn natural(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a, b);
    while let (Some(one), Some(other)) = (left.chars().next(), right.chars().next()) {
        let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
        let counts = [digits(left), digits(right)];
        let order = if counts.iter().all(|count| *count > 0) {
            let [x, y] = [&left[..counts[0]], &right[..counts[1]]].map(|text| text.trim_start_matches('0'));
            (left, right) = (&left[counts[0]..], &right[counts[1]..]);
            x.len().cmp(&y.len()).then_with(|| x.cmp(y))
        } else {
            (left, right) = (&left[one.len_utf8()..], &right[other.len_utf8()..]);
            one.to_lowercase().cmp(other.to_lowercase())
        };
        if order != Ordering::Equal {
            return order;
        }
    }
    left.len().cmp(&right.len()).then_with(|| a.cmp(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(names: &[&str], apart: &[&str]) -> Vec<String> {
        let names = names.iter().map(OsString::from).collect();
        let apart: Vec<PathBuf> = apart.iter().map(|name| Path::new("/f").join(name)).collect();
        files(Path::new("/f/a.png"), names, &apart).iter().map(|file| name(file)).collect()
    }

    #[test]
    fn people_count_before_letters() {
        let names = ["img10.png", "IMG2.PNG", "b.glb", "img2a.png", "notes.txt", "look.json", ".hidden.png"];
        assert_eq!(listed(&names, &[]), ["b.glb", "IMG2.PNG", "img2a.png", "img10.png"]);
        assert_eq!(natural("a01", "a1"), Ordering::Less, "the text tells then");
        assert_eq!(natural("ä9", "ä10"), Ordering::Less);
    }

    #[test]
    fn numbered_pictures_count_as_one_unless_one_was_opened() {
        let names = ["z.mp4", "shot.0002.exr", "shot.0001.exr", "a.png", "shot.0010.exr", "one.0001.png"];
        assert_eq!(listed(&names, &[]), ["a.png", "one.0001.png", "shot.####.exr", "z.mp4"]);
        let apart = ["a.png", "one.0001.png", "shot.0001.exr", "shot.0002.exr", "shot.0010.exr", "z.mp4"];
        assert_eq!(listed(&names, &["shot.####.exr"]), apart);
    }

    #[test]
    fn steps_end_at_both_ends_and_wait_for_what_is_not_known() {
        let paths = ["/f/a.png", "/f/b.png", "/f/c.png"].map(PathBuf::from);
        let mut beside = Beside::default();
        beside.open(Some(&paths[0]), true);
        assert_eq!(beside.step(1), None);
        assert_eq!(beside.take(paths[0].clone(), paths.to_vec()), Some(paths[1].clone()));
        assert_eq!(beside.step(1), Some(paths[2].clone()), "what cannot be opened is passed by, too");
        assert_eq!((beside.step(1), beside.place()), (None, Some((2, 3))));
        beside.open(Some(&paths[1]), true);
        assert_eq!(beside.step(-1), Some(paths[0].clone()));
    }
}
