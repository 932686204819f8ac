//! `isophote farm`: a run of `apply` as a job for a render farm.
//!
//! Source: "Open Job Description, template schemas 2023-09" and its extension TASK_CHUNKING. A task is one frame, or
//! a chunk of frames; it runs the same command with `--frames` of its own and `--skip-existing`, so that it may
//! be run again, also twice at once.

use std::io::Write;
use std::path::Path;

use clap::Parser;
use serde_json::{Value, json};

use crate::apply;
use crate::cli::{ApplyArgs, Cli, Command, FarmCommand, OpenJdArgs};
use crate::error::{Error, Result};
use crate::output;

/// Longest name of a job.
const LONGEST_NAME: usize = 128;

/// Runs the verb.
///
/// # Errors
/// [`Error::Input`] for commands that are none of `apply` on a sequence, and places that cannot be written.
pub fn run(command: &FarmCommand) -> Result<()> {
    let FarmCommand::Openjd(args) = command;
    let template = template(args)?;
    let text = serde_json::to_string_pretty(&template)
        .map_err(|e| Error::failure(e, "this is a mistake in the program; please report it"))?;
    match &args.output {
        Some(path) => output::write_beside(path, |file| writeln!(file, "{text}").map_err(|e| e.to_string())),
        None => {
            println!("{text}");
            Ok(())
        }
    }
}

fn template(args: &OpenJdArgs) -> Result<Value> {
    let wrong = |problem: String| Error::input("the command", problem, "write farm openjd -- apply ...");
    let cli = Cli::try_parse_from(std::iter::once("isophote").chain(args.command.iter().map(String::as_str)));
    let parsed = match cli.map(|cli| cli.command) {
        Ok(Command::Apply(parsed)) => parsed,
        Ok(_) => return Err(wrong("is not apply".into())),
        Err(e) => {
            let text = e.render().to_string();
            return Err(wrong(format!("is wrong: {}", text.lines().next().unwrap_or_default())));
        }
    };
    if let Some(bad) = args.command.iter().find(|a| a.contains("{{")) {
        return Err(wrong(format!("holds '{bad}', and {{{{ begins a variable in a template")));
    }
    let frames = apply::frames_of(&parsed)?;
    let range = range(&frames);
    let mut words = words(&args.command, &parsed)?;
    words.extend(["--frames".into(), "{{Task.Param.Frame}}".into()]);
    if !parsed.skip_existing {
        words.push("--skip-existing".into());
    }
    let name = args.name.clone().unwrap_or_else(|| {
        let input = parsed.input.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        format!("isophote {input}")
    });
    let name: String = name.chars().filter(|c| !c.is_control()).take(LONGEST_NAME).collect();
    let parameter = match args.chunk {
        Some(count) => json!({
            "name": "Frame",
            "type": "CHUNK[INT]",
            "range": range,
            "chunks": {"defaultTaskCount": count, "rangeConstraint": "NONCONTIGUOUS"},
        }),
        None => json!({"name": "Frame", "type": "INT", "range": range}),
    };
    let mut template = json!({"specificationVersion": "jobtemplate-2023-09"});
    if args.chunk.is_some() {
        template["extensions"] = json!(["TASK_CHUNKING"]);
    }
    template["name"] = json!(name);
    template["parameterDefinitions"] = json!([{
        "name": "Isophote",
        "type": "STRING",
        "default": "isophote",
        "description": "The program, by its name or path on the workers.",
    }]);
    template["steps"] = json!([{
        "name": "Apply",
        "parameterSpace": {"taskParameterDefinitions": [parameter]},
        "script": {"actions": {"onRun": {"command": "{{Param.Isophote}}", "args": words}}},
    }]);
    Ok(template)
}

/// The command without its frames, and with files by their full paths: workers start elsewhere.
fn words(command: &[String], parsed: &ApplyArgs) -> Result<Vec<String>> {
    let full = |path: &Path| {
        std::path::absolute(path)
            .map(|p| p.to_string_lossy().into_owned())
            .map_err(|e| Error::file(path, format!("has no full path: {e}"), "write it in full"))
    };
    let mut files: Vec<&Path> = vec![&parsed.input];
    files.extend(parsed.output.as_deref());
    files.extend(parsed.preset.as_deref());
    // A node is no file; with a preset the first word is the picture.
    if parsed.preset.is_some() || parsed.style.is_file() {
        files.push(&parsed.style);
    }
    let mut words = Vec::new();
    let mut rest = command.iter();
    while let Some(word) = rest.next() {
        if word == "--frames" {
            rest.next();
        } else if word.starts_with("--frames=") {
        } else if let Some(preset) = word.strip_prefix("--preset=") {
            words.push(format!("--preset={}", full(Path::new(preset))?));
        } else if files.contains(&Path::new(word)) {
            words.push(full(Path::new(word))?);
        } else {
            words.push(word.clone());
        }
    }
    Ok(words)
}

/// Frames as a range expression: `1001-1099:2,1200`.
fn range(frames: &[i64]) -> String {
    let mut sorted = frames.to_vec();
    sorted.sort_unstable();
    let mut parts: Vec<(i64, i64, i64)> = Vec::new();
    for frame in sorted {
        match parts.last_mut() {
            Some((first, last, step)) if *first == *last => {
                *step = frame - *last;
                *last = frame;
            }
            Some((_, last, step)) if *last + *step == frame => *last = frame,
            _ => parts.push((frame, frame, 1)),
        }
    }
    let text = |(first, last, step): &(i64, i64, i64)| match (last - first, *step) {
        (0, _) => first.to_string(),
        (_, 1) => format!("{first}-{last}"),
        (length, step) if length == step => format!("{first},{last}"),
        (_, step) => format!("{first}-{last}:{step}"),
    };
    parts.iter().map(text).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_short() {
        assert_eq!(range(&[1, 3, 5, 7, 20]), "1-7:2,20");
        assert_eq!(range(&[3, 2, 1]), "1-3");
        assert_eq!(range(&[1, 9]), "1,9");
        assert_eq!(range(&[-2, -1, 5]), "-2--1,5");
        assert_eq!(range(&[4]), "4");
    }
}
