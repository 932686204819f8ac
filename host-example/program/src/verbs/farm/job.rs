//! The command of a job for a render farm, which every farm runs: `apply` on a sequence, with full paths and without its frames.

use std::path::{Path, PathBuf};

use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};

use crate::verbs::apply::ApplyArgs;
use crate::verbs::shared::ForceArgs;
use isophote_files::error::{Error, Result};

/// Longest name of a job.
const LONGEST_NAME: usize = 128;

/// Memory of a task beyond the limit of the command, which bounds its pictures: the program, its library and files, bytes. `cartoon`
/// on frames of 1920x1080 took 163 MiB beyond a limit of 256 MiB, in a build for development.
const BESIDES: u64 = 256 << 20;

/// Options that the jobs of all farms have.
#[derive(Args, Debug)]
pub struct JobArgs {
    /// The file of the job [default: standard output].
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Name of the job.
    #[arg(long)]
    pub name: Option<String>,
    #[command(flatten)]
    pub force: ForceArgs,
    /// The command after --: apply with its arguments.
    #[arg(last = true, required = true)]
    pub command: Vec<String>,
}

/// The command of a job.
pub struct Job {
    /// Declaration of the arguments of `apply`.
    declared: Command,
    /// Arguments that are given.
    given: ArgMatches,
    /// Their values.
    pub parsed: ApplyArgs,
}

impl Job {
    /// Reads the words of a command.
    ///
    /// # Errors
    /// [`Error::Input`] for commands that are not `apply`, or wrong, or that write over what they read.
    pub fn new(command: &[String]) -> Result<Self> {
        let wrong =
            |problem: String| Error::input("the command", problem, "write -- apply ... after the options");
        if command.first().is_none_or(|verb| verb != "apply") {
            return Err(wrong("is not apply".into()));
        }
        let mut declared = ApplyArgs::augment_args(Command::new("isophote apply"));
        let given = declared.try_get_matches_from_mut(command);
        let read = given.and_then(|given| Ok((ApplyArgs::from_arg_matches(&given)?, given)));
        let (parsed, given) = read.map_err(|e| {
            let text = e.render().to_string();
            wrong(format!("is wrong: {}", text.lines().next().unwrap_or_default()))
        })?;
        if parsed.in_place {
            let problem = "would stylize its own results where a task runs twice";
            return Err(Error::input("--in-place", problem, "name other files for the results"));
        }
        Ok(Self { declared, given, parsed })
    }

    /// Name of the job: the one that is given, or that of its pictures.
    ///
    /// # Errors
    /// Those of [`ApplyArgs::files`].
    pub fn name(&self, args: &JobArgs) -> Result<String> {
        let input = self.parsed.files()?.input;
        let name = args.name.clone().unwrap_or_else(|| {
            let input = input.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
            format!("isophote {input}")
        });
        Ok(name.chars().filter(|c| !c.is_control()).take(LONGEST_NAME).collect())
    }

    /// Mebibytes that a task asks for, where the command limits its memory.
    pub fn memory(&self) -> Option<u64> {
        self.parsed.memory.map(|limit| (limit.0 + BESIDES).div_ceil(1 << 20))
    }

    /// The command without its frames, and with files by their full paths: workers start elsewhere. Arguments without a name
    /// come first. It skips results that are there unless it replaces them, since a task may run twice.
    ///
    /// # Errors
    /// [`Error::Input`] for files without a full path in UTF-8.
    pub fn words(&self) -> Result<Vec<String>> {
        let places = self.parsed.places()?;
        let is_given = |arg: &&Arg| {
            let source = self.given.value_source(arg.get_id().as_str());
            arg.get_id() != "frames" && source == Some(ValueSource::CommandLine)
        };
        let (plain, options): (Vec<&Arg>, Vec<&Arg>) =
            self.declared.get_arguments().filter(is_given).partition(|arg| arg.is_positional());
        let mut words = vec!["apply".to_owned()];
        for arg in plain.into_iter().chain(options) {
            let id = arg.get_id().as_str();
            let option = arg.get_long().map(|name| format!("--{name}"));
            if !arg.get_action().takes_values() {
                words.extend(option);
                continue;
            }
            let place = places.iter().find(|place| place.id == id);
            for value in self.given.get_raw(id).into_iter().flatten() {
                let value = match place {
                    Some(place) => full(place.path)?,
                    // The command is text.
                    None => value.to_string_lossy().into_owned(),
                };
                words.push(option.as_ref().map_or(value.clone(), |option| format!("{option}={value}")));
            }
        }
        if !(self.parsed.skip_existing || self.parsed.consent().force) {
            words.push("--skip-existing".into());
        }
        Ok(words)
    }
}

