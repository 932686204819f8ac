//! Rules of presets for things in pictures, found by Cryptomattes and by object ids.

use std::fs;
use std::path::Path;
use std::process::Command;

use exr::prelude::*;
use isophote_finishing::stylize::preset::Title;
use isophote_loader::abi::{ISOPHOTE_SPACE_LINEAR, IsophoteRequest};
use isophote_loader::{Control, Input, Library};
use isophote_pictures::pixels::{Pixels, Precision, Samples};
use isophote_window::jobs::document::{Document, Options};
use isophote_window::state::look::EditedLook;
use isophote_window::state::outcome::{Opened, Outcome};
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;

use crate::support::mattes::*;
use crate::support::{self, IN_PIXELS, fails, folder, isophote, succeeds};

/// A picture with a Cryptomatte, and with numbers of objects: 3 on its right half.
fn save_numbered(path: &Path) {
    let listed = manifest(&["hero", "props/barrel", "props/box", "a,b*"]);
    let number = |at: usize| if at % SIZE.0 < SIZE.0 / 2 { 1.0 } else { 3.0 };
    let ids = ("object_id.id".to_owned(), FlatSamples::F32((0..PIXELS).map(number).collect()));
    let channels = [colours(), matte("crypto_object", ["R", "G", "B", "A"]), vec![ids]].concat();
    save(path, vec![("", channels, attributes("f834d0a", "crypto_object", ("manifest", &listed)))]);
}

