//! Jobs for render farms: every farm's job gives the results of the command, and runs again what failed.

use std::fs;
use std::ops::RangeInclusive;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

#[cfg(target_os = "linux")]
use crate::support::slurm::Cluster;
use crate::support::{IN_PIXELS, fails, folder, isophote, picture, succeeds};

/// A command for farms, of frames that [`frames`] writes.
const JOB: [&str; 8] =
    ["apply", "gaussian", "in.####.png", "out/o.####.png", "--backend", "cpu", IN_PIXELS[0], IN_PIXELS[1]];

/// Writes frames that differ, and makes a folder for results.
fn frames(folder: &Path, numbers: RangeInclusive<u32>) {
    for frame in numbers {
        let mut picture = picture(48, 32);
        picture.put_pixel(frame, 7, image::Rgb([255, 0, 0]));
        picture.save(folder.join(format!("in.{frame:04}.png"))).expect("the frame can be written");
    }
    fs::create_dir(folder.join("out")).expect("a folder");
}

/// A command that makes a job.
fn farm(folder: &Path, farm: &str, more: &[&str]) -> Command {
    let mut command = isophote();
    command.current_dir(folder).args(["farm", farm]).args(more);
    command
}

/// Asserts that results have the bytes of the command without a farm.
fn are_as_without_a_farm(folder: &Path, numbers: RangeInclusive<u32>) {
    let list = format!("{}-{}", numbers.start(), numbers.end());
    let words = JOB.map(|word| if word.starts_with("out/") { "alone.####.png" } else { word });
    succeeds(isophote().current_dir(folder).args(words).args(["--frames", &list]));
    let bytes = |name: String| fs::read(folder.join(name)).expect("a result");
    for frame in numbers {
        let [farm, alone] = ["out/o", "alone"].map(|name| bytes(format!("{name}.{frame:04}.png")));
        assert!(farm == alone, "frame {frame}");
    }
}

#[test]
fn templates_of_open_job_description_run_the_command() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    frames(folder.path(), 1..=4);
    let farm = |more: &[&str]| farm(folder.path(), "openjd", more);
    succeeds(&mut farm(&[&["-o", "job.json", "--chunk", "2", "--"], &JOB[..]].concat()));
    let text = fs::read_to_string(at("job.json")).expect("a template");
    let template: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(template["specificationVersion"], "jobtemplate-2023-09");
    assert_eq!(template["extensions"], serde_json::json!(["TASK_CHUNKING"]));
    let step = &template["steps"][0];
    let parameter = &step["parameterSpace"]["taskParameterDefinitions"][0];
    assert_eq!((&parameter["type"], &parameter["range"]), (&"CHUNK[INT]".into(), &"1-4".into()));
    // Every task, from another folder, twice.
    let words: Vec<String> = step["script"]["actions"]["onRun"]["args"]
        .as_array()
        .expect("arguments")
        .iter()
        .map(|w| w.as_str().expect("text").to_owned())
        .collect();
    for chunk in ["1-2", "3-4", "1-2"] {
        let words = words.iter().map(|w| w.replace("{{Task.Param.Frame}}", chunk));
        succeeds(isophote().current_dir("/").args(words));
    }
    are_as_without_a_farm(folder.path(), 1..=4);
    let (text, _) = succeeds(&mut farm(&[&["--"], &JOB[..], &["--frames", "1-3x2,4"]].concat()));
    let template: Value = serde_json::from_str(&text).expect("JSON");
    let parameter = &template["steps"][0]["parameterSpace"]["taskParameterDefinitions"][0];
    assert_eq!((&parameter["type"], &parameter["range"]), (&"INT".into(), &"1,3,4".into()));
    assert_eq!(text.matches("--frames").count(), 1);
    fails(&mut farm(&["--", "apply", "gaussian", "in.0001.png", "o.png"]), 2, &["is no sequence"]);
    fails(&mut farm(&["--", "nodes"]), 2, &["is not apply"]);
    fails(&mut farm(&["--", "apply"]), 2, &["the command", "is wrong"]);
}

#[test]
fn scripts_of_slurm_hold_what_the_command_asks_for() {
    let folder = folder();
    frames(folder.path(), 1..=7);
    let script = |more: &[&str], command: &[&str]| {
        let arguments = [&["--force", "-o", "job.sh"], more, &["--"], &JOB[..], command].concat();
        succeeds(&mut farm(folder.path(), "slurm", &arguments));
        fs::read_to_string(folder.path().join("job.sh")).expect("a script")
    };
    let plain = script(&[], &[]);
    assert!(plain.contains("#SBATCH --array=0-6\n") && plain.contains("\n    7\n)\n"), "{plain}");
    assert!(!plain.contains("--mem=") && !plain.contains("--cpus-per-task"), "{plain}");
    let name = "it's $HOME";
    let full = script(
        &["--chunk", "3", "--retries", "0", "--name", name],
        &["--frames", "1-7x2,6", "--threads", "4", "--memory", "1GiB", "--layer", name],
    );
    for line in [
        "#SBATCH --job-name=it_s__HOME",
        "#SBATCH --array=0-1",
        "#SBATCH --cpus-per-task=4",
        "#SBATCH --mem=1280M",
        "retries=0",
        "    1-5:2",
        "    6-7",
    ] {
        assert!(full.lines().any(|l| l == line), "no '{line}' in {full}");
    }
    assert!(full.contains(r"'--layer=it'\''s $HOME'") && !full.contains("--frames=1-7"), "{full}");
    // An array has room for so many tasks.
    let most = folder.path().join("most");
    fs::create_dir(&most).expect("a folder");
    (1..=1002).for_each(|frame| fs::write(most.join(format!("in.{frame:04}.png")), "").expect("a file"));
    let many = ["--", "apply", "gaussian", "in.####.png", "o.####.png"];
    let (text, _) = succeeds(&mut farm(&most, "slurm", &many));
    assert!(text.contains("--array=0-500\n"), "{}", text.lines().nth(3).unwrap_or_default());
    let words = ["--chunk", "1002 tasks", "1001 at the most", "--chunk 2"];
    fails(&mut farm(&most, "slurm", &[&["--chunk", "1"], &many[..]].concat()), 2, &words);
}

