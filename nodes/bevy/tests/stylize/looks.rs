//! Looks as assets: those that ship, files, and files that are none.

use crate::stage::{SIZE, Stage};
use bevy::asset::LoadState;
use bevy::prelude::*;
use isophote_bevy::{Look, Stylize};
use std::fs;
use std::path::PathBuf;

/// A folder for assets that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("isophote-bevy-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).expect("a folder can be made");
        Self(path)
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.0.join(name), text).expect("a file can be written");
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A stage with a ball and the state of a look's file after some frames.
fn loaded(folder: &Folder, name: &str) -> (Stage, Handle<Look>, Entity, Handle<Image>) {
    let mut stage = Stage::new(&folder.0);
    let material = StandardMaterial { base_color: Color::srgb(0.8, 0.3, 0.2), ..default() };
    stage.put(Sphere::new(1.0).mesh().uv(64, 32), material, Transform::default());
    let target = stage.target(SIZE);
    let camera = stage.camera(&target);
    let look: Handle<Look> = stage.app.world().resource::<AssetServer>().load(name.to_owned());
    for _ in 0..400 {
        stage.run(1);
        let state = stage.app.world().resource::<AssetServer>().load_state(&look);
        if matches!(state, LoadState::Loaded | LoadState::Failed(_)) {
            break;
        }
    }
    (stage, look, camera, target)
}

#[test]
fn presets_and_their_graph_files_are_loaded() {
    let folder = Folder::new("presets");
    folder.write("plain.look.json", r##"{"style": "cartoon", "parameters": {"line_color": "#ff0000"}}"##);
    folder.write(
        "graph.json",
        &isophote_bevy::isophote::Graph::single("kuwahara").expect("a node").to_json().expect("a graph"),
    );
    folder.write("graph.look.json", r#"{"style": "graph.json", "parameters": {"radius": 6}}"#);
    for name in ["plain.look.json", "graph.look.json"] {
        let (mut stage, look, camera, target) = loaded(&folder, name);
        let state = stage.app.world().resource::<AssetServer>().load_state(&look);
        assert!(matches!(state, LoadState::Loaded), "{name}: {state:?}");
        let plain = stage.picture(&target);
        stage.app.world_mut().entity_mut(camera).insert(Stylize::new(look));
        assert!(stage.picture(&target).differs(&plain, 4) > 0.005, "{name} changed nothing");
    }
}

#[test]
fn what_is_no_look_leaves_the_picture_and_says_why() {
    let folder = Folder::new("faults");
    folder.write("style.look.json", r#"{"style": "cartoom"}"#);
    folder.write("text.look.json", "{");
    folder.write("graph.look.json", r#"{"style": "missing.json"}"#);
    for (name, word) in
        [("style.look.json", "cartoon"), ("text.look.json", "text"), ("graph.look.json", "missing")]
    {
        let (mut stage, look, camera, target) = loaded(&folder, name);
        let LoadState::Failed(error) = stage.app.world().resource::<AssetServer>().load_state(&look) else {
            panic!("{name} was loaded");
        };
        assert!(error.to_string().contains(word), "{error}");
        let plain = stage.picture(&target);
        stage.app.world_mut().entity_mut(camera).insert(Stylize::new(look));
        let drawn = stage.picture(&target);
        assert!(drawn.differs(&plain, 2) < 0.005, "{name}: {}", drawn.differs(&plain, 2));
    }
}

#[test]
fn every_look_that_ships_is_drawn() {
    let mut stage = Stage::new(std::path::Path::new("."));
    let material = StandardMaterial { base_color: Color::srgb(0.8, 0.3, 0.2), ..default() };
    stage.put(Sphere::new(1.0).mesh().uv(64, 32), material, Transform::default());
    let target = stage.target([96, 64]);
    let camera = stage.camera(&target);
    let plain = stage.picture(&target);
    let mut names: Vec<String> = Look::shipped().collect();
    assert!(names.len() > 20);
    // One of each style, in turns.
    names.truncate(8);
    for name in names {
        stage.stylize(camera, Look::named(&name).expect("a look"));
        let drawn = stage.picture(&target);
        assert!(drawn.differs(&plain, 8) > 0.02, "{name} changed nothing");
    }
}

#[test]
fn a_look_has_parameters_by_their_names() {
    let mut look = Look::named("cartoon").expect("a style");
    assert!(look.set("line_color", "#ff0000").is_ok());
    let error = look.set("line_colour", "#ff0000").expect_err("there is no such parameter").to_string();
    assert!(error.contains("line_color"), "{error}");
    let error = Look::named("look:travel_postr").expect_err("there is no such look").to_string();
    assert!(error.contains("travel_poster"), "{error}");
}
