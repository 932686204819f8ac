//! The command line as people type it who have not read the manual: files without a verb, styles without `apply`, results
//! without a name, options of other programs.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::support::{
    IN_PIXELS, fails, folder, isophote, listing, picture, succeeds, turning_triangle, video_folder,
};
use isophote_finishing::stylize::suggest;

/// The program in a folder.
fn run(folder: &Path, words: &[&str]) -> Command {
    let mut command = isophote();
    command.current_dir(folder).args(words);
    command
}

/// `apply` in a folder, on the CPU; returns what it prints.
fn applied(folder: &Path, words: &[&str]) -> String {
    let mut command = run(folder, &["apply"]);
    succeeds(command.args(words).args(IN_PIXELS).args(["--backend", "cpu"])).0
}

fn save(folder: &Path, names: &[&str]) {
    for name in names {
        picture(48, 32).save(folder.join(name)).expect("the picture can be written");
    }
}

#[test]
fn a_file_in_the_place_of_a_verb_is_opened() {
    let folder = folder();
    save(folder.path(), &["photo.png", "shot.0001.png", "shot.0002.png"]);
    turning_triangle(folder.path());
    // Elsewhere a window needs no display that has a name.
    #[cfg(target_os = "linux")]
    for file in ["photo.png", "shot.####.png", "triangle.gltf", "./photo.png"] {
        let mut command = run(folder.path(), &[file]);
        for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
            command.env_remove(name);
        }
        // Without a display it says what makes pictures all the same.
        fails(&mut command, 1, &["no window can be opened", "DISPLAY", "isophote apply"]);
    }
    fails(&mut run(folder.path(), &["none.png"]), 2, &["none.png: cannot be opened"]);
    let two = &["photo.png", "shot.0001.png"];
    fails(
        &mut run(folder.path(), two),
        2,
        &["shot.0001.png: is one more than the window opens", "apply STYLE"],
    );
}

#[test]
#[cfg(target_os = "linux")]
fn a_window_without_a_graphics_driver_says_what_to_install() {
    let Some(display) = crate::support::window::Display::open("640x480") else { return };
    let folder = folder();
    save(folder.path(), &["photo.png"]);
    let mut command = run(folder.path(), &["photo.png"]);
    command.env("DISPLAY", &display.name).env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        command.env(variable, "/nonexistent.json");
    }
    fails(&mut command, 1, &["the window cannot be drawn on", "mesa-vulkan-drivers"]);
}

#[test]
fn a_style_in_the_place_of_a_verb_is_told_with_the_words_that_were_typed() {
    let folder = folder();
    for (words, advice) in [
        (&["cartoon", "a.png", "my b.png"][..], "did you mean `isophote apply cartoon a.png \"my b.png\"`?"),
        (&["look:noir_panel", "a.png"], "did you mean `isophote apply look:noir_panel a.png`?"),
        (&["noir", "a.png"], "did you mean `isophote apply look:noir_panel a.png`?"),
        (&["my.json", "a.png"], "did you mean `isophote apply my.json a.png`?"),
        (&["pencil", "a.png"], "did you mean `isophote apply ink a.png --set style=pencil`?"),
        (&["toon"], "did you mean `isophote apply cartoon PICTURE`?"),
    ] {
        fails(&mut run(folder.path(), words), 2, &[words[0], advice]);
    }
    let misspelt = ["aply", "cartoon", "a.png"];
    fails(&mut run(folder.path(), &misspelt), 2, &["aply: is no command", "`isophote apply cartoon a.png`"]);
    fails(&mut run(folder.path(), &["zzzzzzzz"]), 2, &["zzzzzzzz: is no command", "isophote --help"]);
}