/// One task's node dies, with half a result behind it; one task's machine is at fault; and of one the input is.
#[test]
#[cfg(target_os = "linux")]
fn slurm_runs_again_what_its_machines_failed() {
    let Some(mut cluster) = Cluster::start() else { return };
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    frames(folder.path(), 1..=6);
    let job = [&["-o", "job.sh", "--chunk", "2", "--"], &JOB[..], &["--threads", "1", "--memory", "64MiB"]]
        .concat();
    succeeds(&mut farm(folder.path(), "slurm", &job));
    let program = "#!/bin/sh
run=$SLURM_ARRAY_TASK_ID.${SLURM_RESTART_COUNT:-0}
case $run in
0.0) head -c 100 \"$FRAME\" > out/o.0001.png; echo $run >> runs; sleep 600 ;;
1.0) echo $run >> runs; exit 1 ;;
2.*) echo $run >> runs; exit 2 ;;
esac
exec \"$PROGRAM\" \"$@\"
";
    fs::write(at("program.sh"), program).expect("the folder is writable");
    succeeds(Command::new("chmod").args(["+x", "program.sh"]).current_dir(folder.path()));
    let mut submit = cluster.command("sbatch");
    submit.current_dir(folder.path()).args(["--parsable", "job.sh"]).env("ISOPHOTE", at("program.sh"));
    submit.env("PROGRAM", env!("CARGO_BIN_EXE_isophote")).env("FRAME", at("in.0001.png"));
    submit.env("ISOPHOTE_LIBRARY", crate::support::library());
    let id = succeeds(&mut submit).0.trim().to_owned();
    let runs = || fs::read_to_string(at("runs")).unwrap_or_default();
    cluster.wait("the first runs", || ["0.0", "1.0", "2.0"].iter().all(|run| runs().contains(run)));
    cluster.wait("the input to be at fault", || cluster.task(&id, 2) == ["FAILED", "0", "2:0"]);
    cluster.lose_node();
    for task in [0, 1] {
        cluster.wait("a task to run again", || cluster.task(&id, task)[0] == "COMPLETED");
        assert!(cluster.task(&id, task)[1] != "0", "task {task}");
    }
    assert_eq!(runs().matches("2.").count(), 1, "a fault of the input is one on every machine: {}", runs());
    are_as_without_a_farm(folder.path(), 1..=4);
    assert!(!at("out/o.0005.png").exists());
}

/// What pyoutline does with an outline, as far as one with a layer *PyEval* goes: it keeps the layer's values, and runs its
/// text with the frames of a chunk.
#[cfg(unix)]
const OUTLINE: &str = r#"
import subprocess, sys, types

class PyEval:
    def __init__(self, name, code, **args):
        assert name.replace("_", "a").isalnum() and set(args) <= {"range", "chunk", "cores", "memory"}, (name, args)
        print(args["range"], args["chunk"], args.get("cores"), args.get("memory"))
        self.code = compile(code, name, "exec")
        for frames in eval(sys.argv[2]):
            self.run(frames)
    def system(self, command):
        subprocess.run(command, check=True)
    def run(self, frames):
        exec(self.code)

for name in ["outline", "outline.modules", "outline.modules.shell"]:
    sys.modules[name] = types.ModuleType(name)
sys.modules["outline.modules.shell"].PyEval = PyEval
exec(open(sys.argv[1]).read())
"#;

#[test]
#[cfg(unix)]
fn outlines_of_opencue_run_the_command() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    frames(folder.path(), 1..=4);
    fs::write(at("run.py"), OUTLINE).expect("the folder is writable");
    let program = ["--program", env!("CARGO_BIN_EXE_isophote"), "--chunk", "2", "-o", "job.outline", "--"];
    let more = ["--threads", "3", "--memory", "1GiB", "--frames", "1-4"];
    succeeds(&mut farm(folder.path(), "opencue", &[&program, &JOB[..], &more].concat()));
    let mut run = Command::new("python3");
    run.current_dir(folder.path()).args(["run.py", "job.outline", "[[1, 2], [3, 4], [1, 2]]"]);
    let (text, _) = succeeds(run.env("ISOPHOTE_LIBRARY", crate::support::library()));
    assert!(text.contains("1-4 2 3 1280m"), "{text}");
    are_as_without_a_farm(folder.path(), 1..=4);
    // Steps are written otherwise there, and variables are its own.
    let (text, _) = succeeds(&mut farm(
        folder.path(),
        "opencue",
        &[&["--"], &JOB[..], &["--frames", "1-3x2,4"]].concat(),
    ));
    assert!(text.contains("range=\"1,3,4\", chunk=1)") && text.contains("\n    \"isophote\","), "{text}");
    let marked = [&["--"], &JOB[..], &["--layer", "%{FRAME}"]].concat();
    fails(
        &mut farm(folder.path(), "opencue", &marked),
        2,
        &["the command", "%{FRAME}", "choose other names"],
    );
}
