//! Colour spaces that can be named, on the command line.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

pub use isophote_colour::Space;

/// Parser of options that name a space, by its id or an alias.
pub fn parser() -> impl TypedValueParser<Value = Space> {
    let values = Space::ALL.map(|space| {
        // Help has no full stops.
        let help = space.doc().trim_end_matches('.');
        PossibleValue::new(space.id()).aliases(space.aliases()).help(help)
    });
    PossibleValuesParser::new(values).try_map(|name| name.parse::<Space>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_and_aliases_are_read() {
        let command = clap::Command::new("test").arg(clap::Arg::new("space").value_parser(parser()));
        for space in Space::ALL {
            for name in space.aliases().iter().chain([&space.id()]) {
                let read = command.clone().try_get_matches_from(["test", name]).unwrap();
                assert_eq!(read.get_one::<Space>("space"), Some(&space));
            }
        }
        let problem = command.clone().try_get_matches_from(["test", "srgb2"]).unwrap_err().to_string();
        assert!(problem.contains("[possible values: srgb, linear, acescg, p3, "), "{problem}");
    }
}
