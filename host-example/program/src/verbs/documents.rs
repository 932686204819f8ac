//! `isophote documents`: the manual pages and the completions for shells, made of the declaration that the program
//! parses its command line by.

use std::path::{Path, PathBuf};

use clap::{Args, Command};
use clap_complete::Shell;

use super::shared::ForceArgs;
use isophote_files::error::{Error, Result};
use isophote_files::files;

/// Options of `documents`.
#[derive(Args, Debug)]
pub struct DocumentsArgs {
    /// The folder to write to, laid out as `share` of a system: man/man1, bash-completion, zsh, fish, powershell.
    folder: PathBuf,
    #[command(flatten)]
    force: ForceArgs,
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
/// [`Error::Input`] when the folder cannot be written, and for files that are there already.
pub fn run(args: &DocumentsArgs, command: Command) -> Result<()> {
    let mut documents = Vec::new();
    let mut documented = command.clone().disable_help_subcommand(true);
    documented.build();
    pages(&documented, &args.folder.join("man/man1"), &mut documents)?;
    for (shell, place, name) in COMPLETIONS {
        let mut text = Vec::new();
        clap_complete::generate(shell, &mut command.clone(), "isophote", &mut text);
        documents.push((args.folder.join(place).join(name), text));
    }
    let existing = args.force.existing();
    for (path, _) in &documents {
        let folder = path.parent().unwrap_or(&args.folder);
        std::fs::create_dir_all(folder)
            .map_err(|e| Error::file(folder, format!("cannot be made: {e}"), "choose another folder"))?;
        files::check_writable(path, existing)?;
    }
    documents.iter().try_for_each(|(path, text)| files::write_bytes(path, existing, text))
}

/// Adds the page of a command and those of its verbs, which belong into a folder.
fn pages(command: &Command, folder: &Path, documents: &mut Vec<(PathBuf, Vec<u8>)>) -> Result<()> {
    let program = concat!("Isophote ", env!("CARGO_PKG_VERSION"));
    let page = clap_mangen::Man::new(command.clone()).manual("Isophote").source(program);
    let mut text = Vec::new();
    page.render(&mut text)
        .map_err(|e| Error::failure(e, "this is a mistake in the program; please report it"))?;
    if let Some(examples) = command.get_before_help() {
        // Lines stay lines; a dot or a quote at their beginning would be a request.
        let examples = examples.to_string();
        let examples = examples.split_once('\n').map_or("", |(_, lines)| lines);
        let examples = examples.replace('\\', "\\e").replace('-', "\\-");
        text.extend(format!(".SH EXAMPLES\n.nf\n{examples}\n.fi\n").bytes());
    }
    documents.push((folder.join(page.get_filename()), text));
    let mut verbs = command.get_subcommands().filter(|verb| !verb.is_hide_set());
    verbs.try_for_each(|verb| pages(verb, folder, documents))
}
