//! Choice of the looks that are shown: words that are searched for, and tags that are wanted.

use super::entry::Entry;

/// Conditions that looks must meet to be shown.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Filter {
    /// Words; each must be in the name, a tag or the style.
    pub text: String,
    /// Tags that are all wanted.
    pub tags: Vec<String>,
    /// True where favourites alone are shown.
    pub favourites: bool,
}

impl Filter {
    /// True where everything is shown.
    pub fn is_empty(&self) -> bool {
        self.text.trim().is_empty() && self.tags.is_empty() && !self.favourites
    }

    /// True where a look is shown.
    pub fn takes(&self, entry: &Entry) -> bool {
        let tags = &entry.title.tags;
        let has_word = |word: &str| {
            let mut texts = [&entry.name, &entry.style].into_iter().chain(tags);
            texts.any(|text| text.to_lowercase().contains(word))
        };
        let text = self.text.to_lowercase();
        text.split_whitespace().all(has_word) && self.tags.iter().all(|tag| has(tags, tag))
    }

    /// Asks for a tag, or no more.
    pub fn toggle(&mut self, tag: &str) {
        let before = self.tags.len();
        self.tags.retain(|known| !known.eq_ignore_ascii_case(tag));
        if self.tags.len() == before {
            self.tags.push(tag.to_owned());
        }
    }
}

fn has(tags: &[String], tag: &str) -> bool {
    tags.iter().any(|known| known.to_lowercase() == tag.to_lowercase())
}

/// Tags with the number of looks that have them, the most frequent first.
pub fn tags<'e>(entries: impl Iterator<Item = &'e Entry>) -> Vec<(String, usize)> {
    let mut counts: Vec<(String, usize)> = Vec::new();
    for tag in entries.flat_map(|entry| &entry.title.tags) {
        let tag = tag.to_lowercase();
        match counts.iter_mut().find(|(known, _)| *known == tag) {
            Some((_, count)) => *count += 1,
            None => counts.push((tag, 1)),
        }
    }
    counts.sort_by(|(a, more), (b, less)| less.cmp(more).then_with(|| a.cmp(b)));
    counts
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::state::browser::entry::{Content, Group};
    use isophote_finishing::stylize::preset::Title;

    fn entry(name: &str, style: &str, tags: &[&str]) -> Entry {
        Entry {
            id: 1,
            group: Group::Shipped,
            source: PathBuf::from("a"),
            name: name.into(),
            style: style.into(),
            title: Title { name: None, about: None, tags: tags.iter().map(|t| (*t).to_owned()).collect() },
            content: Content::Broken("no look".into()),
        }
    }

    #[test]
    fn words_are_found_in_names_styles_and_tags_and_tags_are_all_wanted() {
        let entry = entry("Noir panel", "Cartoon", &["Dark", "comic"]);
        let filter = |text: &str, tags: &[&str]| Filter {
            text: text.into(),
            tags: tags.iter().map(|t| (*t).to_owned()).collect(),
            favourites: false,
        };
        for (text, tags) in
            [("", &[][..]), ("noir DARK", &[]), ("toon", &["dark", "comic"]), (" ", &["Comic"])]
        {
            assert!(filter(text, tags).takes(&entry), "{text} {tags:?}");
        }
        for (text, tags) in [("noir pale", &[][..]), ("", &["dark", "pale"]), ("ink", &["dark"])] {
            assert!(!filter(text, tags).takes(&entry), "{text} {tags:?}");
        }
    }

    #[test]
    fn tags_are_counted_and_switched() {
        let entries =
            [entry("a", "", &["dark", "Pale"]), entry("b", "", &["dark"]), entry("c", "", &["fine"])];
        let counted: Vec<(String, usize)> = tags(entries.iter());
        assert_eq!(counted, [("dark".into(), 2), ("fine".into(), 1), ("pale".into(), 1)]);
        let mut filter = Filter::default();
        filter.toggle("dark");
        filter.toggle("fine");
        filter.toggle("Dark");
        assert_eq!(filter.tags, ["fine"]);
        assert!(!filter.is_empty());
    }
}
