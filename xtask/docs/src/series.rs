//! Pictures of one control at several values, where a page asks for them by a mark of a line of its own:
//! `<!-- series: NODE.PARAMETER on photo: 0.2, 0.5, 0.8 -->`, or `on scene`.

use crate::error::{Error, Result};
use crate::page::{Page, escaped, to_top};
use crate::shot::{Shot, Style, Subject};
use crate::styles::{picture_at, shown};
use isophote::param::Param;
use isophote::registry;
use isophote::spec::NodeSpec;
use std::fmt::Write as _;

/// Beginning of a mark.
const MARK: &str = "<!-- series: ";

/// A control and the values that it is shown at.
struct Series {
    node: &'static NodeSpec,
    param: &'static Param,
    subject: Subject,
    values: Vec<String>,
}

impl Series {
    /// Series that the text of a mark asks for; none where that is malformed or names what is not there.
    fn parse(text: &str) -> Option<Self> {
        let (control, rest) = text.split_once(" on ")?;
        let (subject, values) = rest.split_once(": ")?;
        let (node, param) = control.split_once('.')?;
        let node = registry::find(node).ok()?;
        let (_, param) = node.param(param)?;
        let subject = [Subject::Scene, Subject::Photo].into_iter().find(|known| known.id() == subject)?;
        let values = values.split(", ").map(str::to_owned).collect();
        Some(Self { node, param, subject, values })
    }

    /// Stem of a picture that is made for the page of the style anyway.
    fn at_hand(&self, value: &str) -> Option<String> {
        let of_scene = self.subject == Subject::Scene;
        of_scene.then(|| picture_at(self.node, self.param, value)).flatten()
    }

    fn picture(&self, number: usize) -> String {
        self.at_hand(&self.values[number]).unwrap_or_else(|| self.own_picture(number))
    }

    fn own_picture(&self, number: usize) -> String {
        format!("series-{}-{}-{}-{number}", self.subject.id(), self.node.id, self.param.id)
    }

    fn shots(&self) -> impl Iterator<Item = Shot> + '_ {
        let missing = self.values.iter().enumerate().filter(|(_, value)| self.at_hand(value).is_none());
        missing.map(|(number, value)| Shot {
            name: self.own_picture(number),
            subject: self.subject,
            style: Style::Named(self.node.id.to_owned()),
            set: vec![(self.param.id, value.clone())],
        })
    }

    /// The control in words and pictures, for a page in this place.
    fn text(&self, path: &str) -> String {
        let Self { param, node, .. } = self;
        let mut text =
            format!("### {}\n\n{} `--set {}=…`\n\n<div class=\"row\">", param.label, param.doc, param.id);
        for (number, value) in self.values.iter().enumerate() {
            let as_it_is = if *value == shown(param) { ", as it is" } else { "" };
            let _ = write!(
                text,
                "<figure><img src=\"{}pictures/{}.jpg\" alt=\"{} with {} {value}\" loading=\"lazy\">\
                 <figcaption>{value}{as_it_is}</figcaption></figure>",
                to_top(path),
                self.picture(number),
                node.label,
                escaped(param.label)
            );
        }
        text.push_str("</div>\n");
        text
    }
}

/// Puts words and pictures in the place of a page's marks, and returns the pictures that are to be made.
///
/// # Errors
/// [`Error::Page`] with a mark that cannot be read.
pub fn fill(page: &mut Page) -> Result<Vec<Shot>> {
    let mut shots = Vec::new();
    let mut text = String::new();
    for line in page.text.split_inclusive('\n') {
        let Some(mark) = line.strip_prefix(MARK) else {
            text.push_str(line);
            continue;
        };
        let mark = mark.trim_end().trim_end_matches("-->").trim_end();
        let series = Series::parse(mark).ok_or_else(|| {
            Error::page(&page.path, format!("no control at values on scene or photo: {mark}"))
        })?;
        shots.extend(series.shots());
        text.push_str(&series.text(&page.path));
    }
    page.text = text;
    Ok(shots)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(text: &str) -> Page {
        let (path, title) = ("a/b".to_owned(), "B".to_owned());
        Page { path, title, part: "", text: text.to_owned(), document: None }
    }

    #[test]
    fn marks_become_pictures_and_wrong_ones_are_named() {
        let mut good = page("# A\n\n<!-- series: cartoon.detail on photo: 0.1, 0.5 -->\n\nEnd\n");
        let shots = fill(&mut good).unwrap();
        assert_eq!(shots.len(), 2);
        assert!(shots.iter().all(|shot| good.text.contains(&format!("../pictures/{}.jpg", shot.name))));
        assert!(
            good.text.ends_with("</div>\n\nEnd\n") && good.text.contains("0.5, as it is"),
            "{}",
            good.text
        );
        // The page of the style has the first, of the scene alone.
        let mut again = page("<!-- series: cartoon.texture_lines on scene: 0, 0.3 -->\n");
        assert_eq!(fill(&mut again).unwrap().len(), 1);
        assert!(again.text.contains("../pictures/style-cartoon-texture_lines-0.jpg"), "{}", again.text);
        for wrong in ["cartoon.no on photo: 1", "no.detail on photo: 1", "cartoon.detail on moon: 1"] {
            let error = fill(&mut page(&format!("<!-- series: {wrong} -->\n"))).unwrap_err().to_string();
            assert!(error.contains(wrong) && error.contains("a/b"), "{error}");
        }
    }
}
