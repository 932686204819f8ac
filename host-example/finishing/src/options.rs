//! Options of command lines as text, from one declaration.

use clap::{Args, Command};

/// The words of the options that `written` has a text for, in the order of their declaration; flags have an empty one.
pub(crate) fn words<A: Args>(written: impl Fn(&str) -> Option<String>) -> Vec<String> {
    let command = A::augment_args(Command::new("options"));
    let mut words = Vec::new();
    for option in command.get_arguments() {
        let (Some(name), Some(value)) = (option.get_long(), written(option.get_id().as_str())) else {
            continue;
        };
        words.push(format!("--{name}"));
        words.extend(Some(value).filter(|_| option.get_action().takes_values()));
    }
    words
}

/// The text of a flag.
pub(crate) fn flag(is_set: bool) -> Option<String> {
    is_set.then(String::new)
}
