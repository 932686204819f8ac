//! The looks that ship, as a list of their ids and texts in their order.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    let folder = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("../../nodes/library/looks");
    println!("cargo::rerun-if-changed={}", folder.display());
    let order = fs::read_to_string(folder.join("order.rs"))?;
    let ids =
        order.split_once('{').and_then(|(_, rest)| rest.split_once('}')).ok_or("order.rs has no list")?.0;
    let mut list = String::from("[\n");
    for id in ids.split_whitespace() {
        writeln!(list, "    ({id:?}, include_str!({:?})),", folder.join(format!("{id}.json")))?;
    }
    list.push(']');
    fs::write(Path::new(&env::var("OUT_DIR")?).join("looks.rs"), list)?;
    Ok(())
}
