//! Packages of others that binaries are made of, as cargo resolved them.

use crate::error::{Error, Result};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A package of others.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Package {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// The SPDX expression of its manifest; empty where there is none.
    pub licence: String,
    /// People named in the manifest.
    pub authors: Vec<String>,
    /// Folder of its sources.
    pub folder: PathBuf,
    /// The file that its manifest names as its licence.
    pub licence_file: Option<PathBuf>,
    /// Address that the registry gives it, as `purl` of ECMA-427 writes it; its identity in lists.
    pub purl: String,
    /// Those of the packages that are linked into it, in their order.
    pub needs: Vec<String>,
}

impl Package {
    /// Name and version.
    pub fn named(&self) -> String {
        format!("{} {}", self.name, self.version).trim_end().to_owned()
    }

    /// The error that its licence is not allowed.
    pub fn refused(&self) -> Error {
        Error::Licence { package: self.named(), licence: self.licence.clone() }
    }
}

/// Packages of others that some of the workspace's packages are compiled of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Linked {
    /// All of them, by name and version.
    pub packages: Vec<Package>,
    /// The `purl` of those that the workspace itself names.
    pub direct: Vec<String>,
}

/// All packages that some of the workspace's packages are compiled of: with the rest of the workspace for the machine that runs
/// this, or alone for another, which is named.
///
/// # Errors
/// [`Error::Program`] when cargo fails, [`Error::Malformed`] when it prints something else.
pub fn dependencies(root: &Path, of: &[&str], alone: Option<&str>) -> Result<Linked> {
    let cargo = PathBuf::from(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    let triple = alone.map_or_else(|| host_triple(&cargo, root), |triple| Ok(triple.to_owned()))?;
    let arguments = ["metadata", "--format-version", "1", "--locked", "--filter-platform", &triple];
    let printed = output(Command::new(&cargo).args(arguments).current_dir(root))?;
    let value: Value = serde_json::from_str(&printed).map_err(|error| Error::malformed(&cargo, error))?;
    let all = linked(&value, of);
    let mut all = all.ok_or_else(|| Error::malformed(&cargo, "its metadata are not of version 1"))?;
    if alone.is_some() {
        // Metadata have every feature that some package of the workspace asks for.
        let mut tree = Command::new(&cargo);
        tree.args(["tree", "--locked", "--target", &triple, "--edges", "normal", "--prefix", "none"]);
        tree.args(of.iter().flat_map(|package| ["--package", package])).current_dir(root);
        all.retain(&output(&mut tree)?);
    }
    Ok(all)
}

impl Linked {
    /// Drops packages that a tree of cargo's does not name.
    fn retain(&mut self, tree: &str) {
        let named: BTreeSet<String> = tree
            .lines()
            .filter_map(|line| {
                let mut words = line.split_whitespace();
                Some(purl_of(words.next()?, words.next()?.strip_prefix('v')?))
            })
            .collect();
        self.packages.retain(|package| named.contains(&package.purl));
        self.direct.retain(|purl| named.contains(purl));
        self.packages.iter_mut().for_each(|package| package.needs.retain(|purl| named.contains(purl)));
    }
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
fn linked(metadata: &Value, of: &[&str]) -> Option<Linked> {
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
    let (mut seen, mut direct) = (BTreeSet::new(), BTreeSet::new());
    let mut packages = Vec::new();
    while let Some(id) = open.pop() {
        if !seen.insert(id) {
            continue;
        }
        let is_linked = |dep: &&Value| {
            dep["dep_kinds"].as_array().is_some_and(|kinds| kinds.iter().any(|kind| kind["kind"].is_null()))
        };
        let needs = edges.get(id)?.iter().filter(is_linked).filter_map(|dep| dep["pkg"].as_str());
        let needs: Vec<&str> = needs.collect();
        let others = needs.iter().filter_map(|id| by_id.get(id)).filter(|other| !other["source"].is_null());
        let others = others.map(|other| purl(other)).collect::<Option<BTreeSet<String>>>()?;
        open.extend(needs);
        let value = by_id.get(id)?;
        if value["source"].is_null() {
            direct.extend(others);
        } else {
            packages.push(package(value, others)?);
        }
    }
    packages.sort();
    Some(Linked { packages, direct: direct.into_iter().collect() })
}

fn package(value: &Value, needs: BTreeSet<String>) -> Option<Package> {
    let folder = Path::new(value["manifest_path"].as_str()?).parent()?.to_owned();
    let authors = value["authors"].as_array()?.iter().filter_map(Value::as_str);
    Some(Package {
        name: value["name"].as_str()?.to_owned(),
        version: value["version"].as_str()?.to_owned(),
        licence: value["license"].as_str().unwrap_or_default().to_owned(),
        authors: authors.map(str::to_owned).collect(),
        licence_file: value["license_file"].as_str().map(|file| folder.join(file)),
        folder,
        purl: purl(value)?,
        needs: needs.into_iter().collect(),
    })
}

fn purl(value: &Value) -> Option<String> {
    Some(purl_of(value["name"].as_str()?, value["version"].as_str()?))
}

fn purl_of(name: &str, version: &str) -> String {
    // A plus sign stands for a blank in addresses.
    format!("pkg:cargo/{name}@{}", version.replace('+', "%2B"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_is_linked_is_followed_and_nothing_else() {
        let package = |name: &str, source: Value| {
            let version = if name == "b" { "1.0.0+2" } else { "1.0.0" };
            json!({
                "id": name, "name": name, "version": version, "source": source, "license": "MIT",
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
        let found = linked(&metadata, &["own"]).unwrap();
        let [a, b] = ["pkg:cargo/a@1.0.0", "pkg:cargo/b@1.0.0%2B2"];
        let names: Vec<(&str, &str)> = found.packages.iter().map(|p| (&*p.name, &*p.purl)).collect();
        assert_eq!(names, [("a", a), ("b", b)]);
        assert_eq!(found.direct, [a]);
        assert_eq!([&found.packages[0].needs, &found.packages[1].needs], [&[b], &[a]]);
        assert_eq!(linked(&metadata, &["absent"]), None);
        let mut fewer = found.clone();
        fewer.retain("own v1.0.0 (/src/own)\na v1.0.0\nb v2.0.0 (*)\n");
        assert_eq!(fewer.packages, [Package { needs: Vec::new(), ..found.packages[0].clone() }]);
        assert_eq!(fewer.direct, [a]);
    }
}
