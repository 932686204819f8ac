//! Frames that know their neighbours, through the program: `render` and `apply` with `--steadiness`.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::support::{self, IN_PIXELS, cube, fails, folder, isophote, listing, succeeds};

/// Renders frames of a turning cube with everything that is known of them.
fn shot(folder: &Path, out: &str, size: &str) {
    let mut command = isophote();
    command.current_dir(folder).arg("render").arg(cube(folder)).arg(out);
    succeeds(command.args(["--size", size, "--turntable", "--frames", "1-24"]));
}

fn apply(folder: &Path, more: &[&str]) -> Command {
    let mut command = isophote();
    command.current_dir(folder).arg("apply").args(more).args(IN_PIXELS).args(["--backend", "cpu"]);
    command
}

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    fs::read(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// A frame's colours as numbers.
fn pixels(path: &Path) -> Vec<f32> {
    let image = exr::prelude::read_first_flat_layer_from_file(path).expect("a picture");
    let channels =
        image.layer_data.channel_data.list.iter().filter(|c| ["R", "G", "B"].iter().any(|n| c.name == **n));
    channels.flat_map(|c| c.sample_data.values_as_f32().collect::<Vec<_>>()).collect()
}

const INPUT: &str = "in.####.exr";

#[test]
fn chunks_and_threads_of_a_steady_sequence_give_the_same_files() {
    let folder = folder();
    let at = folder.path();
    shot(at, INPUT, "96x64");
    let run = |out: &str, more: &[&str]| {
        let fixed = ["cartoon", INPUT, out, "--steadiness", "0.5"];
        succeeds(&mut apply(at, &[&fixed[..], more].concat()));
    };
    run("all.####.exr", &["--frames", "3-8"]);
    run("a.####.exr", &["--frames", "3-5", "--threads", "1"]);
    run("b.####.exr", &["--frames", "6-8", "--memory", "256MiB"]);
    run("c.####.exr", &["--frames", "8,3,5,7,4,6", "--skip-existing"]);
    run("d.####.exr", &["--frames", "5"]);
    succeeds(&mut apply(at, &["cartoon", INPUT, "still.####.exr", "--frames", "3-8"]));
    for frame in 3..=8 {
        let whole = bytes(at, &format!("all.{frame:04}.exr"));
        let part = if frame < 6 { "a" } else { "b" };
        assert_eq!(whole, bytes(at, &format!("{part}.{frame:04}.exr")), "frame {frame} of a chunk");
        assert_eq!(whole, bytes(at, &format!("c.{frame:04}.exr")), "frame {frame} of another order");
        assert_ne!(whole, bytes(at, &format!("still.{frame:04}.exr")), "frame {frame} is not steadied");
    }
    assert_eq!(bytes(at, "d.0005.exr"), bytes(at, "all.0005.exr"));
    // Resumed after a frame was lost.
    let lost = at.join("all.0006.exr");
    let before = bytes(at, "all.0006.exr");
    fs::remove_file(&lost).expect("a result");
    run("all.####.exr", &["--frames", "3-8", "--skip-existing"]);
    assert_eq!(before, bytes(at, "all.0006.exr"));
}

#[test]
fn the_ends_of_a_sequence_and_gaps_are_stylized_with_what_there_is() {
    let folder = folder();
    let at = folder.path();
    shot(at, INPUT, "96x64");
    for frame in (5..=24).filter(|f| *f != 7) {
        fs::remove_file(at.join(format!("in.{frame:04}.exr"))).expect("a frame");
    }
    fs::write(at.join("in.0008.exr"), b"damaged").expect("the folder is writable");
    let args = |style, out| [style, INPUT, out, "--frames", "1-4,7", "--steadiness", "0.5"];
    succeeds(&mut apply(at, &args("cartoon", "o.####.exr")));
    // A frame without neighbours is the still.
    succeeds(&mut apply(at, &["cartoon", INPUT, "still.####.exr", "--frames", "7"]));
    assert_eq!(bytes(at, "o.0007.exr"), bytes(at, "still.0007.exr"));
    // So is a picture by itself.
    succeeds(&mut apply(at, &["cartoon", "in.0007.exr", "one.exr", "--steadiness", "0.5"]));
    assert_eq!(bytes(at, "one.exr"), bytes(at, "still.0007.exr"));
}

#[test]
fn motion_comes_from_files_of_its_own_too() {
    let folder = folder();
    let at = folder.path();
    shot(at, INPUT, "96x64");
    let run = |out: &str, more: &[&str]| {
        let fixed = ["ink", INPUT, out, "--frames", "4-5", "--steadiness", "0.5"];
        succeeds(&mut apply(at, &[&fixed[..], more].concat()))
    };
    run("o.####.exr", &[]);
    // The same vectors from other files, while those of the frames are left out.
    run("p.####.exr", &["--motion", INPUT]);
    run("q.####.exr", &["--guide", "motion=none", "--guide", "motion_forward=none"]);
    for frame in [4, 5] {
        let name = |stem: &str| format!("{stem}.{frame:04}.exr");
        assert_eq!(bytes(at, &name("o")), bytes(at, &name("p")));
        assert_ne!(bytes(at, &name("o")), bytes(at, &name("q")));
    }
    // Vectors that are read the wrong way round do something else.
    run("r.####.exr", &["--motion-convention", "isophote,sign=-1"]);
    assert_ne!(bytes(at, "o.0004.exr"), bytes(at, "r.0004.exr"));
}

/// Writes a frame anew without the layer of a name.
fn without_layer(from: &Path, to: &Path, layer: &str) {
    let mut image = exr::prelude::read_first_flat_layer_from_file(from).expect("a picture");
    let channels = &mut image.layer_data.channel_data.list;
    channels.retain(|channel| !channel.name.to_string().starts_with(layer));
    exr::prelude::WritableImage::write(&image).to_file(to).expect("the folder is writable");
}

#[test]
fn vectors_of_one_way_stand_for_the_other_reversed() {
    let folder = folder();
    let at = folder.path();
    shot(at, INPUT, "96x64");
    for frame in 3..=7 {
        for (to, layer) in [("back", "forward."), ("fore", "backward.")] {
            let [from, to] = ["in", to].map(|stem| at.join(format!("{stem}.{frame:04}.exr")));
            without_layer(&from, &to, layer);
        }
    }
    let run = |input: &str, out: &str, more: &[&str]| {
        let fixed = ["cartoon", input, out, "--frames", "5", "--steadiness", "0.5"];
        succeeds(&mut apply(at, &[&fixed[..], more].concat()));
        pixels(&at.join(out.replace("####", "0005")))
    };
    let both = run(INPUT, "both.####.exr", &[]);
    // The layer that is read for both ways, as the convention has it.
    let read = run(INPUT, "read.####.exr", &["--motion-convention", "isophote,direction=backward"]);
    let back = run("back.####.exr", "a.####.exr", &[]);
    assert!(back == read, "the layer to the frame before does not stand for the way to the frame after");
    assert!(back == run(INPUT, "b.####.exr", &["--motion", "back.####.exr", "--guide", "motion=backward"]));
    let fore = run("fore.####.exr", "c.####.exr", &[]);
    let alone = run("back.####.exr", "d.####.exr", &["--guide", "motion_forward=none"]);
    assert!(alone != back && fore != alone && fore != both);
}

#[test]
fn motion_is_estimated_where_nobody_knows_it() {
    let folder = folder();
    let at = folder.path();
    shot(at, INPUT, "96x64");
    let run = |out: &str, more: &[&str]| {
        let fixed = ["cartoon", INPUT, out, "--steadiness", "0.5", "--motion", "estimate"];
        succeeds(&mut apply(at, &[&fixed[..], more].concat()));
    };
    run("all.####.exr", &["--frames", "3-7"]);
    run("part.####.exr", &["--frames", "5-7"]);
    run("one.####.exr", &["--frames", "7"]);
    succeeds(&mut apply(at, &["cartoon", INPUT, "still.####.exr", "--frames", "3-7"]));
    for frame in 3..=7 {
        let name = |stem: &str| format!("{stem}.{frame:04}.exr");
        assert_ne!(bytes(at, &name("all")), bytes(at, &name("still")), "frame {frame} is not steadied");
        if frame >= 5 {
            assert!(bytes(at, &name("all")) == bytes(at, &name("part")), "frame {frame} of a chunk");
        }
    }
    assert!(bytes(at, "all.0007.exr") == bytes(at, "one.0007.exr"));
}

#[test]
fn what_cannot_be_steady_is_refused() {
    let folder = folder();
    let at = folder.path();
    shot(at, INPUT, "96x64");
    let refused = |more: &[&str], words: &[&str]| fails(&mut apply(at, more), 2, words);
    let cartoon = ["cartoon", INPUT, "no.####.exr"];
    let with = |more: &[&'static str]| [&cartoon[..], more].concat();
    refused(
        &["gaussian", INPUT, "no.####.exr", "--steadiness", "0.5"],
        &["--steadiness", "has no steadiness"],
    );
    refused(&with(&["--steadiness", "2"]), &["--steadiness 2"]);
    refused(&with(&["--motion", INPUT]), &["--motion", "reads no motion"]);
    refused(&with(&["--steadiness", "0.5", "--motion", "mv.exr"]), &["frame number"]);
    refused(
        &with(&["--steadiness", "0.5", "--motion", "mv.####.exr"]),
        &["mv.####.exr", "none of the frames"],
    );
    refused(&with(&["--steadiness", "0.5", "--motion-convention", "maya"]), &["arnold"]);
    refused(&["cartoon", INPUT, INPUT, "--steadiness", "0.5", "--in-place"], &["would take the place"]);
    let one = ["cartoon", "in.0001.exr", "no.exr", "--steadiness", "0.5", "--motion", INPUT];
    refused(&one, &["--motion", "no neighbours"]);
    refused(&with(&["--steadiness", "0.5", "--memory", "1MiB"]), &["depend on each other", "--memory"]);
    assert!(!listing(at).iter().any(|name| name.starts_with("no.")));
    // Motion in another size.
    fs::create_dir(at.join("half")).expect("a folder");
    shot(at, "half/mv.####.exr", "48x32");
    let half = with(&["--steadiness", "0.5", "--motion", "half/mv.####.exr", "--frames", "3"]);
    refused(&half, &["48x32", "96x64"]);
}

#[test]
fn rendered_frames_are_steady_in_any_order() {
    let folder = folder();
    let at = folder.path();
    for backend in ["gpu", "cpu"] {
        let render = |out: &str, more: &[&str]| {
            let mut command = isophote();
            command.current_dir(at).arg("render").arg(cube(at)).arg(format!("{out}-{backend}.####.exr"));
            command
                .args(["--size", "96x64", "--style", "ink", "--tone-mapped", "--backend", backend])
                .args(more);
            succeeds(command.args(["--start", "0"]));
        };
        render("all", &["--turntable", "--frames", "1-6", "--steadiness", "0.5"]);
        render("some", &["--turntable", "--frames", "6,3,1", "--steadiness", "0.5"]);
        render("still", &["--turntable", "--frames", "1-6"]);
        for frame in [1, 3, 6] {
            let name = |stem: &str| at.join(format!("{stem}-{backend}.{frame:04}.exr"));
            assert_eq!(pixels(&name("all")), pixels(&name("some")), "frame {frame} on the {backend}");
            let is_first = frame == 1;
            assert_eq!(pixels(&name("all")) == pixels(&name("still")), is_first, "frame {frame}");
        }
    }
    // Both ways carry the same frames along the same motion.
    let [gpu, cpu] = ["gpu", "cpu"].map(|backend| pixels(&at.join(format!("all-{backend}.0006.exr"))));
    let far = gpu.iter().zip(&cpu).filter(|(a, b)| (*a - *b).abs() > 0.02).count();
    assert!(far * 50 <= gpu.len(), "{far} of {} numbers differ", gpu.len());
}

#[test]
fn what_guides_and_what_steadies_is_told() {
    let folder = folder();
    let at = folder.path();
    shot(at, INPUT, "48x32");
    let (text, warnings) =
        succeeds(&mut apply(at, &["cartoon", INPUT, "o.####.exr", "--frames", "2", "--steadiness", "0.5"]));
    let line = text.lines().find(|line| line.starts_with("guides: ")).expect("a line");
    for part in ["normal from ", "depth from ", "motion from "] {
        assert!(line.contains(part), "{line}");
    }
    assert!(!warnings.contains("nothing will be steady"), "{warnings}");
    // Pictures know of no motion.
    for frame in 1..=3 {
        let path = at.join(format!("p.{frame:04}.png"));
        support::picture(48, 32).save(path).expect("the picture can be written");
    }
    let still = ["cartoon", "p.####.png", "q.####.png"];
    let run = |more: &[&str]| succeeds(&mut apply(at, &[&still[..], more].concat())).1;
    let warnings = run(&["--steadiness", "0.5"]);
    assert!(
        warnings.contains("nothing will be steady") && warnings.contains("--motion estimate"),
        "{warnings}"
    );
    assert!(!run(&["--force"]).contains("steady"));
    assert!(!run(&["--force", "--steadiness", "0.5", "--motion", "estimate"]).contains("steady"));
}
