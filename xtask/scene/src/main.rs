//! `isophote-demo-scene DIR`: writes the demo scene to a folder and prints the files to open.

use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut arguments = std::env::args_os().skip(1);
    let (Some(folder), None) = (arguments.next().map(PathBuf::from), arguments.next()) else {
        eprintln!("usage: isophote-demo-scene DIR");
        return ExitCode::from(2);
    };
    match isophote_demo_scene::write_to(&folder) {
        Ok(()) => {
            for name in [isophote_demo_scene::SCENE, isophote_demo_scene::HOUSE] {
                println!("{}", folder.join(name).display());
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("isophote-demo-scene: {error}");
            ExitCode::FAILURE
        }
    }
}
