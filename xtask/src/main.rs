//! The project's chores, `cargo xtask <chore>`: one module for each.

mod address;
mod bench;
mod bundle;
mod card;
mod cases;
mod crates;
mod demo;
mod dist;
mod docs;
mod error;
mod experiments;
#[cfg(test)]
mod formats;
mod gallery;
mod gpu_cost;
mod guides;
mod header;
mod looks;
mod packing;
mod python;
mod readme;
mod samples;
mod scene;
mod setup;
mod test;
mod tools;
mod web;

use clap::{Parser, Subcommand};
use std::process::ExitCode;
use tools::HandedOn;

/// The project's chores.
#[derive(Parser)]
#[command(name = "xtask", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Renders the demo scene in four styles, with turntables and a contact sheet
    Demo(demo::Options),
    /// Sets up what the tests need and runs every check
    Test(test::Options),
    /// Makes the golden images anew; look at them before committing
    Bless,
    /// Runs the thesis' experiments and writes their tables
    Experiments(experiments::Options),
    /// Every node on pictures, as a page to look at
    Gallery(HandedOn),
    /// Makes the documentation as a site, and runs every command on it
    Docs(HandedOn),
    /// Every look that ships with the host, as one sheet
    Looks(looks::Options),
    /// The pictures that come with the host, to try looks on
    Samples(samples::Options),
    /// Counts what the shaders cost on a graphics card, without one
    GpuCost(gpu_cost::Options),
    /// Runs the host's benchmark, built for speed
    Bench(bench::Options),
    /// Makes a folder that measures graphics cards on machines without Rust
    Card(dist::Options),
    /// Makes the OpenFX bundle, and installs it
    Bundle(bundle::Options),
    /// Packs all that users install: the library, the plugin, the program, the wheel, the Blender extension, the nodes of ComfyUI
    Dist(dist::Options),
    /// Writes the list of guides where it must stand as text
    Guides(guides::Options),
    /// Writes include/isophote.h from the Rust declarations
    Header(header::Options),
    /// Makes the wheel for Python
    Wheel(python::WheelOptions),
    /// Makes the extension for Blender, with the wheel inside
    Blender(python::WheelOptions),
    /// Packs the nodes of ComfyUI, which ask for the wheel
    Comfyui(python::WheelOptions),
    /// Writes what editors know of the Python package's nodes from their declarations
    Stubs(python::StubsOptions),
    /// Writes CONTRIBUTING's table of crates from their manifests and sources
    Crates(crates::Options),
    /// Writes the README's addresses and its list of nodes
    Readme(readme::Options),
    /// Makes the page and the npm package that stylize in browsers
    Web(web::Options),
    /// Writes the demo scene (glTF) and the house (OBJ)
    Scene(scene::Options),
}

fn main() -> ExitCode {
    if let Some(code) = test::stand_in() {
        return code;
    }
    // Clap itself ends wrong usage with code 2.
    let outcome = match Cli::parse().chore {
        Chore::Demo(options) => demo::run(&options),
        Chore::Test(options) => test::run(&options),
        Chore::Bless => test::bless(),
        Chore::Experiments(options) => experiments::run(&options),
        Chore::Gallery(options) => gallery::run(&options),
        Chore::Looks(options) => looks::run(&options),
        Chore::Samples(options) => samples::run(&options),
        Chore::GpuCost(options) => gpu_cost::run(&options),
        Chore::Card(options) => card::run(&options),
        Chore::Bundle(options) => bundle::run(&options),
        Chore::Docs(options) => docs::run(&options),
        Chore::Dist(options) => dist::run(&options),
        Chore::Bench(options) => bench::run(&options),
        Chore::Wheel(options) => python::wheel(&options),
        Chore::Blender(options) => python::blender(&options),
        Chore::Comfyui(options) => python::comfyui(&options),
        Chore::Stubs(options) => python::stubs(&options),
        Chore::Crates(options) => crates::run(&options),
        Chore::Readme(options) => readme::run(&options),
        Chore::Guides(options) => guides::run(&options),
        Chore::Header(options) => header::run(&options),
        Chore::Web(options) => web::run(&options),
        Chore::Scene(options) => scene::run(&options),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("xtask: {failure}");
            ExitCode::FAILURE
        }
    }
}
