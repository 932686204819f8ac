//! `cargo xtask gallery`: every node that makes pictures, and every style, on the demo scene, on a model
//! and on a photograph, as an HTML page with the parameters under each picture.
//!
//! The nodes and their parameters come from the catalogue of the library that the host loads; nothing is
//! listed here.

use crate::error::{Context, Failure, Result};
use crate::setup::{self, VULKAN};
use crate::tools::{cargo, heading, host, root, run as run_command};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Options of `cargo xtask gallery`.
#[derive(clap::Args)]
pub struct Options {
    /// Where the page and its pictures go
    #[arg(long, default_value = "target/gallery")]
    out: PathBuf,
    /// Only these nodes; may be repeated
    #[arg(long, value_name = "ID")]
    node: Vec<String>,
    /// Pictures to show the nodes on, beside the demo scene; without it a model and a photograph of the
    /// test assets, when they are there
    #[arg(long, value_name = "FILE")]
    picture: Vec<PathBuf>,
    /// Size of rendered pictures
    #[arg(long, value_name = "WxH", default_value = "960x540")]
    size: String,
}

/// A picture that the nodes are shown on.
struct Subject {
    name: String,
    file: PathBuf,
    /// What the picture was rendered from, if it was: its normals, depth and object ids are known then.
    scene: Option<PathBuf>,
}

/// One result: a node with some parameters set.
struct Shot {
    title: String,
    set: Vec<(String, String)>,
}

/// Renders, filters and writes the page.
///
/// # Errors
/// The first step that fails.
pub fn run(options: &Options) -> Result<()> {
    setup::ensure(&[&VULKAN])?;
    heading("build");
    cargo(&["build", "--workspace", "--lib", "--bins"])?;
    let out = root().join(&options.out);
    std::fs::create_dir_all(&out).context(|| format!("cannot create {}", out.display()))?;
    let subjects = subjects(options, &out)?;
    let nodes = catalogue()?;

    let mut page = opening(&subjects);
    for node in &nodes {
        let id = text(node, "id");
        let wanted = options.node.is_empty() || options.node.iter().any(|n| n == id);
        if !wanted || !makes_pictures(node) {
            continue;
        }
        heading(id);
        let style = style_of(node, &nodes, &out)?;
        let _ = writeln!(page, "<h2 id=\"{id}\">{} <code>{id}</code></h2>", escaped(text(node, "label")));
        let _ = writeln!(page, "<p>{} § {}</p>", escaped(text(node, "doc")), escaped(text(node, "section")));
        for (index, shot) in shots(node).iter().enumerate() {
            // Options are compared on one picture; the defaults are shown on all.
            let shown = if index == 0 { &subjects[..] } else { &subjects[..1] };
            let _ = writeln!(page, "<h3>{}</h3><div class=\"row\">", escaped(&shot.title));
            for subject in shown {
                let name = format!("{id}-{index}-{}.png", subject.name);
                let mut command = match &subject.scene {
                    Some(scene) if takes_guides(node) => {
                        let mut command = render(scene, &out.join(&name), &options.size);
                        command.args(["--style", &style]);
                        command
                    }
                    _ => apply(&style, &subject.file, &out.join(&name)),
                };
                for (param, value) in &shot.set {
                    // In a graph a parameter is named with its node.
                    let param = if style == id { param.clone() } else { format!("{id}.{param}") };
                    command.arg("--set").arg(format!("{param}={value}"));
                }
                run_command(&mut command)?;
                let _ = writeln!(
                    page,
                    "<figure><a href=\"{name}\"><img src=\"{name}\" loading=\"lazy\"></a><figcaption>{}</figcaption></figure>",
                    escaped(&subject.name)
                );
            }
            let _ = writeln!(page, "</div><p class=\"values\">{}</p>", values(node, shot));
        }
    }
    page.push_str("</body></html>\n");
    let index = out.join("index.html");
    std::fs::write(&index, page).context(|| format!("cannot write {}", index.display()))?;
    println!("\nthe gallery is {}", index.display());
    Ok(())
}