#[test]
fn a_result_without_a_name_lies_beside_the_picture() {
    let folder = folder();
    let at = folder.path();
    save(at, &["a.png", "b.webp", "shot.0001.png", "shot.0002.png"]);
    fs::write(at.join("my.json"), r#"{"style": "gaussian", "parameters": {"sigma": 1}}"#).expect("a file");
    assert!(applied(at, &["gaussian", "a.png"]).starts_with("a.gaussian.png: 48x32, "));
    assert!(applied(at, &["look:noir_panel", "b.webp"]).starts_with("b.noir_panel.png: 48x32, "));
    assert!(applied(at, &["my.json", "a.png"]).starts_with("a.my.png: "));
    let said = applied(at, &["--preset", "my.json", "shot.####.png"]);
    assert!(said.starts_with("2 frames written") && said.contains("shot.my.####.png"), "{said}");
    let names = "a.gaussian.png a.my.png a.png b.noir_panel.png b.webp my.json shot.0001.png shot.0002.png \
                 shot.my.0001.png shot.my.0002.png";
    assert_eq!(listing(at).join(" "), names);
    // No file is replaced without a word, and a picture gives way to its own result alone.
    fails(&mut run(at, &["apply", "gaussian", "a.png"]), 2, &["a.gaussian.png", "--force"]);
    applied(at, &["gaussian", "a.png", "--force"]);
    let before = fs::read(at.join("a.png")).expect("a picture");
    applied(at, &["gaussian", "a.png", "--in-place"]);
    assert_ne!(fs::read(at.join("a.png")).expect("a picture"), before);
    assert_eq!(listing(at).join(" "), names);
}

#[test]
fn a_folder_as_the_result_is_written_into() {
    let folder = folder();
    let at = folder.path();
    save(at, &["a.png", "b.png"]);
    fs::create_dir_all(at.join("in")).expect("a folder");
    save(&at.join("in"), &["c.png"]);
    applied(at, &["gaussian", "a.png", "new/"]);
    applied(at, &["gaussian", "a.png", "b.png", "in", "many/"]);
    // Of a folder nothing else can be the result.
    applied(at, &["gaussian", "in", "others"]);
    fails(&mut run(at, &["apply", "gaussian", "in", "other.png"]), 2, &["in: is a folder"]);
    // In its own folder a picture would be its own result.
    applied(at, &["gaussian", "a.png", "."]);
    applied(at, &["gaussian", "in/c.png", "."]);
    assert_eq!(listing(at), ["a.gaussian.png", "a.png", "b.png", "c.png", "in", "many", "new", "others"]);
    assert_eq!(listing(&at.join("new")), ["a.png"]);
    assert_eq!(listing(&at.join("others")), ["c.png"]);
    assert_eq!(listing(&at.join("many")), ["a.png", "b.png", "c.png"]);
    fails(&mut run(at, &["apply", "gaussian", "a.png", "new"]), 2, &["new/a.png", "--force"]);
    fails(&mut run(at, &["apply", "gaussian", "in"]), 2, &["in: is a folder", "a folder for the results"]);
    assert_eq!(listing(&at.join("in")), ["c.png"]);
}

#[test]
fn options_that_are_none_are_told_how_they_are_written() {
    let folder = folder();
    let at = folder.path();
    save(at, &["a.png"]);
    for (words, said) in [
        (
            &["apply", "a.png", "b.png", "--style", "ink"][..],
            &["the style comes first", "`isophote apply ink a.png b.png`"][..],
        ),
        (&["apply", "cartoon", "a.png", "--style=ink"], &["`isophote apply ink a.png`"]),
        (
            &["apply", "ink", "a.png", "--line_width=3"],
            &["is a parameter of the style", "`--set line_width=3`"],
        ),
        (&["apply", "ink", "a.png", "--line-width", "3"], &["`--set line_width=3`"]),
        (&["render", "a.gltf", "a.png", "--posterize", "4"], &["`--set posterize=4`"]),
        (&["apply", "ink", "a.png", "-o", "b.png"], &["the result comes after the picture"]),
        (&["apply", "ink", "a.png", "--memory", "4"], &["write 4GiB"]),
        (&["apply", "ink", "a.png", "--forse"], &["'--force'"]),
    ] {
        fails(&mut run(at, words), 2, said);
    }
    fails(&mut run(at, &["apply", "a.png", "b.png"]), 2, &["a.png: is no style", "before the picture"]);
    assert_eq!(listing(at), ["a.png"]);
}

#[test]
fn names_that_are_none_are_told_the_nearest() {
    let folder = folder();
    let at = folder.path();
    save(at, &["a.png"]);
    for (typed, meant) in [
        ("toon", "'cartoon'"),
        ("Cartoon", "'cartoon'"),
        ("oil", "'oil_paint'"),
        ("watercolour", "'watercolor'"),
        ("pencil", "'ink' with --set style=pencil"),
        ("charcoal", "'ink' with --set style=charcoal"),
        ("sketch", "'ink' with --set style=pencil"),
        ("pensil", "'ink' with --set style=pencil"),
        ("look:noir", "'look:noir_panel'"),
        ("look:cartoon", "'cartoon'"),
        ("copperplate", "'look:copperplate'"),
        ("coperplate", "'look:copperplate'"),
        ("engraving", "'look:copperplate'"),
        ("anisotropic-kuwahara", "'anisotropic_kuwahara'"),
    ] {
        let meant = format!("did you mean {meant}?");
        fails(&mut run(at, &["apply", typed, "a.png", "b.png"]), 2, &[typed, &meant]);
        fails(&mut run(at, &["view", "--style", typed]), 2, &[typed, &meant]);
        if !typed.contains("copperplate") {
            fails(&mut run(at, &["nodes", typed]), 2, &[typed, &meant]);
        }
    }
    let set = |setting| run(at, &["apply", "ink", "a.png", "b.png", "--set", setting]);
    fails(&mut set("line_with=3"), 2, &["did you mean 'line_width'?"]);
    fails(&mut set("spacing=3"), 2, &["did you mean 'hatch_spacing'?"]);
    fails(&mut set("style=pensil"), 2, &["did you mean 'pencil'?"]);
    // Every word of the table leads to what is there.
    for (word, _) in suggest::WORDS {
        fails(&mut run(at, &["nodes", word]), 2, &[word, "did you mean"]);
    }
}

#[test]
fn a_look_is_shown_as_a_node_is() {
    let (shown, _) = succeeds(isophote().args(["nodes", "copperplate"]));
    for part in ["Copperplate (look:copperplate, a look of ink)", "engraved in metal", "hatch_spacing = 0.6"]
    {
        assert!(shown.contains(part), "{shown}");
    }
    assert_eq!(succeeds(isophote().args(["nodes", "look:copperplate"])).0, shown);
    let (json, _) = succeeds(isophote().args(["nodes", "copperplate", "--json"]));
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["look"], "look:copperplate");
}