/// Refuses a text that a farm would take for a variable: one with the mark that begins these.
///
/// # Errors
/// [`Error::Input`] with the text.
pub fn check(text: &str, mark: &str) -> Result<()> {
    if !text.contains(mark) {
        return Ok(());
    }
    let problem = format!("holds '{text}', and {mark} begins a variable of the farm");
    Err(Error::input("the command", problem, "choose other names"))
}

/// The full path of a file.
fn full(path: &Path) -> Result<String> {
    let wrong = |problem: String| Error::file(path, problem, "write it in full");
    let full = std::path::absolute(path).map_err(|e| wrong(format!("has no full path: {e}")))?;
    full.into_os_string().into_string().map_err(|_| wrong("lies in a folder whose name is no UTF-8".into()))
}

#[cfg(test)]
mod tests {
    use std::any::TypeId;

    use clap::ValueHint;

    use super::*;
    use isophote_pictures::exr::MaskSource;

    fn words(command: &[&str]) -> Vec<String> {
        let command: Vec<String> = command.iter().map(|word| (*word).to_owned()).collect();
        Job::new(&command).and_then(|job| job.words()).unwrap_or_else(|e| panic!("{command:?}: {e}"))
    }

    fn full_path(path: &str) -> String {
        full(Path::new(path)).unwrap()
    }

    /// Every argument of `apply` whose value may be a path, by its type or by what shells are told of it.
    fn arguments_with_paths() -> Vec<Arg> {
        let takes_path = |arg: &&Arg| {
            let hint = matches!(
                arg.get_value_hint(),
                ValueHint::AnyPath | ValueHint::FilePath | ValueHint::DirPath | ValueHint::ExecutablePath
            );
            let kind = arg.get_value_parser().type_id();
            let path = kind == TypeId::of::<PathBuf>() || kind == TypeId::of::<MaskSource>();
            assert_eq!(hint, path, "{} takes a path, or not", arg.get_id());
            hint
        };
        let declared = ApplyArgs::augment_args(Command::new("apply"));
        declared.get_arguments().filter(takes_path).cloned().collect()
    }

    #[test]
    fn all_paths_of_a_command_are_full() {
        let arguments = arguments_with_paths();
        assert!(arguments.len() >= 8, "{arguments:?}");
        let (input, output) = ("shot/in.####.exr", "shot/out.####.exr");
        for arg in arguments {
            let id = arg.get_id().as_str();
            let path = "more/of.####.exr";
            let Some(option) = arg.get_long().map(|long| format!("--{long}")) else {
                let named = match id {
                    "style" => [path, input, output],
                    "input" => ["gaussian", path, output],
                    _ => ["gaussian", input, path],
                };
                let words = words(&[&["apply"], &named[..]].concat());
                assert!(
                    words.contains(&full_path(path)) && !words.contains(&path.to_owned()),
                    "{id}: {words:?}"
                );
                continue;
            };
            let files = if ["preset", "layered"].contains(&id) { "" } else { "gaussian" };
            let fixed: Vec<&str> =
                ["apply", files, input, output].into_iter().filter(|word| !word.is_empty()).collect();
            let equals = format!("{option}={path}");
            for more in [&[option.as_str(), path][..], &[&equals]] {
                for command in [[&fixed[..], more].concat(), [&fixed[..1], more, &fixed[1..]].concat()] {
                    let words = words(&command);
                    let wanted = format!("{option}={}", full_path(path));
                    assert_eq!(
                        words.iter().filter(|word| **word == wanted).count(),
                        1,
                        "{command:?}: {words:?}"
                    );
                    assert!(!words.iter().any(|word| word.ends_with(&format!("={path}")) || word == path));
                    for file in [input, output] {
                        assert!(words.contains(&full_path(file)), "{command:?}: {words:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn words_that_are_no_paths_stay_as_they_are() {
        // A layer and a view that are named as the files, a value that is, and words that stand for no file.
        let (input, output) = ("in.####.exr", "out.####.exr");
        let more = ["--layer", input, "--view=out.####.exr", "--set", "a=in.####.exr", "--motion=estimate"];
        let mask = ["--mask", "cryptomatte:in.exr", "--force", "--frames", "1-5", "--memory=4GiB"];
        let words = words(&[&["apply", "look:linocut", input, output][..], &more, &mask].concat());
        let [input, output] = [input, output].map(full_path);
        let wanted = ["apply", "look:linocut", &input, &output];
        assert_eq!(words[..4], wanted);
        for word in [
            "--layer=in.####.exr",
            "--view=out.####.exr",
            "--set=a=in.####.exr",
            "--motion=estimate",
            "--mask=cryptomatte:in.exr",
            "--force",
            "--memory=4GiB",
        ] {
            assert!(words.contains(&word.to_owned()), "'{word}' is not in {words:?}");
        }
        assert_eq!(words.len(), 4 + 7, "no frames, and nothing is skipped that is replaced: {words:?}");
    }
}
