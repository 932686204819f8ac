//! Jobs of Slurm: a script for `sbatch` whose array has a task for every chunk of frames.
//!
//! Source: the manual pages of `sbatch` and `scontrol`, Slurm 22.05. Slurm itself runs a task again whose node fails. The
//! script asks for that where the program says that the machine is at fault, by its exit code.

use std::fmt::Write as _;

use clap::Args;

use super::job::{Job, JobArgs};
use isophote_files::error::{Error, Result};
use isophote_files::frames::range_expression;

/// Most tasks of an array in a cluster that does not say otherwise (`MaxArraySize` is 1001, and numbers begin at 0).
const MOST_TASKS: usize = 1001;

/// What follows the frames in the script. Exit code 1 is a fault of the machine, and 2 one of the input, which is the same on
/// every machine. A signal, such as that of Slurm where memory ends, is neither.
const RUN: &str = r#"code=$?
if [ "$code" -eq 1 ] && [ "${SLURM_RESTART_COUNT:-0}" -lt "$retries" ]; then
    scontrol requeue "$SLURM_JOB_ID"
fi
exit "$code"
"#;

/// Options of `farm slurm`.
#[derive(Args, Debug)]
pub struct SlurmArgs {
    #[command(flatten)]
    pub job: JobArgs,
    /// Frames per task [default: as few as give no more than 1001 tasks].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    chunk: Option<u32>,
    /// How often a task runs again whose machine is at fault.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(0..=100))]
    retries: u32,
}

impl SlurmArgs {
    /// The script of a job.
    ///
    /// # Errors
    /// [`Error::Input`] for commands that are not for a sequence, and chunks that give more tasks than an array has.
    pub fn text(&self, job: &Job) -> Result<String> {
        let frames = job.parsed.frame_numbers()?;
        let chunk = self.chunk.map_or_else(|| frames.len().div_ceil(MOST_TASKS), |chunk| chunk as usize);
        let tasks: Vec<&[i64]> = frames.chunks(chunk.max(1)).collect();
        if tasks.len() > MOST_TASKS {
            let problem = format!("gives {} tasks, and an array has {MOST_TASKS} at the most", tasks.len());
            let fix = format!("write --chunk {}, or none", frames.len().div_ceil(MOST_TASKS));
            return Err(Error::input("--chunk", problem, fix));
        }
        let mut text = String::from(
            "#!/bin/bash\n# An array job of Slurm, for sbatch: each task is a chunk of frames.\n",
        );
        for option in self.options(job, tasks.len())? {
            _ = writeln!(text, "#SBATCH {option}");
        }
        _ = writeln!(text, "\nretries={}\nframes=(", self.retries);
        for task in tasks {
            _ = writeln!(text, "    {}", range_expression(task));
        }
        // The program by its name or path on the nodes is a variable, which sbatch hands on.
        _ = write!(text, ")\n\n\"${{ISOPHOTE:-isophote}}\"");
        for word in job.words()? {
            _ = write!(text, " {}", quoted(&word));
        }
        _ = writeln!(text, " --frames \"${{frames[SLURM_ARRAY_TASK_ID]}}\"");
        text.push_str(RUN);
        Ok(text)
    }

    /// Options of `sbatch`; those that are given to it take their place.
    fn options(&self, job: &Job, tasks: usize) -> Result<Vec<String>> {
        // A name in the script ends at a blank, and has no quotes that are surely read alike.
        let name = job.name(&self.job)?;
        let name: String =
            name.chars().map(|c| if c.is_alphanumeric() || "._-".contains(c) { c } else { '_' }).collect();
        let mut options = vec![
            format!("--job-name={name}"),
            format!("--array=0-{}", tasks.saturating_sub(1)),
            // A task whose node fails runs again, and its log goes on.
            "--requeue".into(),
            "--open-mode=append".into(),
        ];
        if job.parsed.threads > 0 {
            options.push(format!("--cpus-per-task={}", job.parsed.threads));
        }
        if let Some(mebibytes) = job.memory() {
            options.push(format!("--mem={mebibytes}M"));
        }
        Ok(options)
    }
}

/// A word as a shell reads it back.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}
