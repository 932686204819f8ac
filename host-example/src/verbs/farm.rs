//! `isophote farm`: a run of `apply` as a job for a render farm.
//!
//! Source: "Open Job Description, template schemas 2023-09" and its extension TASK_CHUNKING. A task is one frame, or
//! a chunk of frames; it runs the same command with `--frames` of its own and `--skip-existing`, so that it may
//! be run again, also twice at once.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Args, FromArgMatches, Subcommand};
use serde_json::{Value, json};

use super::apply::ApplyArgs;
use crate::apply::exr::MaskSource;
use crate::error::{Error, Result};
use crate::frames::range_expression;
use crate::{files, looks, output};

/// Longest name of a job.
const LONGEST_NAME: usize = 128;

/// Options of `farm`.
#[derive(Args, Debug)]
pub struct FarmArgs {
    /// What to do.
    #[command(subcommand)]
    command: FarmCommand,
}

/// What `farm` does.
#[derive(Debug, Subcommand)]
enum FarmCommand {
    /// Writes an Open Job Description template (jobtemplate-2023-09) for an apply command.
    Openjd(OpenJdArgs),
}

/// Options of `farm openjd`.
#[derive(Args, Debug)]
struct OpenJdArgs {
    /// The template file (.json) [default: standard output].
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Name of the job.
    #[arg(long)]
    name: Option<String>,
    /// Frames per task, by the extension TASK_CHUNKING [default: 1].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    chunk: Option<u32>,
    /// The command after --: apply with its arguments.
    #[arg(last = true, required = true)]
    command: Vec<String>,
}

/// Runs the verb.
///
/// # Errors
/// [`Error::Input`] for commands that are none of `apply` on a sequence, and places that cannot be written.
pub fn run(args: &FarmArgs) -> Result<()> {
    let FarmCommand::Openjd(args) = &args.command;
    let template = template(args)?;
    let text = serde_json::to_string_pretty(&template)
        .map_err(|e| Error::failure(e, "this is a mistake in the program; please report it"))?;
    match &args.output {
        Some(path) => files::write(path, |file| writeln!(file, "{text}").map_err(|e| e.to_string())),
        None => output::print(&format!("{text}\n")),
    }
}

/// The arguments of an apply command.
fn parsed(command: &[String]) -> Result<ApplyArgs> {
    let wrong = |problem: String| Error::input("the command", problem, "write farm openjd -- apply ...");
    if command.first().is_none_or(|verb| verb != "apply") {
        return Err(wrong("is not apply".into()));
    }
    let parser = ApplyArgs::augment_args(clap::Command::new("isophote apply"));
    let parsed =
        parser.try_get_matches_from(command).and_then(|matches| ApplyArgs::from_arg_matches(&matches));
    let parsed = parsed.map_err(|e| {
        let text = e.render().to_string();
        wrong(format!("is wrong: {}", text.lines().next().unwrap_or_default()))
    })?;
    match command.iter().find(|a| a.contains("{{")) {
        Some(bad) => Err(wrong(format!("holds '{bad}', and {{{{ begins a variable in a template"))),
        None => Ok(parsed),
    }
}

fn template(args: &OpenJdArgs) -> Result<Value> {
    let parsed = parsed(&args.command)?;
    let range = range_expression(&parsed.frame_numbers()?);
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
        // A look is no file either.
        if looks::id(path).is_some() {
            return Ok(path.to_string_lossy().into_owned());
        }
        std::path::absolute(path)
            .map(|p| p.to_string_lossy().into_owned())
            .map_err(|e| Error::file(path, format!("has no full path: {e}"), "write it in full"))
    };
    let mut files: Vec<&Path> = vec![&parsed.input];
    files.extend(parsed.output.as_deref());
    files.extend(parsed.preset.as_deref());
    files.extend(parsed.layered.as_deref());
    files.extend(parsed.mask_from.as_deref());
    if let Some(MaskSource::File(path)) = &parsed.mask {
        files.push(path);
    }
    // A node is no file; with a preset or looks the first word is the picture.
    if parsed.preset.is_some() || parsed.layered.is_some() || parsed.style.is_file() {
        files.push(&parsed.style);
    }
    let mut words = Vec::new();
    let mut rest = command.iter();
    while let Some(word) = rest.next() {
        if word == "--frames" {
            rest.next();
        } else if word.starts_with("--frames=") {
        } else if let Some((option, file)) = word.split_once('=').filter(|(option, file)| {
            ["--preset", "--layered", "--mask-from"].contains(option)
                || *option == "--mask" && files.contains(&Path::new(file))
        }) {
            words.push(format!("{option}={}", full(Path::new(file))?));
        } else if files.contains(&Path::new(word)) {
            words.push(full(Path::new(word))?);
        } else {
            words.push(word.clone());
        }
    }
    Ok(words)
}
