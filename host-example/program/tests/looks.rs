//! The looks that ship with the program: that there are enough, that each can be used wherever a style can, and that
//! none is like another.

use std::fs;

use isophote_finishing::stylize::preset::{self, Lengths, Preset, Track};
use isophote_finishing::stylize::style::{Setting, Style};
use isophote_loader::catalogue::{Param, ParamKind};
use isophote_loader::{Control, Input, Library};
use isophote_pictures::pixels::{Pixels, Precision, Samples};

use crate::support::{self, cube, fails, folder, isophote, picture, succeeds};

const SIZE: (u32, u32) = (120, 80);
/// Mean difference of two pictures, in levels of 255, from which on viewers tell them apart side by side.
const VISIBLE: f32 = 5.0;
/// Looks of a style, at least; of a medium where a style has several.
const LEAST: usize = 3;

fn library() -> Library {
    Library::from_file(support::library()).expect("the library")
}

/// A look with the preset that it is.
struct ShippedPreset {
    id: &'static str,
    json: &'static str,
    preset: Preset,
}

impl ShippedPreset {
    fn style(&self) -> String {
        format!("look:{}", self.id)
    }
}

fn looks() -> Vec<ShippedPreset> {
    let preset = |look: &preset::Look| preset::of_look(look).expect("every look can be read");
    let look = |look: preset::Look| ShippedPreset { id: look.id, json: look.json, preset: preset(&look) };
    library().looks().expect("the looks").into_iter().map(look).collect()
}

/// The value that a look has for a parameter.
fn value<'a>(look: &'a ShippedPreset, id: &str) -> Option<&'a str> {
    look.preset.params.iter().find(|(name, _)| name == id).map(|(_, track)| match track {
        Track::Still(value) => value.as_str(),
        Track::Keys { .. } => panic!("{}: {id} has keyframes", look.id),
    })
}

/// Style that a look draws with, and the medium where that has several.
fn medium(look: &ShippedPreset) -> (&str, &str) {
    (&look.preset.style, value(look, "style").unwrap_or_default())
}

#[test]
fn there_are_enough_of_every_style() {
    let looks = looks();
    assert!(looks.len() >= 30, "{} looks", looks.len());
    let styles = library().catalogue().expect("the catalogue").nodes;
    for node in styles.iter().filter(|node| node.group == "styles") {
        let media = match node.params.iter().find(|p| p.id == "style").map(|p| &p.kind) {
            Some(ParamKind::Choice { options, .. }) => options.iter().map(|option| option.id).collect(),
            _ => vec![""],
        };
        for wanted in media.iter().map(|medium| (node.id, *medium)) {
            let count = looks.iter().filter(|look| medium(look) == wanted).count();
            assert!(count >= LEAST, "{wanted:?} has {count} looks");
        }
    }
    let order: Vec<&str> = looks.iter().map(|look| look.preset.style.as_str()).collect();
    let mut groups = order.clone();
    groups.dedup();
    let mut styles = order.clone();
    styles.sort_unstable();
    styles.dedup();
    assert_eq!(groups.len(), styles.len(), "looks of one style stand together: {order:?}");
}

#[test]
fn each_says_what_it_looks_like() {
    let looks = looks();
    for look in &looks {
        let title = &look.preset.title;
        let (name, about) = (title.name.as_deref().unwrap_or(""), title.about.as_deref().unwrap_or(""));
        assert!(name.len() > 2 && about.len() > 20 && about.ends_with('.'), "{}: {name}: {about}", look.id);
        assert!(!title.tags.is_empty(), "{} has no tag", look.id);
        assert_eq!(look.preset.lengths, Some(Lengths::Relative), "{}", look.id);
        let stem = name.to_lowercase().replace([' ', '-'], "_");
        assert_eq!(stem, look.id, "the id is the name");
        let lower = |tag: &String| tag.chars().all(|c| c.is_ascii_lowercase());
        assert!(title.tags.iter().all(lower), "{}: {:?}", look.id, title.tags);
    }
}