#[test]
fn a_run_that_goes_well_says_one_line_unless_it_is_to_be_quiet() {
    let folder = folder();
    let at = folder.path();
    save(at, &["a.png"]);
    turning_triangle(at);
    assert!(applied(at, &["gaussian", "a.png", "b.png"]).starts_with("b.png: 48x32, "));
    assert_eq!(applied(at, &["gaussian", "a.png", "c.png", "--quiet"]), "");
    assert_eq!(applied(at, &["gaussian", "a.png", "b.png", "--skip-existing"]), "b.png: there already\n");
    let render = ["render", "triangle.gltf", "t.png", "--size", "32x24", "--force"];
    let (said, _) = succeeds(&mut run(at, &render));
    assert!(said.starts_with("t.png: 32x24, ") && said.lines().count() == 1, "{said}");
    assert_eq!(succeeds(run(at, &render).arg("--quiet")).0, "");
    // A folder gets pictures with the scene's name.
    let (said, _) = succeeds(&mut run(at, &["render", "triangle.gltf", "new/", "--size", "32x24"]));
    assert!(said.contains("triangle.png: 32x24, ") && at.join("new/triangle.png").is_file(), "{said}");
    fails(
        &mut run(at, &["render", "triangle.gltf", "new", "--size", "32x24"]),
        2,
        &["triangle.png", "--force"],
    );
    succeeds(&mut run(at, &["render", "triangle.gltf", "new", "--size", "32x24", "--frames", "2"]));
    assert!(at.join("new/triangle.0002.png").is_file());
    fails(&mut run(at, &["render", "triangle.gltf", "other/", "--encode", "-c:v ffv1"]), 2, &["--encode"]);
    assert!(!at.join("other").exists());
}

#[test]
fn a_video_that_is_to_be_a_picture_is_told_what_to_name() {
    let Some(folder) = video_folder() else { return };
    fs::write(folder.path().join("clip.mp4"), "no video yet").expect("a file");
    let to_picture = ["apply", "ink", "clip.mp4", "out.png"];
    fails(&mut run(folder.path(), &to_picture), 2, &["out.mp4", "a video has many", "out.####.png"]);
    save(folder.path(), &["shot.png"]);
    let to_video = ["apply", "ink", "shot.png", "out.mp4"];
    fails(&mut run(folder.path(), &to_video), 2, &["out.mp4", "shot.####.png", "out.png"]);
}

#[test]
fn help_opens_with_examples() {
    for words in [&["--help"][..], &["-h"]] {
        let (help, _) = succeeds(isophote().args(words));
        let usage = help.find("Usage:").expect("a usage");
        assert_eq!(help[..usage].lines().filter(|line| line.starts_with("  isophote ")).count(), 4, "{help}");
    }
}

#[test]
fn help_spells_colour_in_one_way() {
    for verb in ["render", "apply", "view", "sheet", "preset", "farm", "info", "nodes", "bench", "documents"]
    {
        let (text, _) = succeeds(isophote().args([verb, "--help"]));
        let words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
        // Ids of styles, and of a chunk of PNG files, are names.
        let is_id = |word: &&str| ["watercolor", "colorInteropID"].contains(word);
        let bad: Vec<&str> =
            words.filter(|word| word.to_lowercase().contains("color") && !is_id(word)).collect();
        assert!(bad.is_empty(), "{verb}: write 'colour', not {bad:?}");
    }
}
