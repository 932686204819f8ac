//! Differences between hosts, by the name that a host gives itself. Whatever follows from a property
//! or an image is not here: it is looked at where it is used.

use isophote_colour::Space;
use std::ffi::CStr;

/// Differences of a host from others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quirks {
    /// Space of its pixels unless the user says otherwise.
    pub space: Space,
    /// True where messages may be shown from a thread that renders.
    pub messages: bool,
    /// True where its multi-thread suite is sound.
    pub threads: bool,
    /// True where a clip without a picture can call itself connected, so that a mask must be asked for.
    pub all_connected: bool,
    /// True where effects hear of what the user edits.
    pub tells_of_edits: bool,
    /// True where a step to undo holds all that an effect sets between its begin and its end.
    pub keeps_steps: bool,
}

impl Default for Quirks {
    fn default() -> Self {
        // Most hosts composite in scene-linear light.
        Self {
            space: Space::Linear,
            messages: true,
            threads: true,
            all_connected: false,
            tells_of_edits: true,
            keeps_steps: true,
        }
    }
}

impl Quirks {
    /// The quirks of the host of this name.
    pub fn of(name: &CStr) -> Self {
        let name = name.to_string_lossy().to_ascii_lowercase();
        let named = |words: &[&str]| words.iter().any(|word| name.contains(word));
        let general = Self::default();
        if named(&["davinciresolve", "resolve"]) {
            // Its message functions are null or worse, and every clip is connected.
            return Self { space: Space::Srgb, messages: false, all_connected: true, ..general };
        }
        if named(&["catalyst"]) {
            // The suite lacks its mutexes.
            return Self { space: Space::Srgb, threads: false, ..general };
        }
        if named(&["openfx-driver"]) {
            // A runner for tests, which ends when its suite is used.
            return Self { threads: false, ..general };
        }
        if named(&["mlt", "kdenlive", "shotcut"]) {
            // Instances are made anew for each frame, with the values that there are.
            return Self { space: Space::Srgb, tells_of_edits: false, ..general };
        }
        if named(&["natron"]) {
            // It ends a step when it tells the effect of the first value.
            return Self { keeps_steps: false, ..general };
        }
        // Editors work on pictures as they are displayed.
        if named(&["vegas", "premiere", "hitfilm"]) {
            return Self { space: Space::Srgb, ..general };
        }
        general
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn editors_are_display_referred_and_compositors_linear() {
        for name in [c"DaVinciResolve", c"com.sonycreativesoftware.vegas", c"org.mltframework.mlt"] {
            assert_eq!(Quirks::of(name).space, Space::Srgb, "{name:?}");
        }
        for name in [c"uk.co.thefoundry.nuke", c"fr.inria.Natron", c"com.autodesk.flame", c""] {
            assert_eq!(Quirks::of(name).space, Space::Linear, "{name:?}");
        }
        assert!(!Quirks::of(c"DaVinciResolve").messages);
        assert!(!Quirks::of(c"openfx-driver").threads && Quirks::of(c"uk.co.thefoundry.nuke").threads);
    }
}