/// True where a slider reaches the value, or the value turns something off.
fn within(param: &Param, value: &str) -> bool {
    match &param.kind {
        _ if value == "0" => true,
        ParamKind::Float { slider, .. } => value.parse().is_ok_and(|v: f32| slider[0] <= v && v <= slider[1]),
        ParamKind::Int { slider, .. } => value.parse().is_ok_and(|v: i64| slider[0] <= v && v <= slider[1]),
        // That the library takes them says all.
        _ => true,
    }
}

#[test]
fn each_loads_and_stays_within_the_sliders() {
    let library = library();
    for look in looks() {
        let style = Style::load(&library, look.style(), &[]).expect("the look loads");
        let node = library.find_node(&look.preset.style).expect("the style is a node");
        assert_eq!(style.lengths, Lengths::Relative);
        for (id, _) in &look.preset.params {
            let param = node.params.iter().find(|p| p.id == id).expect("the node has the parameter");
            let value = value(&look, id).expect("it has a value");
            assert!(within(param, value), "{}: {id} = {value} is off the slider", look.id);
        }
    }
}

/// Result of a style on a picture with edges, slow changes and detail, on the CPU.
fn drawn(library: &Library, mut style: Style) -> Vec<f32> {
    style.lengths = Lengths::Pixels;
    let request = style.request(library, SIZE).expect("the size is possible");
    let input = picture(SIZE.0, SIZE.1).into_raw();
    let input = Pixels::new(SIZE.0, SIZE.1, 3, Samples::U8(input)).expect("as many samples as pixels");
    let mut result = Pixels::zeroed(SIZE.0, SIZE.1, 3, Precision::F32);
    let inputs = [Input { name: "color", pixels: &input }];
    style
        .graph
        .process(None, &request, &inputs, &mut result, &mut Control::default())
        .expect("the style can be computed");
    result.to_f32()
}

fn difference(a: &[f32], b: &[f32]) -> f32 {
    let sum: f32 = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum();
    255.0 * sum / a.len() as f32
}

#[test]
fn none_is_like_another_or_like_its_style() {
    let library = library();
    let looks = looks();
    let of =
        |look: &ShippedPreset| drawn(&library, Style::load(&library, look.style(), &[]).expect("it loads"));
    let pictures: Vec<Vec<f32>> = looks.iter().map(of).collect();
    for (index, (look, picture)) in looks.iter().zip(&pictures).enumerate() {
        let medium = value(look, "style").map(|medium| Setting {
            node: None,
            param: "style".to_owned(),
            value: medium.to_owned(),
        });
        let plain = Style::load(&library, &look.preset.style, medium.as_slice()).expect("the style loads");
        let far = difference(picture, &drawn(&library, plain));
        assert!(far > VISIBLE, "{} is like {}: {far}", look.id, look.preset.style);
        for (other, its) in looks.iter().zip(&pictures).skip(index + 1) {
            let far = difference(picture, its);
            assert!(far > VISIBLE, "{} is like {}: {far}", look.id, other.id);
        }
    }
}

#[test]
fn looks_take_the_place_of_styles_and_presets() {
    let folder = folder();
    let run = |arguments: &[&str]| {
        succeeds(isophote().current_dir(folder.path()).args(arguments));
        fs::read(folder.path().join(arguments[3])).expect("a picture was written")
    };
    let cpu = ["--backend", "cpu"];
    picture(48, 32).save(folder.path().join("in.png")).expect("the picture can be written");
    let by_name = run(&[&["apply", "look:linocut", "in.png", "a.png"], &cpu[..]].concat());
    // As a file that was saved from it.
    succeeds(isophote().current_dir(folder.path()).args(["preset", "save", "look:linocut", "mine.json"]));
    assert_eq!(by_name, run(&[&["apply", "mine.json", "in.png", "b.png"], &cpu[..]].concat()));
    let kept = fs::read_to_string(folder.path().join("mine.json")).expect("the preset was written");
    let looks = looks();
    let linocut = looks.iter().find(|look| look.id == "linocut").expect("the look is there");
    assert_eq!(kept, linocut.json);
    // As one of several, with a parameter of its own.
    let layered = r#"[{"style": "gaussian"}, {"preset": "look:linocut", "params": {"tone": 0.9}}]"#;
    fs::write(folder.path().join("layers.json"), layered).expect("a file can be written");
    let layers = ["apply", "--layered", "layers.json", "in.png", "c.png"];
    succeeds(isophote().current_dir(folder.path()).args(layers).args(cpu));
    let darker =
        run(&[&["apply", "look:linocut", "in.png", "d.png", "--set", "tone=0.9"], &cpu[..]].concat());
    assert_eq!(fs::read(folder.path().join("c.png")).expect("as above"), darker);
    assert_ne!(darker, by_name);
    // In a scene.
    let scene = cube(folder.path());
    let mut render = isophote();
    render.current_dir(folder.path()).arg("render").arg(&scene).args(["e.png", "--size", "64x48"]);
    succeeds(render.args(["--style", "look:linocut"]));
}

