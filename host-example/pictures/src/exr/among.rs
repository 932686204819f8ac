//! Things of a scene that a mask is of, while there is no picture of them.

use std::path::Path;

use super::cryptomatte::Manifest;
use super::mask::{MaskSource, OnUnknown};
use isophote_cryptomatte::{MATERIALS, MatteChoice, OBJECTS};
use isophote_files::error::{Error, Result};
use isophote_files::output;

impl MaskSource {
    /// By thing of the scene in the file `scene`: true where the mask is of it. `objects` and `materials` have a name for each
    /// thing, whose number is its place, from 1. Names that no thing has are refused or warned of.
    ///
    /// # Errors
    /// [`Error::Input`] for names that no thing has, and for masks in files.
    pub fn among(
        &self,
        scene: &Path,
        [objects, materials]: [&[String]; 2],
        on_unknown: OnUnknown,
    ) -> Result<Vec<bool>> {
        match self {
            Self::Ids(ids) => {
                Ok((1..=objects.len()).map(|number| ids.iter().any(|id| *id as usize == number)).collect())
            }
            Self::Mattes(choice) => named(choice, scene, [objects, materials], on_unknown),
            Self::File(_) | Self::Layer(_) => {
                let problem = "has no masks in files or layers";
                Err(Error::file(scene, problem, "write cryptomatte:NAME, material:NAME or id:NUMBER"))
            }
        }
    }
}

fn named(
    choice: &MatteChoice,
    scene: &Path,
    [objects, materials]: [&[String]; 2],
    on_unknown: OnUnknown,
) -> Result<Vec<bool>> {
    let names = match choice.layer.as_deref() {
        None | Some(OBJECTS) => objects,
        Some(MATERIALS) => materials,
        Some(other) => {
            let problem = format!("has no Cryptomatte '{}'", other.escape_default());
            let fix = format!("write cryptomatte[{OBJECTS}] or cryptomatte[{MATERIALS}]");
            return Err(Error::file(scene, problem, fix));
        }
    };
    for wanted in &choice.names {
        if !names.iter().any(|name| wanted.matches(name)) {
            let problem = format!("has nothing of the name '{}'", wanted.text.escape_default());
            match on_unknown {
                OnUnknown::Fail => {
                    return Err(Error::file(scene, problem, Manifest::of(names).advice(&wanted.text)));
                }
                OnUnknown::Empty => output::warn(format_args!("{}: {problem}", scene.display())),
                OnUnknown::Quiet => {}
            }
        }
    }
    Ok(names.iter().map(|name| choice.names.iter().any(|wanted| wanted.matches(name))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn things_are_found_by_names_and_numbers() {
        let names = |names: [&str; 3]| names.map(str::to_owned);
        let (objects, materials) = (names(["hero/arm", "hero/leg", "floor"]), names(["skin", "skin", "oak"]));
        let among = |text: &str| {
            let source: MaskSource = text.parse().unwrap();
            source.among(Path::new("scene.gltf"), [&objects, &materials], OnUnknown::Fail)
        };
        for (text, expected) in [
            ("cryptomatte:hero/*", [true, true, false]),
            ("cryptomatte:floor,hero/leg", [false, true, true]),
            ("cryptomatte[crypto_object]:floor", [false, false, true]),
            ("material:skin", [true, true, false]),
            ("id:3,1,7", [true, false, true]),
        ] {
            assert_eq!(among(text).unwrap(), expected, "{text}");
        }
        for (text, said) in [
            ("cryptomatte:hero", "did you mean hero/arm, hero/leg?"),
            ("cryptomatte:hero/*,flor", "'flor'; did you mean floor?"),
            ("cryptomatte[asset]:floor", "write cryptomatte[crypto_object] or"),
            ("mask.png", "in files"),
        ] {
            let error = among(text).unwrap_err().to_string();
            assert!(error.starts_with("scene.gltf") && error.contains(said), "{error}");
        }
        let source: MaskSource = "cryptomatte:hero/*,flor".parse().unwrap();
        let found = source.among(Path::new("scene.gltf"), [&objects, &materials], OnUnknown::Empty);
        assert_eq!(found.unwrap(), [true, true, false]);
    }
}