/// `isophote apply` in a folder, with a preset of a style and its rules.
fn apply(folder: &Path, (style, rules): (&str, &str), arguments: &[&str]) -> Command {
    let preset = format!(r#"{{"style": "{style}", "objects": [{rules}]}}"#);
    fs::write(folder.join("rules.json"), preset).expect("the folder is writable");
    let mut command = isophote();
    command.current_dir(folder).args(["apply", "--preset", "rules.json"]).args(arguments);
    command.args(["--force", "--backend", "cpu"]).args(IN_PIXELS);
    command
}

#[test]
fn rules_direct_the_things_that_they_match() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save_numbered(&at("in.exr"));
    let ruled = |style: &str, rules: &str| {
        succeeds(&mut apply(folder.path(), (style, rules), &["in.exr", "out.exr"]));
        rgb(&at("out.exr"))
    };
    let changed = |style: &str, rules: &str| -> Vec<bool> {
        ruled(style, "").iter().zip(&ruled(style, rules)).map(|(a, b)| a != b).collect()
    };
    // What changes nothing changes no bit.
    let neutral =
        r#"{"match": "cryptomatte:*", "detail": 1, "line_width": 1}, {"match": "id:3", "lines": true}"#;
    assert!(!changed("cartoon", neutral).contains(&true));
    // Pigment has no reach but for what has bled; far from the things nothing changes.
    for (things, near) in [
        ("cryptomatte:hero", coverage(&["hero"])),
        ("id:1", (0..PIXELS).map(|at| f32::from(at % SIZE.0 < SIZE.0 / 2)).collect()),
    ] {
        let changed = changed("watercolor", &format!(r#"{{"match": "{things}", "medium": 4}}"#));
        let inside = (0..PIXELS).filter(|at| near[*at] == 1.0 && changed[*at]).count();
        assert!(inside * 2 > near.iter().filter(|covered| **covered == 1.0).count(), "{things}: {inside}");
        assert!((0..PIXELS).filter(|at| at % SIZE.0 == SIZE.0 - 1).all(|at| !changed[at]), "{things}");
    }
    // The last rule counts, and takes back what one before it wants.
    let both = r#"{"match": "cryptomatte:*", "detail": 4}, {"match": "id:1,3", "detail": 1}"#;
    assert!(!changed("cartoon", both).contains(&true));
    assert!(changed("cartoon", r#"{"match": "cryptomatte:*", "detail": 4}"#).contains(&true));
    let both = r#"{"match": "cryptomatte:*", "lines": false}, {"match": "id:1,3", "lines": true}"#;
    assert!(!changed("cartoon", both).contains(&true));
}

#[test]
fn a_rule_does_what_a_painted_map_does() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save_numbered(&at("in.exr"));
    let rule = r#"{"match": "id:1,3", "lines": false}"#;
    let run = |rules: &str, more: &[&str]| {
        let arguments = [&["in.exr", "out.exr"], more].concat();
        succeeds(&mut apply(folder.path(), ("cartoon", rules), &arguments));
        rgb(&at("out.exr"))
    };
    let [wide, high] = [SIZE.0, SIZE.1].map(|side| side as u32);
    let painted = |name: &str, blue: u8| {
        let map = image::RgbaImage::from_pixel(wide, high, image::Rgba([128, 128, blue, 255]));
        map.save(at(name)).expect("it can be written");
    };
    painted("none.png", 0);
    painted("most.png", 255);
    let ruled = run(rule, &[]);
    assert_eq!(ruled, run("", &["--control", "none.png"]));
    assert_ne!(ruled, run("", &[]));
    // A painted map brings back no lines that a rule takes, and counts where there is no rule.
    assert_eq!(ruled, run(rule, &["--control", "most.png"]));
    assert_ne!(ruled, run("", &["--control", "most.png"]));
}

#[test]
fn frames_follow_rules_by_themselves_and_beside_others() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for frame in 1..=3 {
        save_numbered(&at(&format!("in.{frame:04}.exr")));
    }
    let run = |rules: &str, more: &[&str]| {
        let arguments = [&["in.####.exr", "out.####.exr"], more].concat();
        succeeds(&mut apply(folder.path(), ("cartoon", rules), &arguments));
        [1, 2, 3].map(|frame| rgb(&at(&format!("out.{frame:04}.exr"))))
    };
    let rule = r#"{"match": "cryptomatte:*", "lines": false}"#;
    let ruled = run(rule, &[]);
    assert!(ruled.iter().all(|frame| *frame == ruled[0]));
    assert_ne!(ruled, run("", &[]));
    // Neighbours are read with their own rules, in whatever order.
    let steady = ["--steadiness", "0.5", "--motion", "estimate"];
    let all = run(rule, &steady);
    assert_ne!(all, run("", &steady));
    fs::remove_file(at("out.0002.exr")).expect("it was written");
    let one = [&["in.####.exr", "out.####.exr", "--frames", "2"], &steady[..]].concat();
    succeeds(&mut apply(folder.path(), ("cartoon", rule), &one));
    assert_eq!(rgb(&at("out.0002.exr")), all[1]);
}

#[test]
fn things_have_looks_of_their_own() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save_numbered(&at("in.exr"));
    let run = |rules: &str| {
        succeeds(&mut apply(folder.path(), ("cartoon", rules), &["in.exr", "out.exr"]));
        rgb(&at("out.exr"))
    };
    let layered = |looks: &str| {
        fs::write(at("looks.json"), looks).expect("the folder is writable");
        let mut command = isophote();
        command
            .current_dir(folder.path())
            .args("apply --layered looks.json in.exr out.exr --force".split(' '));
        succeeds(command.args(["--backend", "cpu"]).args(IN_PIXELS));
        rgb(&at("out.exr"))
    };
    // Written out, by name, and as a preset beside it.
    let written = r#"{"match": "cryptomatte:hero", "look": {"style": "ink", "parameters": {"tone": 0.8}}}"#;
    let hero = r#"{"style": "ink", "parameters": {"tone": 0.8}}"#;
    fs::write(at("hero.json"), hero).expect("the folder is writable");
    let beside = r#"{"match": "cryptomatte:hero", "look": "hero.json"}"#;
    let wanted = layered(
        r#"[{"style": "cartoon"}, {"style": "ink", "params": {"tone": 0.8}, "mask": "cryptomatte:hero"}]"#,
    );
    assert_eq!(run(written), wanted);
    assert_eq!(run(beside), wanted);
    assert_ne!(run(""), wanted);
    let named = r#"{"match": "id:3", "look": "watercolor"}"#;
    assert_eq!(run(named), layered(r#"[{"style": "cartoon"}, {"style": "watercolor", "mask": "id:3"}]"#));
    // Factors direct a thing in its own look as well, and a style of its own need not follow rules.
    let both = r#"{"match": "id:3", "look": "ink", "lines": false}"#;
    assert_ne!(run(both), run(r#"{"match": "id:3", "look": "ink"}"#));
    let mut blurred = apply(folder.path(), ("gaussian", named), &["in.exr", "out.exr"]);
    succeeds(&mut blurred);
}

#[test]
fn lines_of_things_have_colours_of_their_own() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    // Two things side by side, the left one nearer, of other brightness.
    let is_left = |at: usize| at % SIZE.0 < SIZE.0 / 2;
    let channel = |name: &str, value: &dyn Fn(usize) -> f32| {
        (name.to_owned(), FlatSamples::F32((0..PIXELS).map(value).collect()))
    };
    let grey = |at: usize| if is_left(at) { 0.1 } else { 0.8 };
    let colours = ["R", "G", "B"].map(|name| channel(name, &grey));
    let ids = channel("object_id.id", &|at| if is_left(at) { 1.0 } else { 3.0 });
    let depth = channel("Z", &|at| if is_left(at) { 1.0 } else { 9.0 });
    save(&at("in.exr"), vec![("", [&colours[..], &[ids, depth]].concat(), Default::default())]);
    let run = |rules: &str| {
        succeeds(&mut apply(folder.path(), ("cartoon", rules), &["in.exr", "out.exr"]));
        rgb(&at("out.exr"))
    };
    let (plain, near, far) = (
        run(""),
        run(r##"{"match": "id:1", "line_color": "#ff0000"}"##),
        run(r##"{"match": "id:3", "line_color": "#ff0000"}"##),
    );
    let red = |pixels: &[[f32; 3]], side: &dyn Fn(usize) -> bool| {
        let is_red = |pixel: &[f32; 3]| pixel[0] > 2.0 * pixel[1] + 0.05;
        pixels.iter().enumerate().filter(|(at, pixel)| side(*at) && is_red(pixel)).count()
    };
    assert_eq!(red(&plain, &|_| true), 0);
    assert!(red(&near, &|_| true) > SIZE.1, "the line between has the colour of the nearer");
    assert_eq!(red(&far, &|at| at % SIZE.0 <= SIZE.0 / 2), 0, "and not that of the farther");
    let without = r##"{"match": "id:1", "line_color": "#ff0000"}"##;
    let kinds = ["in.exr", "out.exr", "--set", "line_colors=kinds"];
    succeeds(&mut apply(folder.path(), ("cartoon", without), &kinds));
    assert!(red(&rgb(&at("out.exr")), &|_| true) > SIZE.1, "all kinds of its lines have it");
    fails(
        &mut apply(folder.path(), ("watercolor", without), &["in.exr", "out.exr"]),
        2,
        &["one colour for all"],
    );
    let none = r#"{"match": "id:1", "line_color": "reddish"}"#;
    fails(
        &mut apply(folder.path(), ("cartoon", none), &["in.exr", "out.exr"]),
        2,
        &["object 1", "no colour"],
    );
}

/// Channels of a file from names and values by pixel.
fn channel(name: &str, value: &dyn Fn(usize) -> f32) -> (String, FlatSamples) {
    (name.to_owned(), FlatSamples::F32((0..PIXELS).map(value).collect()))
}

/// Greatest difference between a cartoon by rules of the program, on a file with these channels beside its colour, and by the library
/// itself, on pictures of the channels whose names begin as these guides.
fn apart(
    folder: &Path,
    rules: &str,
    channels: &[(String, FlatSamples)],
    guides: [(&'static str, &str); 2],
) -> f32 {
    let value = |at: usize| ((at % SIZE.0 / 5 + at / SIZE.0 / 5) % 2) as f32 * 0.5 + 0.2;
    let texts = attributes("f834d0a", "crypto_object", ("manifest", &manifest(&["hero", "props/box"])));
    let all = ["R", "G", "B"].map(|name| channel(name, &value)).into_iter().chain(channels.iter().cloned());
    save(&folder.join("in.exr"), vec![("", all.collect(), texts)]);
    let mut command = apply(folder, ("cartoon", rules), &["in.exr", "out.exr"]);
    if !guides.iter().any(|(name, _)| *name == "object_id") {
        // Or the program would number the things of the Cryptomatte.
        command.args(["--guide", "object_id=none"]);
    }
    succeeds(&mut command);

    let library = Library::from_file(support::library()).expect("the library");
    let json = format!(r#"{{"style": "cartoon", "lengths": "pixels", "objects": [{rules}]}}"#);
    let style = library.style_from_json("rules.json", &json, None).expect("it opens");
    assert_eq!(style.left_out().expect("a list"), []);
    let size = (SIZE.0 as u32, SIZE.1 as u32);
    let picture = |planes: Vec<Vec<f32>>| {
        let numbers = (0..PIXELS).flat_map(|at| planes.iter().map(move |plane| plane[at])).collect();
        Pixels::new(size.0, size.1, planes.len() as u32, Samples::F32(numbers)).expect("as many")
    };
    let guide = |first: &str| {
        let own = channels.iter().filter(|(name, _)| name.starts_with(first));
        picture(own.map(|(_, values)| values.values_as_f32().collect()).collect())
    };
    let color = picture(vec![(0..PIXELS).map(value).collect(); 3]);
    let [one, other] = guides.map(|(name, first)| (name, guide(first)));
    let inputs = [("color", &color), (one.0, &one.1), (other.0, &other.1)];
    let inputs = inputs.map(|(name, pixels)| Input { name, pixels });
    let guides = library.guide_bits(guides.map(|(name, _)| name)).expect("they are known");
    let usual = library.request(size).expect("the size is possible");
    let request = IsophoteRequest { space: ISOPHOTE_SPACE_LINEAR, guides, ..usual };
    let mut result = Pixels::zeroed(size.0, size.1, 3, Precision::F32);
    let mut graph = style.graph().expect("a graph");
    graph.process(None, &request, &inputs, &mut result, &mut Control::default()).expect("it is computed");
    let wanted = result.to_f32();
    rgb(&folder.join("out.exr")).concat().iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// The library follows rules by number and by whole names itself, where the program makes maps of what things cover.
#[test]
fn rules_by_number_and_by_name_are_those_of_the_library() {
    let folder = folder();
    let is_left = |at: usize| at % SIZE.0 < SIZE.0 / 2;
    let pick = |at: usize, left: f32, right: f32| if is_left(at) { left } else { right };
    let depth = channel("Z", &|at| pick(at, 2.0, 6.0));
    let ids = channel("object_id.id", &|at| pick(at, 1.0, 3.0));
    let numbered = r##"{"match": "id:1", "line_color": "#c02010", "line_width": 2}, {"match": "id:3", "lines": false, "detail": 0.5}"##;
    let guides = [("depth", "Z"), ("object_id", "object_id")];
    let most = apart(folder.path(), numbered, &[ids, depth.clone()], guides);
    assert!(most < 1e-5, "{most}");

    // Two things of a pixel, of which the one covers five eighths in the middle.
    let share = |at: usize| if at % SIZE.0 == SIZE.0 / 2 { 0.625 } else { 1.0 };
    let names = [
        channel("crypto_object00.R", &|at| pick(at, id("hero"), id("props/box"))),
        channel("crypto_object00.G", &share),
        channel("crypto_object00.B", &|at| if share(at) < 1.0 { id("hero") } else { 0.0 }),
        channel("crypto_object00.A", &|at| 1.0 - share(at)),
    ];
    let named = numbered.replace("id:1", "cryptomatte:hero").replace("id:3", "cryptomatte:props/box");
    let channels = [names.as_slice(), &[depth]].concat();
    let guides = [("depth", "Z"), ("cryptomatte", "crypto")];
    let most = apart(folder.path(), &named, &channels, guides);
    assert!(most < 1e-5, "{most}");
    let look = r##"{"match": "cryptomatte:hero", "look": {"style": "watercolor", "lengths": "pixels"}, "detail": 2}"##;
    let most = apart(folder.path(), look, &channels, guides);
    assert!(most < 1e-5, "{most}");
}

#[test]
fn names_are_written_out_for_hosts_that_have_no_list_of_them() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save_numbered(&at("in.exr"));
    fs::create_dir(at("looks")).expect("the folder is writable");
    fs::write(at("looks/skin.json"), r#"{"style": "watercolor", "parameters": {"bleeding": 0.4}}"#)
        .expect("the folder is writable");
    let rules = r#"{"match": "cryptomatte: props/*,hero", "detail": 2}, {"match": "cryptomatte:a*", "look": "skin.json"},
        {"match": "id:3", "look": "ink"}"#;
    fs::write(at("looks/rules.json"), format!(r#"{{"style": "cartoon", "objects": [{rules}]}}"#))
        .expect("the folder is writable");
    let save = |more: &str| {
        let mut command = isophote();
        command.current_dir(folder.path()).args(format!("preset save {more} --force").split(' '));
        command
    };
    let saved = |name: &str| -> serde_json::Value {
        let text = fs::read_to_string(at(name)).expect("it was written");
        serde_json::from_str(&text).expect("a preset")
    };
    succeeds(&mut save("looks/rules.json named.json --names-from in.exr"));
    let objects = &saved("named.json")["objects"];
    assert_eq!(objects[0]["match"], "cryptomatte:props/barrel,props/box,hero");
    assert_eq!(objects[1]["match"], r"cryptomatte:a\,b\*");
    assert_eq!(objects[1]["look"]["parameters"]["bleeding"], 0.4);
    assert_eq!((&objects[2]["match"], &objects[2]["look"]), (&"id:3".into(), &"ink".into()));
    // Without, names stay, and the look's file is found from the new place.
    succeeds(&mut save("looks/rules.json moved.json"));
    assert_eq!(saved("moved.json")["objects"][0]["match"], "cryptomatte: props/*,hero");
    let mut check = isophote();
    succeeds(check.current_dir(folder.path()).args(["preset", "check", "moved.json", "named.json"]));
    let shown = |preset: &str| {
        let mut command = isophote();
        command.current_dir(folder.path()).args([
            "apply",
            preset,
            "in.exr",
            "out.exr",
            "--force",
            "--backend",
            "cpu",
        ]);
        succeeds(&mut command);
        fs::read(at("out.exr")).expect("a result")
    };
    assert!(shown("named.json") == shown("moved.json"));
    fails(&mut save("cartoon none.json --names-from in.exr"), 2, &["--names-from", "has none"]);
    fs::write(
        at("looks/rules.json"),
        r#"{"style": "ink", "objects": [{"match": "cryptomatte:prop?", "detail": 2}]}"#,
    )
    .expect("the folder is writable");
    fails(
        &mut save("looks/rules.json none.json --names-from in.exr"),
        2,
        &["in.exr", "no 'prop?'", "props/box"],
    );
    assert!(!at("none.json").exists());
}

#[test]
fn looks_of_things_that_are_none_say_why() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save_numbered(&at("in.exr"));
    for (rules, more, words) in [
        (
            r#"{"match": "id:3", "look": {"style": "ink", "objects": []}}"#,
            "",
            &["object 1: its look", "rules"][..],
        ),
        (r#"{"match": "id:3", "look": {"style": "inc"}}"#, "", &["object 1: its look", "inc"]),
        (
            r#"{"match": "id:3", "look": {"stile": "ink"}}"#,
            "",
            &["object 1: its look", "did you mean 'style'"],
        ),
        (r#"{"match": "id:3", "look": 3}"#, "", &["object 1", "its look is none"]),
        (r#"{"match": "id:3", "look": "missing.json"}"#, "", &["missing.json"]),
        (r#"{"match": "id:3", "look": "rules.json"}"#, "", &["rules"]),
        (r#"{"match": "id:3", "look": "ink"}"#, "--mask=id:1", &["--mask", "--layered"]),
    ] {
        let more: Vec<&str> = more.split(' ').filter(|word| !word.is_empty()).collect();
        fails(
            &mut apply(folder.path(), ("cartoon", rules), &[&["in.exr", "out.exr"], &more[..]].concat()),
            2,
            words,
        );
    }
    let wrong = r#"{"style": "cartoon", "objects": [{"match": "id:3", "look": {"style": "ink", "parameters": {"tome": 1}}}]}"#;
    fs::write(at("wrong.json"), wrong).expect("the folder is writable");
    let mut check = isophote();
    check.current_dir(folder.path()).args(["preset", "check", "wrong.json"]);
    let said = support::errors(&check.output().expect("the program can be started"));
    assert!(said.contains("object 1: its look") && said.contains("tome"), "{said}");
}

#[test]
fn rules_that_cannot_be_followed_say_why() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save_numbered(&at("in.exr"));
    save_usual(&at("unnumbered.exr"));
    support::picture(24, 16).save(at("in.png")).expect("it can be written");
    for (style, rules, input, words) in [
        ("cartoon", r#"{"match": "hero"}"#, "in.exr", &["object 1", "'hero'", "cryptomatte:NAME"][..]),
        ("cartoon", r#"{"match": "id:hero"}"#, "in.exr", &["object 1", "id:3"]),
        ("cartoon", r#"{"match": "cryptomatte:villain"}"#, "in.exr", &["no 'villain'"]),
        ("cartoon", r#"{"match": "material:skin"}"#, "in.exr", &["crypto_material"]),
        ("cartoon", r#"{"match": "id:3"}"#, "unnumbered.exr", &["no layer or channel of object ids"]),
        ("cartoon", r#"{"match": "id:3"}"#, "in.png", &["rules for objects", "in.png"]),
        ("gaussian", r#"{"match": "id:3"}"#, "in.exr", &["objects", "does not follow"]),
        ("cartoon", r#"{"match": "id:3", "detail": 9}"#, "in.exr", &["object 1", "from 0.25 to 4"]),
    ] {
        let mut command = apply(folder.path(), (style, rules), &[input, "none.png"]);
        fails(&mut command, 2, words);
        assert!(!at("none.png").exists());
    }
    // A check finds words that no file could know, and all of them at once.
    let wrong = r#"{"style": "cartoon", "objects": [{"match": "hero"}, {"match": "id:x"}]}"#;
    fs::write(at("wrong.json"), wrong).expect("the folder is writable");
    let mut check = isophote();
    check.current_dir(folder.path()).args(["preset", "check", "wrong.json"]);
    let output = check.output().expect("the program can be started");
    let said = support::errors(&output);
    assert!(
        output.status.code() == Some(2) && said.contains("object 1") && said.contains("object 2"),
        "{said}"
    );
    // Names that some frames do not have are allowed as those of masks are.
    let absent = r#"{"match": "cryptomatte:villain", "lines": false}"#;
    let more = ["in.exr", "out.exr", "--on-unknown", "empty"];
    succeeds(&mut apply(folder.path(), ("cartoon", absent), &more));
    let one_of_several = r#"[{"style": "watercolor"}, {"preset": "rules.json", "mask": "cryptomatte:hero"}]"#;
    fs::write(at("looks.json"), one_of_several).expect("the folder is writable");
    let mut command = isophote();
    command.current_dir(folder.path()).args("apply --layered looks.json in.exr none.exr".split(' '));
    fails(&mut command, 2, &["objects", "one of several looks"]);
}

#[test]
fn saving_a_preset_keeps_its_rules() {
    let folder = folder();
    let rules = r#"{"match": "cryptomatte:hero/*", "detail": 2.0, "lines": false}"#;
    let preset = format!(r#"{{"style": "cartoon", "objects": [{rules}]}}"#);
    fs::write(folder.path().join("rules.json"), preset).expect("the folder is writable");
    let mut command = isophote();
    let save = "preset save rules.json kept.json --set posterize=3";
    succeeds(command.current_dir(folder.path()).args(save.split(' ')));
    let kept = fs::read_to_string(folder.path().join("kept.json")).expect("it was written");
    let kept: serde_json::Value = serde_json::from_str(&kept).expect("a preset");
    assert_eq!(
        kept["objects"],
        serde_json::from_str::<serde_json::Value>(&format!("[{rules}]")).expect("as above")
    );
}

#[test]
fn the_window_says_where_there_is_nothing_to_follow_rules_on_and_keeps_them() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let rules = r#"{"match": "id:3", "detail": 2.0}, {"match": "id:4", "look": "hero.json"}"#;
    let preset = format!(r#"{{"style": "cartoon", "objects": [{rules}]}}"#);
    fs::write(at("hero.json"), r#"{"style": "ink"}"#).expect("the folder is writable");
    fs::write(at("rules.json"), preset).expect("the folder is writable");
    let library = Library::from_file(support::library()).expect("the library");
    let open = |name: &Path| EditedLook::open(&library, name).expect("the look");
    let looks = vec![open(Path::new("none"))];
    let mut session = Session::new(library.clone(), looks, Settings::default()).expect("a session");
    support::picture(32, 16).save(at("photo.png")).expect("the folder is writable");
    let document = Document::open(&at("photo.png"), &Options::default()).expect("a picture");
    session.show_playback(document.playback().expect("a picture"));
    session.take_over(Outcome::Opened(Opened::Look(Box::new(open(&at("rules.json"))))));
    let said: Vec<&str> = session.notes.present().iter().map(|note| note.text.as_str()).collect();
    assert!(
        said.iter().any(|text| text.contains("rules for things, of which photo.png says nothing")),
        "{said:?}"
    );
    let mut look = session.look().clone();
    let before = look.preset.objects.clone();
    look.save(&at("kept.json"), Title::default()).expect("it can be written");
    assert!(before.len() == 2 && open(&at("kept.json")).preset.objects == before);
    // Looks of things are found from another folder, too.
    let other = support::folder();
    look.save(&other.path().join("kept.json"), Title::default()).expect("it can be written");
    let kept = open(&other.path().join("kept.json")).preset.objects;
    assert_eq!(kept[1].rule["look"], at("hero.json").display().to_string());
}
