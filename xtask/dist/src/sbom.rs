//! The bill of materials: what binaries are made of, for programs that look for known faults in it, as CycloneDX 1.6 in JSON
//! (ECMA-424). Those who pack the same build write the same bytes: there is neither a time nor a number of its own in it.

use crate::error::Result;
use crate::metadata::{Linked, Package};
use serde_json::{Value, json};
use spdx::Expression;

/// Its file. Programs know it by the ending.
pub const FILE: &str = "isophote.cdx.json";

/// Isophote in it.
const OWN: &str = "isophote";

/// The bill of a version of Isophote as a text.
///
/// # Errors
/// [`Error::Licence`](crate::error::Error::Licence) for a licence that is no expression of SPDX's.
pub fn text(version: &str, linked: &Linked) -> Result<String> {
    let components = linked.packages.iter().map(component).collect::<Result<Vec<Value>>>()?;
    let needs = |of: &str, on: &[String]| json!({ "ref": of, "dependsOn": on });
    let mut edges = vec![needs(OWN, &linked.direct)];
    edges.extend(linked.packages.iter().map(|package| needs(&package.purl, &package.needs)));
    let bill = json!({
        "$schema": "http://cyclonedx.org/schema/bom-1.6.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": { "component": {
            "type": "library",
            "bom-ref": OWN,
            "name": OWN,
            "version": version,
            "description": "Structure-adaptive stylization filters",
            "licenses": [{ "expression": env!("CARGO_PKG_LICENSE") }],
        } },
        "components": components,
        "dependencies": edges,
    });
    Ok(format!("{bill:#}\n"))
}

fn component(package: &Package) -> Result<Value> {
    // Older manifests divide licences by a slash.
    let licence = Expression::canonicalize(&package.licence).map_err(|_| package.refused())?;
    Ok(json!({
        "type": "library",
        "bom-ref": package.purl,
        "name": package.name,
        "version": package.version,
        "licenses": [{ "expression": licence.as_ref().unwrap_or(&package.licence) }],
        "purl": package.purl,
    }))
}
