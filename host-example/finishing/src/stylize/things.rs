//! Rules of a preset for things that ask for more than a control map: looks of their own, and colours of lines.

use std::path::Path;

use serde_json::Value;

use super::palette::Colours;
use super::preset::{self, ObjectRule, Preset};
use super::style::{FIX, Setting, Style, graph_beside};
use isophote_files::error::{AtPlace, Error, Result};
use isophote_loader::Library;
use isophote_loader::catalogue::Kind;
use isophote_pictures::exr::{Guide, MaskSource};

/// Key of a rule for the look that its things have.
const LOOK: &str = "look";
/// Key of a rule for the colour of lines, and the parameter of styles that it sets.
const LINE_COLOR: &str = "line_color";

/// Parameter of styles that may draw kinds of lines in colours of their own, and its value where all have one.
const LINE_COLORS: &str = "line_colors";
const ONE: &str = "one";

/// True where a rule gives its things a look of their own.
fn has_look(rule: &ObjectRule) -> bool {
    rule.rule.contains_key(LOOK)
}

/// Colour of the lines of a rule's things in the preset's own look, gamma-encoded RGBA, if they have one.
pub fn line_color(rule: &ObjectRule) -> Option<[f32; 4]> {
    let text = rule.rule.get(LINE_COLOR)?.as_str()?;
    if has_look(rule) { None } else { preset::color(text) }
}

/// Looks that rules of the preset of `style` give to things, each with the place of its rule, in the colours of a `palette`. The last
/// lies over those before it.
///
/// # Errors
/// As [`Style::load`]; [`Error::Input`] for a look that has rules itself.
pub fn looks(library: &Library, palette: Option<&Colours>, style: &Style) -> Result<Vec<(usize, Style)>> {
    let looks = own_looks(library, Path::new(&style.name), &style.objects);
    looks
        .map(|(number, look)| {
            let mut look = look?;
            palette.map_or(Ok(()), |palette| look.draw_in(palette))?;
            Ok((number, look))
        })
        .collect()
}

/// A style whose lines have the colour that a rule says, if it says one.
///
/// # Errors
/// [`Error::Input`] for styles without such a parameter.
fn in_colour(style: Style, rule: &ObjectRule) -> Result<Style> {
    let Some(Value::String(color)) = rule.rule.get(LINE_COLOR) else { return Ok(style) };
    style.set(&Setting { node: None, param: LINE_COLOR.into(), value: color.clone() })?;
    if style.params().iter().any(|param| param == LINE_COLORS) {
        style.set(&Setting { node: None, param: LINE_COLORS.into(), value: ONE.into() })?;
    }
    Ok(style)
}

impl Style {
    /// All that keeps the preset of the file `path` from being used.
    ///
    /// # Errors
    /// As [`preset::examine`].
    pub fn faults(library: &Library, path: &Path, text: &str) -> Result<(Preset, Vec<Error>)> {
        let (preset, faults) = preset::examine(path, text)?;
        let graph = match graph_beside(library, path, &preset) {
            Ok(graph) => graph,
            Err(fault) => return Ok((preset, faults.into_iter().chain([fault]).collect())),
        };
        let place = path.display().to_string();
        let failed = |e: isophote_loader::Error| e.at(&place, FIX);
        let all = library.check_preset(&place, text, graph.as_deref()).map_err(failed)?;
        let all = all.into_iter().map(|fault| Error::of_fault(fault, &place, FIX));
        let things: Vec<Error> = preset::things(&place, &preset.objects).filter_map(Result::err).collect();
        let looks = own_looks(library, path, &preset.objects).filter_map(|(_, look)| look.err());
        let things: Vec<Error> = things.into_iter().chain(looks).collect();
        Ok((preset, all.chain(things).collect()))
    }

    /// Where the things are that the rules of its preset are for, by rule.
    ///
    /// # Errors
    /// As [`preset::things`]; [`Error::Input`] for rules that the style does not follow.
    pub fn things(&self) -> Result<Vec<MaskSource>> {
        let refused =
            |problem: &str, fix: &str| Err(Error::input(format!("{}: objects", self.name), problem, fix));
        let has_color = |rule: &ObjectRule| line_color(rule).is_some();
        let needs_map = |rule: &ObjectRule| {
            !(has_look(rule) || has_color(rule)) || rule.control.iter().any(Option::is_some)
        };
        if self.objects.iter().any(needs_map) && !self.takes(Guide::Control.id())? {
            let problem = "are rules that the style does not follow";
            return refused(problem, "choose another style, or connect @control in its graph");
        }
        if self.objects.iter().any(has_color) && !self.takes(Guide::LinePaint.id())? {
            let problem = "are colours of lines, and the style's lines have one colour for all";
            return refused(problem, "choose another style, or connect @line_paint in its graph");
        }
        preset::things(&self.name, &self.objects).collect()
    }

    /// Refuses results that no mask can lay over a picture.
    ///
    /// # Errors
    /// [`Error::Input`] where it yields no colours.
    pub fn must_cover(&self) -> Result<()> {
        if self.kind == Kind::Color {
            return Ok(());
        }
        let problem = format!("yields a {}, which no mask can lay over a picture", self.kind.name());
        Err(Error::input(&self.name, problem, "choose a style that yields a colour"))
    }
}

/// Looks of their own that rules of the preset in the file `path` have, each with the place of its rule.
fn own_looks(
    library: &Library,
    path: &Path,
    rules: &[ObjectRule],
) -> impl Iterator<Item = (usize, Result<Style>)> {
    let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let look = move |(number, rule): (usize, &ObjectRule)| {
        let place = path.with_file_name(format!("{file}: object {}: its look", number + 1));
        let look = match rule.rule.get(LOOK)? {
            Value::String(name) => {
                Style::load(library, preset::style_beside(name, path), &[]).map_err(|e| e.within(&place))
            }
            written => preset::parse(&place, &written.to_string())
                .and_then(|preset| Style::of_preset(library, &place, &preset)),
        };
        let look = look.and_then(|look| in_colour(look, rule));
        let is_plain = |style: Style| match style.objects.is_empty() {
            true => Ok(style),
            false => Err(Error::file(
                &place,
                "has rules for objects",
                "write rules for all things in the preset itself",
            )),
        };
        Some((number, look.and_then(is_plain)))
    };
    rules.iter().enumerate().filter_map(look).collect::<Vec<_>>().into_iter()
}
