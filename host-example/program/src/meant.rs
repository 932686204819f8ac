//! Meaning of command lines that leave the verb out, or that have a word which is none of the program's.

use std::ffi::{OsStr, OsString};
use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, Error as Refusal};

use isophote_files::error::Error;
use isophote_files::frames::{self, Pattern};
use isophote_finishing::stylize::style::Style;
use isophote_finishing::stylize::suggest;
use isophote_finishing::video;
use isophote_loader::Library;

/// The verb that opens a file.
const VIEW: &str = "view";
/// Extensions of scenes.
const SCENES: [&str; 3] = ["gltf", "glb", "obj"];
/// Verbs that take `--set`.
const STYLIZING: [&str; 4] = ["apply", "render", VIEW, "preset"];
/// Options of other programs for files that this one names without an option.
const OF_FILES: [(&str, &str); 6] = [
    ("-i", "the picture comes after the style"),
    ("--input", "the picture comes after the style"),
    ("-o", "the result comes after the picture"),
    ("--out", "the result comes after the picture"),
    ("--output", "the result comes after the picture"),
    ("-f", "the result comes after the picture, and files that are there are replaced with --force"),
];

/// The words of a command line, with the verb that opens a file where a file stands in its place.
pub fn with_verb(mut words: Vec<OsString>, command: &Command) -> Vec<OsString> {
    let is_alone = words.len() == 2;
    let opens = |word: &OsString| !is_verb(word, command) && is_opened(Path::new(word), is_alone);
    if words.get(1).is_some_and(opens) {
        words.insert(1, VIEW.into());
    }
    words
}

fn is_verb(word: &OsStr, command: &Command) -> bool {
    word == "help" || command.get_subcommands().any(|verb| word == verb.get_name())
}

/// True where a word is a file for the window: of a kind that it opens, or there. A word without an ending may be a style.
fn is_opened(path: &Path, is_alone: bool) -> bool {
    let name = path.as_os_str();
    if name.as_encoded_bytes().starts_with(b"-") || has_ending(path, &["json"]) {
        return false;
    }
    let is_known = frames::is_picture(path) || video::is_video(path) || has_ending(path, &SCENES);
    let is_pattern = Pattern::in_name(path).is_ok_and(|pattern| pattern.is_some());
    let is_path = path.extension().is_some() || path.components().count() > 1;
    is_known || is_pattern || path.exists() && (is_alone || is_path)
}

fn has_ending(path: &Path, endings: &[&str]) -> bool {
    path.extension().is_some_and(|own| endings.iter().any(|ending| own.eq_ignore_ascii_case(ending)))
}

/// The error of a command line that the parser refuses, where it can be told what was meant.
pub fn explained(refusal: &Refusal, words: &[OsString]) -> Option<Error> {
    let words: Vec<&str> = words.iter().map(|word| word.to_str()).collect::<Option<_>>()?;
    match refusal.kind() {
        ErrorKind::InvalidSubcommand => {
            let is_verb = text(refusal, ContextKind::InvalidSubcommand)? == *words.get(1)?;
            is_verb.then(|| no_verb(refusal, &words))
        }
        ErrorKind::UnknownArgument => {
            let verb = *words.get(1)?;
            let argument = text(refusal, ContextKind::InvalidArg)?;
            no_option(refusal, verb, argument.split('=').next()?, words.get(2..)?)
        }
        _ => None,
    }
}

/// A text that the parser knows of its refusal.
fn text(refusal: &Refusal, kind: ContextKind) -> Option<&str> {
    match refusal.get(kind)? {
        ContextValue::String(text) => Some(text),
        ContextValue::Strings(texts) => texts.first().map(String::as_str),
        _ => None,
    }
}

/// The error of a word in the place of a verb: it may be a style, or a verb or a style that is misspelt.
fn no_verb(refusal: &Refusal, words: &[&str]) -> Error {
    let (word, rest) = (words[1], &words[2..]);
    let owned = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
    let line = |style: &str, options: Vec<String>| {
        let rest = if rest.is_empty() { &["PICTURE"] } else { rest };
        command("apply", &[vec![style.to_owned()], owned(rest), options].concat())
    };
    let verb = text(refusal, ContextKind::SuggestedSubcommand).and_then(|verb| suggest::id(&[verb], word));
    let meant = || suggest::style(&Library::open().ok()?, word);
    let (problem, line) = if is_style(word) {
        ("is a style and no command", Some(line(word, Vec::new())))
    } else if let Some(verb) = verb {
        ("is no command", Some(command(verb, &owned(rest))))
    } else {
        ("is no command", meant().map(|meant| line(&meant.style, meant.options())))
    };
    let fix = line.map_or_else(
        || "`isophote --help` lists the commands".to_owned(),
        |line| format!("did you mean `{line}`?"),
    );
    Error::input(word, problem, fix)
}

