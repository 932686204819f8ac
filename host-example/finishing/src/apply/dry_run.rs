//! Account of what a run would do, without writing anything.

use serde_json::json;

use super::memory::{Bytes, Needs, too_large};
use super::planner::Planner;
use super::sequence::MOST_IN_FLIGHT;
use super::tasks::{Task, Tasks};
use isophote_files::error::Result;
use isophote_files::output;
use isophote_pictures::exr::Selection;
use isophote_pictures::read::{self, Unread};

/// A run that is not done.
#[derive(Debug)]
pub struct DryRun<'a> {
    /// All frames.
    pub tasks: &'a Tasks,
    /// Selection of what would be read of EXR files.
    pub selection: &'a Selection,
    /// Memory that it might take.
    pub most: Bytes,
    /// True where whole outputs would stay as they are.
    pub skip_existing: bool,
    /// True where lines of JSON are wanted.
    pub json: bool,
}

impl DryRun<'_> {
    /// Prints what would become of every frame, and returns how many would fail as far as their headers tell. `needs`
    /// are those of the first frame.
    ///
    /// # Errors
    /// As [`output::print`].
    pub fn print(&self, planner: &mut Planner, needs: Option<Needs>) -> Result<u64> {
        let (mut done, mut refused) = (0, 0);
        for task in &self.tasks.ready {
            let is_done = self.skip_existing && read::is_whole(&task.output);
            let problem = if is_done { None } else { self.check(planner, task).err() };
            done += u64::from(is_done);
            refused += u64::from(problem.is_some());
            let (input, output) = (task.input.to_string_lossy(), task.output.to_string_lossy());
            let (status, note) = match (&problem, is_done) {
                (Some(problem), _) => ("failed", format!(" ({problem})")),
                (None, true) => ("skipped", " (there already)".into()),
                (None, false) => ("planned", String::new()),
            };
            let text = if self.json {
                let problem = problem.map(|problem| problem.to_string());
                json!({
                    "event": "frame", "frame": task.frame, "status": status, "input": input, "output": output,
                    "error": problem,
                })
                .to_string()
            } else {
                format!("{input} -> {output}{note}")
            };
            output::print(&(text + "\n"))?;
        }
        if !self.json {
            output::print(&self.summary(done, refused, needs))?;
        }
        Ok(refused)
    }

    /// Refuses what the run would refuse before it decodes the frame.
    fn check(&self, planner: &mut Planner, task: &Task) -> Result<()> {
        let file = Unread::open(&task.input)?;
        let span = planner.span(task.frame)?;
        let fits = |needs: Needs| {
            let together = needs.of(span);
            if together.total() > self.most.0 {
                return Err(too_large(&task.input, span, together, self.most));
            }
            Ok(())
        };
        fits(Needs { frame: file.length(), filter: 0 })?;
        let opened = file.read(&task.input, self.selection)?;
        planner.needs(&task.input, task.frame, &opened)?.map_or(Ok(()), fits)
    }

    fn summary(&self, done: u64, refused: u64, needs: Option<Needs>) -> String {
        let planned = self.tasks.ready.len() as u64 - done - refused;
        let mut text = format!("{planned} {} to be written", self.tasks.noun());
        let missing = self.tasks.missing.len() as u64;
        for (count, what) in [(done, "there already"), (refused, "refused"), (missing, "missing")] {
            if count > 0 {
                text += &format!(", {count} {what}");
            }
        }
        if let Some(needs) = needs {
            let at_once = self.most.0.saturating_sub(needs.filter).checked_div(needs.frame).unwrap_or(1);
            text += &format!(
                "; filtering takes about {}, a frame {}, {} at a time",
                Bytes(needs.filter),
                Bytes(needs.frame),
                at_once.clamp(1, MOST_IN_FLIGHT)
            );
        }
        text + "\n"
    }
}
