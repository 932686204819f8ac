//! `isophote-gpu-cost [--check | KERNEL]`, run by `cargo xtask gpu-cost`: compiles every kernel for a graphics card
//! that need not be there, and writes what each costs into `COSTS.md` beside this program.
//!
//! `--check` compares instead, and fails when a kernel costs more than the table says. With the name of a kernel, its
//! machine code is printed and nothing is written.

mod driver;
mod error;
mod machine_code;
mod shader;
mod table;

use driver::Driver;
use error::{Error, Result};
use isophote::engine::program::Shader;
use std::fs;
use std::path::Path;
use std::process::ExitCode;
use table::{Cost, Costs};

/// Task to carry out.
enum Task {
    Write,
    Check,
    Show(String),
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let task = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => Task::Write,
        ["--check"] => Task::Check,
        [kernel] if !kernel.starts_with('-') => Task::Show(kernel.to_owned()),
        _ => {
            eprintln!("usage: isophote-gpu-cost [--check | KERNEL]");
            return ExitCode::from(2);
        }
    };
    match run(&task) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("isophote-gpu-cost: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(task: &Task) -> Result<()> {
    let shaders = shader::shaders();
    let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("COSTS.md");
    match task {
        Task::Show(name) => show(&Driver::open()?, &shaders, name),
        Task::Write => write(&Driver::open()?, &shaders, &table),
        Task::Check => match Driver::open() {
            Ok(driver) => check(&driver, &shaders, &table),
            // Machines with other drivers, or none, have other checks to pass.
            Err(error) => {
                println!("costs of shaders are not compared: {error}");
                Ok(())
            }
        },
    }
}

/// Prints the machine code of a kernel.
fn show(driver: &Driver, shaders: &[Shader], name: &str) -> Result<()> {
    let shader = shaders.iter().find(|shader| shader.name == name);
    let shader = shader.ok_or_else(|| Error::Unknown(name.to_owned()))?;
    println!("{}", driver.compile(&shader::translate(shader)?)?.assembly);
    Ok(())
}

fn write(driver: &Driver, shaders: &[Shader], path: &Path) -> Result<()> {
    let old = read(path)?;
    let (begin, end) = bounds(&old)?;
    let new =
        format!("{}{}{}", &old[..begin], table::text(&driver.name, &costs(driver, shaders)?), &old[end..]);
    fs::write(path, new).map_err(|source| Error::File { path: path.to_owned(), source })
}

fn check(driver: &Driver, shaders: &[Shader], path: &Path) -> Result<()> {
    let old = read(path)?;
    let (begin, end) = bounds(&old)?;
    let (made_by, old) = table::parse(&old[begin..end])?;
    if made_by != driver.name {
        println!("costs of shaders are not compared: the table is by {made_by}, here is {}", driver.name);
        return Ok(());
    }
    let new = costs(driver, shaders)?;
    let dearer = table::dearer(&new, &old);
    if !dearer.is_empty() {
        return Err(Error::Dearer(dearer));
    }
    if new != old {
        println!(
            "some shaders cost less, or hardly more, than their table says: `cargo xtask gpu-cost` writes it anew"
        );
    }
    Ok(())
}

fn costs(driver: &Driver, shaders: &[Shader]) -> Result<Costs> {
    let cost = |shader: &Shader| {
        let executable = driver.compile(&shader::translate(shader)?)?;
        Ok((shader.name.to_string(), Cost::of(&executable)?))
    };
    shaders.iter().map(cost).collect()
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).map_err(|source| Error::File { path: path.to_owned(), source })
}

/// Beginning and end of the table in the text of its file.
fn bounds(text: &str) -> Result<(usize, usize)> {
    let begin = text.find(table::BEGIN).map(|at| at + table::BEGIN.len());
    begin.zip(text.find(table::END)).filter(|(begin, end)| begin <= end).ok_or(Error::Markers)
}
