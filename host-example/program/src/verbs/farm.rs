//! `isophote farm`: a run of `apply` as a job for a render farm.
//!
//! A task is one frame, or a chunk of frames; it runs the same command with `--frames` of its own, and with
//! `--skip-existing` unless that has `--force`, so that it may be run again, also twice at once.

use clap::{Args, Subcommand};

use isophote_files::error::Result;
use isophote_files::replacing::Made;
use isophote_files::{files, output};
use job::Job;
use opencue::OpenCueArgs;
use openjd::OpenJdArgs;
use slurm::SlurmArgs;

mod job;
mod opencue;
mod openjd;
mod slurm;

/// Options of `farm`.
#[derive(Args, Debug)]
pub struct FarmArgs {
    /// Command to carry out.
    #[command(subcommand)]
    command: FarmCommand,
}

/// Commands of `farm`.
#[derive(Debug, Subcommand)]
enum FarmCommand {
    /// Writes an Open Job Description template (jobtemplate-2023-09) for an apply command.
    Openjd(OpenJdArgs),
    /// Writes a script for sbatch, an array job of Slurm, for an apply command.
    Slurm(SlurmArgs),
    /// Writes an outline for pycuerun, a job of OpenCue, for an apply command.
    Opencue(OpenCueArgs),
}

/// Runs the verb.
///
/// # Errors
/// `Error::Input` for commands that are none of `apply` on a sequence, and places that cannot be written.
pub fn run(args: &FarmArgs) -> Result<()> {
    let options = match &args.command {
        FarmCommand::Openjd(args) => &args.job,
        FarmCommand::Slurm(args) => &args.job,
        FarmCommand::Opencue(args) => &args.job,
    };
    let job = Job::new(&options.command)?;
    if let Some(path) = &options.output {
        let made = Made { from: None, to: path };
        options.force.consent().check(&[made], false, || job.parsed.inputs(&[], None))?;
    }
    let text = match &args.command {
        FarmCommand::Openjd(args) => args.text(&job),
        FarmCommand::Slurm(args) => args.text(&job),
        FarmCommand::Opencue(args) => args.text(&job),
    }?;
    match &options.output {
        Some(path) => files::write_bytes(path, options.force.existing(), text.as_bytes()),
        None => output::print(&text),
    }
}
