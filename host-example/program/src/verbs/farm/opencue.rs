//! Jobs of OpenCue: an outline for `pycuerun`, a script of Python with one layer.
//!
//! Source: pyoutline 1.37. Its layer *Shell* starts a command for every frame of a chunk; *PyEval* does so once, with all of
//! the chunk's frames.

use clap::Args;

use super::job::{Job, JobArgs, check};
use isophote_files::error::{Error, Result};
use isophote_files::frames::range_expression;

/// Beginning of a variable in a command of an outline.
const VARIABLE: &str = "%{";

/// The outline between its command and the values of its layer.
const RUN: &str = r#"# What a task runs: the program once, with the frames of its chunk.
RUN = f"self.system({COMMAND} + ['--frames', ','.join(str(frame) for frame in frames)])"
"#;

/// Options of `farm opencue`.
#[derive(Args, Debug)]
pub struct OpenCueArgs {
    #[command(flatten)]
    pub job: JobArgs,
    /// Frames per task.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    chunk: u32,
    /// The program, by its name or path on the workers.
    #[arg(long, value_name = "PROGRAM", default_value = "isophote")]
    program: String,
}

impl OpenCueArgs {
    /// The outline of a job.
    ///
    /// # Errors
    /// [`Error::Input`] for commands that are not for a sequence, and words that an outline takes for variables.
    pub fn text(&self, job: &Job) -> Result<String> {
        // A step is x there; a colon interleaves.
        let range = range_expression(&job.parsed.frame_numbers()?).replace(':', "x");
        let mut words = vec![self.program.clone()];
        words.extend(job.words()?);
        words.iter().try_for_each(|word| check(word, VARIABLE))?;
        let words: Vec<String> = words.iter().map(|word| literal(word)).collect::<Result<_>>()?;
        let mut values = format!("range={}, chunk={}", literal(&range)?, self.chunk);
        if job.parsed.threads > 0 {
            values.push_str(&format!(", cores={}", job.parsed.threads));
        }
        if let Some(mebibytes) = job.memory() {
            values.push_str(&format!(", memory=\"{mebibytes}m\""));
        }
        let name = literal(&layer(&job.name(&self.job)?))?;
        let head = "# An outline of OpenCue: pycuerun FILE RANGE. A task is a chunk of frames.";
        let import = "from outline.modules.shell import PyEval";
        let command = format!("COMMAND = [\n    {},\n]", words.join(",\n    "));
        Ok(format!("{head}\n{import}\n\n{command}\n{RUN}\nPyEval({name}, RUN, {values})\n"))
    }
}

/// A text of Python: those of JSON are.
fn literal(text: &str) -> Result<String> {
    serde_json::to_string(text)
        .map_err(|e| Error::failure(e, "this is a mistake in the program; please report it"))
}

/// Name of a layer, of letters, digits and underscores.
fn layer(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect()
}
