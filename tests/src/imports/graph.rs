//! Files, what each imports, and the circles.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Imports of files: from the importing file to the other, and the line and the words of each import.
#[derive(Debug, Default)]
pub struct Imports(BTreeMap<PathBuf, BTreeMap<PathBuf, BTreeSet<(usize, String)>>>);

impl Imports {
    /// Takes down that `from` imports `path` from `to`; a file's own modules are none.
    pub fn add(&mut self, from: &Path, to: &Path, line: usize, path: &str) {
        if from != to {
            let targets = self.0.entry(from.to_owned()).or_default();
            targets.entry(to.to_owned()).or_default().insert((line, path.to_owned()));
        }
    }

    fn targets(&self, file: &Path) -> impl Iterator<Item = &Path> {
        self.0.get(file).into_iter().flat_map(|targets| targets.keys().map(PathBuf::as_path))
    }

    /// All files that can be reached from `file` by imports.
    fn reached<'s>(&'s self, file: &'s Path) -> BTreeSet<&'s Path> {
        let mut found = BTreeSet::new();
        let mut open = vec![file];
        while let Some(next) = open.pop() {
            open.extend(self.targets(next).filter(|target| found.insert(*target)));
        }
        found
    }

    /// A report for each group of files of which every one reaches every other.
    pub fn circles(&self, root: &Path) -> Vec<String> {
        let reached: BTreeMap<&Path, BTreeSet<&Path>> =
            self.0.keys().map(|file| (file.as_path(), self.reached(file))).collect();
        let mut seen: BTreeSet<&Path> = BTreeSet::new();
        let mut reports = Vec::new();
        for (file, targets) in &reached {
            if !targets.contains(file) || seen.contains(file) {
                continue;
            }
            let others = targets.iter().filter(|t| reached.get(*t).is_some_and(|back| back.contains(file)));
            let members: BTreeSet<&Path> = others.copied().collect();
            seen.extend(&members);
            reports.push(self.report(root, &members));
        }
        reports
    }

    /// The same of the files and folders that lie in one folder: what a file imports of another counts for the folders that
    /// they lie in, as far as these are two. `name.rs` and the folder `name` are one; the file that a folder's modules are
    /// declared in is none of them.
    pub fn of_folders(&self) -> Self {
        let mut folders = Self::default();
        for (from, targets) in &self.0 {
            for (to, uses) in targets {
                let Some((own, other)) = parted(from, to) else { continue };
                for (line, path) in uses {
                    let file = from.file_name().unwrap_or_default().display();
                    folders.add(&own, &other, *line, &format!("{file}: {path}"));
                }
            }
        }
        folders
    }

    /// Imports of files in the folder `from` below `root` from files in the folder `to`.
    pub fn between(&self, root: &Path, from: &str, to: &str) -> Vec<[PathBuf; 2]> {
        let (from, to) = (root.join(from), root.join(to));
        let importing = self.0.iter().filter(|(file, _)| file.starts_with(&from));
        let pairs = importing.flat_map(|(file, targets)| targets.keys().map(move |target| (file, target)));
        let pairs = pairs.filter(|(_, target)| target.starts_with(&to));
        pairs.map(|(file, target)| [file.clone(), target.clone()]).collect()
    }

    fn report(&self, root: &Path, members: &BTreeSet<&Path>) -> String {
        let short = |path: &Path| path.strip_prefix(root).unwrap_or(path).display().to_string();
        let mut text = members.iter().map(|file| short(file)).collect::<Vec<_>>().join(", ");
        for from in members {
            for (to, uses) in self.0.get(*from).into_iter().flatten() {
                if members.contains(to.as_path()) {
                    let uses: Vec<_> =
                        uses.iter().map(|(line, path)| format!("{path} in line {line}")).collect();
                    let _ =
                        write!(text, "\n  {} imports from {}: {}", short(from), short(to), uses.join(", "));
                }
            }
        }
        text
    }
}

/// The paths of two files up to where they part, without the ending; nothing where they do not, or where one of them
/// declares the modules of the folder that both lie in.
fn parted(a: &Path, b: &Path) -> Option<(PathBuf, PathBuf)> {
    let mut common = PathBuf::new();
    let (mut own, mut other) = (a.components(), b.components());
    loop {
        let (own, other) = (Path::new(own.next()?.as_os_str()), Path::new(other.next()?.as_os_str()));
        let (own, other) = (own.with_extension(""), other.with_extension(""));
        if own != other {
            let declares = |name: &Path| ["lib", "main", "mod"].iter().any(|root| name == Path::new(root));
            return (!declares(&own) && !declares(&other)).then(|| (common.join(own), common.join(other)));
        }
        common.push(own);
    }
}