fn is_style(word: &str) -> bool {
    has_ending(Path::new(word), &["json"]) || Library::open().is_ok_and(|library| library.style(word).is_ok())
}

/// The error of an option that a verb has not, or of one word too many.
fn no_option(refusal: &Refusal, verb: &str, option: &str, rest: &[&str]) -> Option<Error> {
    if verb == VIEW && !option.starts_with('-') {
        let files = rest.iter().filter(|word| !word.starts_with('-'));
        let line: Vec<String> =
            ["STYLE"].iter().chain(files).chain(&["out/"]).map(|w| (*w).to_owned()).collect();
        let fix = format!("give several a style by `{}`", command("apply", &line));
        return Some(Error::input(option, "is one more than the window opens", fix));
    }
    if verb == "apply" && option == "--style" {
        return Some(style_first(rest));
    }
    if let Some((_, advice)) = OF_FILES.iter().find(|(other, _)| verb == "apply" && *other == option) {
        return Some(Error::input(
            option,
            format!("there is no such option; {advice}"),
            "see `isophote apply --help`",
        ));
    }
    if STYLIZING.contains(&verb) && option.starts_with("--") {
        return parameter(refusal, option, rest);
    }
    None
}

/// The error of a style that is named by an option.
fn style_first(rest: &[&str]) -> Error {
    let (style, mut others) = without(rest, "--style");
    let style = style.unwrap_or("STYLE");
    if others.first().is_some_and(|word| is_style(word)) {
        others.remove(0);
    }
    let line: Vec<String> = std::iter::once(style).chain(others).map(str::to_owned).collect();
    let fix = format!("write `{}`", command("apply", &line));
    Error::input("--style", "the style comes first, without an option", fix)
}

/// The error of a parameter of a style that is named as an option.
fn parameter(refusal: &Refusal, option: &str, rest: &[&str]) -> Option<Error> {
    let typed = option.trim_start_matches('-');
    let params = parameters(rest)?;
    let ids: Vec<&str> = params.iter().map(String::as_str).collect();
    let id = suggest::id(&ids, typed)?;
    let is_exact = id == typed.replace('-', "_");
    if !is_exact && refusal.get(ContextKind::SuggestedArg).is_some() {
        return None;
    }
    let value = without(rest, option).0.unwrap_or("VALUE");
    let problem = if is_exact { "is a parameter of the style" } else { "is no option" };
    Some(Error::input(option, problem, format!("write `--set {id}={value}`")))
}

/// Ids of the parameters of the style that a command line names, or else of all styles.
fn parameters(rest: &[&str]) -> Option<Vec<String>> {
    let library = Library::open().ok()?;
    let named = rest.iter().filter(|word| !word.starts_with('-')).find(|word| is_style(word));
    if let Some(style) = named.and_then(|word| Style::any(&library, word, &[]).ok()) {
        return Some(style.params());
    }
    let nodes = library.catalogue().ok()?.nodes;
    Some(nodes.iter().flat_map(|node| &node.params).map(|param| param.id.to_owned()).collect())
}

/// The value of an option, after `=` or as the next word, and the words without both.
fn without<'a>(words: &[&'a str], option: &str) -> (Option<&'a str>, Vec<&'a str>) {
    let (mut value, mut others) = (None, Vec::new());
    let mut words = words.iter().peekable();
    while let Some(word) = words.next() {
        match word.strip_prefix(option) {
            Some("") => value = words.next_if(|next| !next.starts_with("--")).copied(),
            Some(given) if given.starts_with('=') => value = given.get(1..),
            _ => others.push(*word),
        }
    }
    (value, others)
}

/// A command line as it is typed.
fn command(verb: &str, words: &[String]) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./:,=#@%+".contains(c);
    let quoted = words.iter().map(|word| match word.chars().all(plain) {
        true => word.clone(),
        false => format!("\"{word}\""),
    });
    let words: Vec<String> = ["isophote".to_owned(), verb.to_owned()].into_iter().chain(quoted).collect();
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_found_with_their_values() {
        let words = ["a.png", "--style", "ink", "b.png", "--json"];
        assert_eq!(without(&words, "--style"), (Some("ink"), vec!["a.png", "b.png", "--json"]));
        assert_eq!(without(&["--style=ink", "a.png"], "--style"), (Some("ink"), vec!["a.png"]));
        assert_eq!(without(&["--style", "--json"], "--style"), (None, vec!["--json"]));
    }

    #[test]
    fn files_are_told_from_styles() {
        for file in ["a.png", "b/c.EXR", "shot.####.exr", "scene.glb", "clip.mp4"] {
            assert!(is_opened(Path::new(file), false), "{file}");
        }
        for other in ["cartoon", "look:noir_panel", "my.json", "--help", "-", "toon"] {
            assert!(!is_opened(Path::new(other), true), "{other}");
        }
    }
}