#[test]
fn looks_are_listed_shown_and_checked() {
    let say = |arguments: &[&str]| succeeds(isophote().arg("preset").args(arguments)).0;
    let list = say(&["list"]);
    let looks = looks();
    for look in &looks {
        let name = look.preset.title.name.as_deref().expect("it has a name");
        let line = list.lines().find(|line| line.trim_start().starts_with(&format!("{} ", look.style())));
        assert!(line.is_some_and(|line| line.contains(name)), "{list}");
    }
    let tagged = say(&["list", "--tag", "monochrome"]);
    assert!(tagged.contains("look:noir_panel") && !tagged.contains("look:saturday_comic"), "{tagged}");
    let json: serde_json::Value = serde_json::from_str(&say(&["list", "--json"])).expect("it is JSON");
    assert_eq!(json.as_array().map(Vec::len), Some(looks.len()));
    assert_eq!(json[0]["look"], looks[0].style());

    let shown = say(&["show", "look:copperplate"]);
    assert!(shown.starts_with("Copperplate\n") && shown.contains("\nink\n  "), "{shown}");
    let styles: Vec<String> = looks.iter().map(ShippedPreset::style).collect();
    let checked = succeeds(isophote().args(["preset", "check"]).args(styles)).0;
    assert_eq!(checked.lines().count(), looks.len(), "{checked}");
    let files = fs::read_dir(support::root().join("nodes/library/looks")).expect("the folder is there");
    let files = files.map(|entry| entry.expect("an entry").path());
    let files = files.filter(|path| path.extension().is_some_and(|extension| extension == "json"));
    succeeds(isophote().args(["preset", "check"]).args(files));
}

#[test]
fn what_is_no_look_is_refused() {
    let folder = folder();
    picture(24, 16).save(folder.path().join("in.png")).expect("the picture can be written");
    let refused = |style: &str, words: &[&str]| {
        let mut command = isophote();
        command.current_dir(folder.path()).args(["apply", style, "in.png", "out.png"]);
        fails(&mut command, 2, words);
    };
    refused("look:coperplate", &["look:coperplate", "did you mean 'look:copperplate'"]);
    refused("copperplate", &["did you mean 'look:copperplate'"]);
    refused("look:", &["is no look", "preset list"]);
    // A preset is made of a style, and a look is a preset.
    fs::write(folder.path().join("on.json"), r#"{"style": "look:linocut"}"#).expect("a file can be written");
    refused("on.json", &["on.json", "look:linocut", "is no graph"]);
    // A file of that name is reached by its path.
    fs::write(folder.path().join("look:mine"), r#"{"style": "ink"}"#).expect("a file can be written");
    let mut command = isophote();
    succeeds(command.current_dir(folder.path()).args(["apply", "./look:mine", "in.png", "out.png"]));
    let mut list = isophote();
    fails(list.args(["preset", "list", "--tag", "nonesuch"]), 2, &["nonesuch", "choose from", "monochrome"]);
}

#[test]
fn jobs_for_farms_name_looks_as_they_are() {
    let folder = folder();
    for frame in 1..=2 {
        picture(24, 16).save(folder.path().join(format!("in.{frame:04}.png"))).expect("as above");
    }
    for style in [&["look:linocut"][..], &["--preset", "look:linocut"], &["--preset=look:linocut"]] {
        let mut command = isophote();
        command.current_dir(folder.path()).args(["farm", "openjd", "--", "apply"]).args(style);
        let job = succeeds(command.args(["in.####.png", "out.####.png"])).0;
        assert!(job.contains("look:linocut\"") && !job.contains("/look:"), "{job}");
    }
}
