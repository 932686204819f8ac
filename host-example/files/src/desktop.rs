//! Desktops that give no window.

use std::fmt::Display;

use crate::error::Error;

/// The error of a system that gives no window, from what winit says of it. Its text begins with a line of winit's source,
/// which nobody needs.
pub fn no_window(problem: impl Display, fix: &str) -> Error {
    let text = problem.to_string();
    let place = text.split_once(".rs:").and_then(|(_, place)| place.split_once(": "));
    let problem = place.map_or(text.as_str(), |(_, problem)| problem).trim_end_matches('.');
    Error::failure(format!("no window can be opened: {problem}"), fix)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_the_source_are_left_out() {
        let text = "os error at /home/a/winit-0.30.13/src/linux/mod.rs:765: DISPLAY is not set.";
        assert_eq!(no_window(text, "try").to_string(), "no window can be opened: DISPLAY is not set; try");
        assert_eq!(no_window("no memory", "try").to_string(), "no window can be opened: no memory; try");
    }
}
