//! `isophote documents`: the manual pages and the completions for shells, made of the declaration that the program
//! parses its command line by.

use std::path::{Path, PathBuf};

use clap::{Args, Command};
use clap_complete::Shell;

use crate::error::{Error, Result};

/// Options of `documents`.
#[derive(Args, Debug)]
pub struct DocumentsArgs {
    /// The folder to write to, laid out as `share` of a system: man/man1, bash-completion, zsh, fish, powershell.
    folder: PathBuf,
}

/// Shells, where each looks for completions below `share`, and the name of the file.
const COMPLETIONS: [(Shell, &str, &str); 4] = [
    (Shell::Bash, "bash-completion/completions", "isophote"),
    (Shell::Zsh, "zsh/site-functions", "_isophote"),
    (Shell::Fish, "fish/vendor_completions.d", "isophote.fish"),
    (Shell::PowerShell, "powershell", "isophote.ps1"),
];

/// Runs the verb for the command line of this program.
///
/// # Errors
/// [`Error::Input`] when the folder cannot be written.
pub fn run(args: &DocumentsArgs, command: Command) -> Result<()> {
    let pages = folder(&args.folder.join("man/man1"))?;
    let mut documented = command.clone().disable_help_subcommand(true);
    documented.build();
    page(&documented, &pages)?;
    for (shell, place, name) in COMPLETIONS {
        let path = folder(&args.folder.join(place))?.join(name);
        let mut text = Vec::new();
        clap_complete::generate(shell, &mut command.clone(), "isophote", &mut text);
        std::fs::write(&path, text).map_err(|e| unwritten(&path, &e))?;
    }
    Ok(())
}

/// Writes the page of a command and those of its verbs.
fn page(command: &Command, folder: &Path) -> Result<()> {
    let program = concat!("Isophote ", env!("CARGO_PKG_VERSION"));
    let text = clap_mangen::Man::new(command.clone()).manual("Isophote").source(program);
    text.generate_to(folder).map_err(|e| unwritten(folder, &e))?;
    command.get_subcommands().filter(|verb| !verb.is_hide_set()).try_for_each(|verb| page(verb, folder))
}

fn folder(path: &Path) -> Result<PathBuf> {
    std::fs::create_dir_all(path).map_err(|e| unwritten(path, &e))?;
    Ok(path.to_owned())
}

fn unwritten(path: &Path, error: &std::io::Error) -> Error {
    Error::input(path.display(), format!("cannot be written: {error}"), "choose another folder")
}
