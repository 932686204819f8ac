//! Checks that all that pages link to is there: pages, places on them, pictures; and that they load nothing from
//! elsewhere.

use crate::error::{Error, Result};
use crate::markdown::APP;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Number of things that were looked at.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Links within the site, pictures among them.
    pub inner: usize,
    /// Links to elsewhere, which nobody followed.
    pub outer: usize,
}

/// Follows every link of every page below a folder, but for links below places that are not made.
///
/// # Errors
/// [`Error::Links`] naming those that lead nowhere, and what is loaded from elsewhere.
pub fn check(site: &Path, not_made: &[&str]) -> Result<Counts> {
    let mut files = Vec::new();
    list(site, &mut files)?;
    let mut pages = BTreeMap::new();
    let app = site.join(APP);
    // The page for browsers is a program: it may have a script, and its tests are its own.
    for file in files.iter().filter(|file| file.extension().is_some_and(|e| e == "html") && **file != app) {
        pages.insert(file.clone(), std::fs::read_to_string(file).map_err(Error::at(file))?);
    }
    let names: BTreeMap<&PathBuf, BTreeSet<&str>> =
        pages.iter().map(|(file, text)| (file, values(text, "id").collect())).collect();
    let (mut counts, mut broken) = (Counts::default(), Vec::new());
    for (file, text) in &pages {
        let shown = file.strip_prefix(site).unwrap_or(file).display();
        if text.contains("<script")
            || values(text, "src").chain(values(text, "srcset")).any(|src| src.contains("//"))
        {
            broken.push(format!("{shown} loads something from elsewhere, or a script"));
        }
        for link in values(text, "href").chain(values(text, "src")).chain(values(text, "srcset")) {
            if link.contains("://") || link.starts_with("mailto:") {
                counts.outer += 1;
                continue;
            }
            let (path, anchor) = link.split_once('#').map_or((link, None), |(p, a)| (p, Some(a)));
            let target = if path.is_empty() { file.clone() } else { followed(file, path) };
            if not_made.iter().any(|place| target.starts_with(site.join(place))) {
                continue;
            }
            counts.inner += 1;
            let is_there = target.is_file()
                && anchor.is_none_or(|a| names.get(&target).is_some_and(|names| names.contains(a)));
            if !is_there {
                broken.push(format!("{shown}: {link}"));
            }
        }
    }
    if broken.is_empty() { Ok(counts) } else { Err(Error::Links(broken)) }
}

fn list(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    for entry in std::fs::read_dir(folder).map_err(Error::at(folder))? {
        let path = entry.map_err(Error::at(folder))?.path();
        if path.is_dir() {
            list(&path, files)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
}

/// The values of an attribute, wherever it stands.
fn values<'a>(html: &'a str, attribute: &str) -> impl Iterator<Item = &'a str> {
    let start = format!(" {attribute}=\"");
    let mut rest = html;
    std::iter::from_fn(move || {
        let (_, after) = rest.split_once(start.as_str())?;
        let (value, after) = after.split_once('"')?;
        rest = after;
        Some(value)
    })
}

/// A file from another by a relative path.
fn followed(from: &Path, path: &str) -> PathBuf {
    let mut target = from.to_owned();
    target.pop();
    for part in path.split('/') {
        match part {
            ".." => drop(target.pop()),
            "." => {}
            part => target.push(part),
        }
    }
    target
}

#[cfg(test)]
mod tests {
    use super::*;

    fn site(pages: &[(&str, &str)]) -> Result<Counts> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("a")).unwrap();
        for (name, text) in pages {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        check(folder.path(), &[])
    }

    #[test]
    fn links_are_followed_with_their_anchors() {
        let good = [
            (
                "index.html",
                r##"<a href="a/b.html#here">b</a> <img src="a/p.jpg"> <a href="https://x.org">x</a>"##,
            ),
            ("a/b.html", r##"<h2 id="here">H</h2><a href="../index.html">i</a><a href="#here">h</a>"##),
            ("a/p.jpg", ""),
        ];
        assert_eq!(site(&good).unwrap(), Counts { inner: 4, outer: 1 });
        for (wrong, named) in [
            (r##"<a href="c.html">c</a>"##, "a/d.html: c.html"),
            (r##"<a href="b.html#there">b</a>"##, "a/d.html: b.html#there"),
            (r##"<img src="q.jpg">"##, "a/d.html: q.jpg"),
            (r##"<source srcset="q.jpg">"##, "a/d.html: q.jpg"),
            (r##"<a href="#gone">b</a>"##, "a/d.html: #gone"),
            (r##"<img src="https://x.org/p.png">"##, "from elsewhere"),
            ("<script>1</script>", "a script"),
        ] {
            let pages: Vec<(&str, &str)> = good.iter().copied().chain([("a/d.html", wrong)]).collect();
            let error = site(&pages).unwrap_err().to_string();
            assert!(error.contains(named), "{wrong}: {error}");
        }
    }
}