/// The demo scene, and the pictures that were named or found.
fn subjects(options: &Options, out: &Path) -> Result<Vec<Subject>> {
    let scene = out.join("scene");
    crate::scene::run(&crate::scene::Options { out: scene.clone() })?;
    let rendered = |name: &str, scene: PathBuf| -> Result<Subject> {
        let file = out.join(format!("{name}.png"));
        run_command(&mut render(&scene, &file, &options.size))?;
        Ok(Subject { name: name.into(), file, scene: Some(scene) })
    };
    let mut subjects = vec![rendered("scene", scene.join("city.gltf"))?];
    if !options.picture.is_empty() {
        for file in &options.picture {
            let name = file.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
            subjects.push(Subject { name, file: file.clone(), scene: None });
        }
        return Ok(subjects);
    }
    let assets = root().join("../shared/assets");
    let helmet = assets.join("gltf/FlightHelmet/FlightHelmet.gltf");
    if helmet.exists() {
        subjects.push(rendered("helmet", helmet)?);
    }
    let photo = assets.join("photo/astronaut.png");
    if photo.exists() {
        subjects.push(Subject { name: "photo".into(), file: photo, scene: None });
    }
    Ok(subjects)
}

fn render(scene: &Path, out: &Path, size: &str) -> Command {
    let mut command = host("debug");
    command.arg("render").arg(scene).arg(out).args(["--size", size]);
    command
}

fn catalogue() -> Result<Vec<Value>> {
    let output = host("debug").args(["nodes", "--json"]).output().context(|| "cannot run the host".into())?;
    if !output.status.success() {
        return Err(Failure(String::from_utf8_lossy(&output.stderr).into_owned()));
    }
    let all: Value =
        serde_json::from_slice(&output.stdout).context(|| "the host's catalogue is not JSON".into())?;
    Ok(all["nodes"].as_array().cloned().unwrap_or_default())
}

fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_default()
}

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().map_or(&[], Vec::as_slice)
}

fn makes_pictures(node: &Value) -> bool {
    matches!(text(&node["output"], "kind"), "color" | "scalar")
}

/// What `apply` is told: the node's id or, when it needs more than a picture, a graph file that puts the
/// first node which makes such an image from colour before it.
fn style_of(node: &Value, nodes: &[Value], out: &Path) -> Result<String> {
    let id = text(node, "id");
    let missing: Vec<&Value> = list(node, "inputs")
        .iter()
        .filter(|p| p["optional"] == json!(false) && text(p, "kind") != "color")
        .collect();
    if missing.is_empty() {
        return Ok(id.to_owned());
    }
    let mut inputs = json!({});
    for port in list(node, "inputs").iter().filter(|p| text(p, "kind") == "color") {
        inputs[text(port, "id")] = json!("@color");
    }
    let mut graph_nodes = Vec::new();
    for port in missing {
        let able = nodes.iter().find(|n| {
            text(&n["output"], "kind") == text(port, "kind")
                && list(n, "inputs").iter().all(|p| p["optional"] == json!(true) || text(p, "id") == "color")
        });
        let able = able.ok_or_else(|| Failure(format!("nothing makes a {} for {id}", text(port, "kind"))))?;
        let name = format!("before-{}", text(port, "id"));
        inputs[text(port, "id")] = json!(name);
        graph_nodes.push(json!({ "name": name, "node": text(able, "id"), "inputs": { "color": "@color" } }));
    }
    graph_nodes.push(json!({ "name": id, "node": id, "inputs": inputs }));
    let graph = json!({ "format": "isophote-graph", "version": 1, "nodes": graph_nodes, "output": id });
    let path = out.join(format!("{id}.json"));
    std::fs::write(&path, format!("{graph:#}\n")).context(|| format!("cannot write {}", path.display()))?;
    Ok(path.display().to_string())
}

