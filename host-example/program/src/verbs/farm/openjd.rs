//! Jobs of Open Job Description.
//!
//! Source: "Open Job Description, template schemas 2023-09" and its extension TASK_CHUNKING. A task is one frame, or
//! a chunk of frames.

use clap::Args;
use serde_json::{Value, json};

use super::job::{Job, JobArgs, check};
use isophote_files::error::{Error, Result};
use isophote_files::frames::range_expression;

/// Beginning of a variable in a template.
const VARIABLE: &str = "{{";

/// Options of `farm openjd`.
#[derive(Args, Debug)]
pub struct OpenJdArgs {
    #[command(flatten)]
    pub job: JobArgs,
    /// Frames per task, by the extension TASK_CHUNKING [default: 1].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    chunk: Option<u32>,
}

impl OpenJdArgs {
    /// The template of a job as JSON.
    ///
    /// # Errors
    /// [`Error::Input`] for commands that are not for a sequence, and words that a template takes for variables.
    pub fn text(&self, job: &Job) -> Result<String> {
        let text = serde_json::to_string_pretty(&self.template(job)?)
            .map_err(|e| Error::failure(e, "this is a mistake in the program; please report it"))?;
        Ok(format!("{text}\n"))
    }

    fn template(&self, job: &Job) -> Result<Value> {
        let range = range_expression(&job.parsed.frame_numbers()?);
        let (name, mut words) = (job.name(&self.job)?, job.words()?);
        words.iter().chain([&name]).try_for_each(|text| check(text, VARIABLE))?;
        words.extend(["--frames".into(), "{{Task.Param.Frame}}".into()]);
        let parameter = match self.chunk {
            Some(count) => json!({
                "name": "Frame",
                "type": "CHUNK[INT]",
                "range": range,
                "chunks": {"defaultTaskCount": count, "rangeConstraint": "NONCONTIGUOUS"},
            }),
            None => json!({"name": "Frame", "type": "INT", "range": range}),
        };
        let mut template = json!({"specificationVersion": "jobtemplate-2023-09"});
        if self.chunk.is_some() {
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
}
