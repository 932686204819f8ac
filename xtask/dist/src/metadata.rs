//! Packages of others that a binary is made of, as cargo resolved them.

use crate::error::{Error, Result};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A package of others.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Package {
    /// Its name and version.
    pub name: String,
    /// The SPDX expression of its manifest; empty where there is none.
    pub licence: String,
    /// People named in the manifest.
    pub authors: Vec<String>,
    /// Folder of its sources.
    pub folder: PathBuf,
    /// The file that its manifest names as its licence.
    pub licence_file: Option<PathBuf>,
}

/// All packages that some of the workspace's packages are compiled of, for the machine that runs this.
///
/// # Errors
/// [`Error::Program`] when cargo fails, [`Error::Malformed`] when it prints something else.
pub fn dependencies(root: &Path, of: &[&str]) -> Result<Vec<Package>> {
    let cargo = PathBuf::from(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    let triple = host_triple(&cargo, root)?;
    let arguments = ["metadata", "--format-version", "1", "--locked", "--filter-platform", &triple];
    let printed = output(Command::new(&cargo).args(arguments).current_dir(root))?;
    let value: Value = serde_json::from_str(&printed).map_err(|error| Error::malformed(&cargo, error))?;
    packages(&value, of).ok_or_else(|| Error::malformed(&cargo, "its metadata are not of version 1"))
}

fn output(command: &mut Command) -> Result<String> {
    let program = PathBuf::from(command.get_program());
    let output = command.output().map_err(Error::at(&program))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        return Err(Error::Program { command: format!("{command:?}"), said });
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn host_triple(cargo: &Path, root: &Path) -> Result<String> {
    let printed = output(Command::new(cargo).args(["version", "--verbose"]).current_dir(root))?;
    let line = printed.lines().find_map(|line| line.strip_prefix("host: "));
    line.map(str::to_owned).ok_or_else(|| Error::malformed(cargo, "does not say what machine it is for"))
}

/// Follows what is linked in, from the packages `of`; what only builds or tests need stays out.
fn packages(metadata: &Value, of: &[&str]) -> Option<Vec<Package>> {
    let all = metadata["packages"].as_array()?;
    let by_id: BTreeMap<&str, &Value> = all.iter().filter_map(|p| Some((p["id"].as_str()?, p))).collect();
    let nodes = metadata["resolve"]["nodes"].as_array()?;
    let edges: BTreeMap<&str, &Vec<Value>> =
        nodes.iter().filter_map(|n| Some((n["id"].as_str()?, n["deps"].as_array()?))).collect();
    let mut open: Vec<&str> = all
        .iter()
        .filter(|p| p["source"].is_null() && p["name"].as_str().is_some_and(|name| of.contains(&name)))
        .filter_map(|p| p["id"].as_str())
        .collect();
    if open.len() != of.len() {
        return None;
    }
    let mut seen = BTreeSet::new();
    while let Some(id) = open.pop() {
        if !seen.insert(id) {
            continue;
        }
        let is_linked = |dep: &&Value| {
            dep["dep_kinds"].as_array().is_some_and(|kinds| kinds.iter().any(|kind| kind["kind"].is_null()))
        };
        open.extend(edges.get(id)?.iter().filter(is_linked).filter_map(|dep| dep["pkg"].as_str()));
    }
    let others = seen.iter().filter_map(|id| by_id.get(id)).filter(|package| !package["source"].is_null());
    let mut found = others.map(|value| package(value)).collect::<Option<Vec<Package>>>()?;
    found.sort();
    Some(found)
}

fn package(value: &Value) -> Option<Package> {
    let folder = Path::new(value["manifest_path"].as_str()?).parent()?.to_owned();
    let authors = value["authors"].as_array()?.iter().filter_map(Value::as_str);
    Some(Package {
        name: format!("{} {}", value["name"].as_str()?, value["version"].as_str()?),
        licence: value["license"].as_str().unwrap_or_default().to_owned(),
        authors: authors.map(str::to_owned).collect(),
        licence_file: value["license_file"].as_str().map(|file| folder.join(file)),
        folder,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_is_linked_is_followed_and_nothing_else() {
        let package = |name: &str, source: Value| {
            json!({
                "id": name, "name": name, "version": "1.0.0", "source": source, "license": "MIT",
                "license_file": null, "authors": [], "manifest_path": format!("/src/{name}/Cargo.toml"),
            })
        };
        let dep = |name: &str, kind: Value| json!({ "pkg": name, "dep_kinds": [{ "kind": kind }] });
        let metadata = json!({
            "packages": [
                package("own", Value::Null), package("a", json!("registry")), package("b", json!("registry")),
                package("tester", json!("registry")), package("builder", json!("registry")),
            ],
            "resolve": { "nodes": [
                { "id": "own", "deps": [
                    dep("a", Value::Null), dep("tester", json!("dev")), dep("builder", json!("build"))
                ] },
                { "id": "a", "deps": [dep("b", Value::Null)] },
                { "id": "b", "deps": [dep("a", Value::Null)] },
                { "id": "tester", "deps": [] }, { "id": "builder", "deps": [] },
            ] },
        });
        let found = packages(&metadata, &["own"]).unwrap();
        let names: Vec<&str> = found.iter().map(|p| p.name.as_str()).collect();
        assert_eq!(names, ["a 1.0.0", "b 1.0.0"]);
        assert_eq!(packages(&metadata, &["absent"]), None);
    }
}