/// The defaults, then each other option of each choice.
fn shots(node: &Value) -> Vec<Shot> {
    let mut shots = vec![Shot { title: "defaults".into(), set: Vec::new() }];
    for param in list(node, "params") {
        for option in list(param, "options") {
            let (id, option) = (text(param, "id"), text(option, "id"));
            if option != text(param, "default") {
                let set = vec![(id.to_owned(), option.to_owned())];
                shots.push(Shot { title: format!("{id} = {option}"), set });
            }
        }
    }
    shots
}

fn takes_guides(node: &Value) -> bool {
    list(node, "inputs").iter().any(|p| text(p, "kind") == "normal")
}

fn apply(style: &str, input: &Path, output: &Path) -> Command {
    let mut command = host("debug");
    command.arg("apply").arg(style).arg(input).arg(output).args(["--backend", "cpu"]);
    command
}

/// All parameters with the values of this picture, those that differ from the defaults marked.
fn values(node: &Value, shot: &Shot) -> String {
    let all = list(node, "params").iter().map(|param| {
        let id = text(param, "id");
        match shot.set.iter().find(|(set, _)| set == id) {
            Some((_, value)) => format!("<b>{id} {}</b>", escaped(value)),
            None => format!("{id} {}", escaped(&plain(&param["default"]))),
        }
    });
    all.collect::<Vec<_>>().join(" · ")
}

fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        // As the parameter's own precision shows it.
        Value::Number(number) => {
            number.as_f64().map_or_else(|| number.to_string(), |v| (v as f32).to_string())
        }
        other => other.to_string(),
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn opening(subjects: &[Subject]) -> String {
    let names: Vec<String> = subjects.iter().map(|s| escaped(&s.name)).collect();
    format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Isophote gallery</title><style>\n\
         body {{ font: 15px/1.45 sans-serif; margin: 2em; background: #1d1e20; color: #ddd; }}\n\
         .row {{ display: flex; flex-wrap: wrap; gap: 1em; }} figure {{ margin: 0; }}\n\
         img {{ max-width: 45vw; max-height: 60vh; display: block; }} a {{ color: #9cf; }}\n\
         .values {{ color: #999; font-size: 13px; max-width: 100ch; }} .values b {{ color: #fd8; }}\n\
         </style></head><body><h1>Isophote gallery</h1><p>Every node on: {}.</p>\n",
        names.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node() -> Value {
        json!({
            "id": "n", "output": { "kind": "color" },
            "inputs": [{ "id": "color", "kind": "color", "optional": false }],
            "params": [
                { "id": "kind", "default": "a", "options": [{ "id": "a" }, { "id": "b" }] },
                { "id": "sigma", "default": 0.1_f32 },
            ],
        })
    }

    #[test]
    fn each_other_option_is_shown_and_marked() {
        let shots = shots(&node());
        assert_eq!(shots.len(), 2);
        assert_eq!(values(&node(), &shots[0]), "kind a · sigma 0.1");
        assert_eq!(values(&node(), &shots[1]), "<b>kind b</b> · sigma 0.1");
    }

    #[test]
    fn a_node_that_needs_more_than_a_picture_gets_a_graph() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(style_of(&node(), &[], folder.path()).unwrap(), "n");
        let mut needy = node();
        needy["inputs"]
            .as_array_mut()
            .unwrap()
            .push(json!({ "id": "t", "kind": "tensor", "optional": false }));
        assert!(style_of(&needy, &[node()], folder.path()).is_err());
        let mut maker = node();
        maker["id"] = json!("m");
        maker["output"]["kind"] = json!("tensor");
        let file = style_of(&needy, &[maker], folder.path()).unwrap();
        let graph: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
        assert_eq!(graph["nodes"][0]["node"], "m");
        assert_eq!(graph["nodes"][1]["inputs"]["t"], "before-t");
    }
}
