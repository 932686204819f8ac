//! The Cryptomattes that a file holds, by the attributes of its headers, and the channels that are theirs.
//!
//! A Cryptomatte `crypto_object` has attributes `cryptomatte/f834d0a/name` and so on, and layers `crypto_object00`,
//! `crypto_object01` ..., each with two ranks: an id in red with its coverage in green, another in blue with its in alpha.
//! The layer without a number is a preview.

use std::path::Path;

use isophote_exr_edit::{File, Sample};

use super::cryptomatte::{Manifest, sidecar};
use super::fault::Fault;
use super::names::Group;
use isophote_files::input;

/// Beginning of the names of attributes.
const PREFIX: &str = "cryptomatte/";
/// The only hash and conversion that the specification knows.
const HASH: &str = "MurmurHash3_32";
const CONVERSION: &str = "uint32_to_float32";
/// Most bytes of a manifest; large ones have some millions.
const MOST_BYTES: usize = 64 << 20;
/// The compression that cuts floats to 24 bits.
const PXR24: u8 = 5;

/// A Cryptomatte of a file.
#[derive(Debug)]
pub struct Matte<'a> {
    key: &'a str,
    /// Name of its layers, but for their numbers.
    pub name: String,
    hash: Option<&'a [u8]>,
    conversion: Option<&'a [u8]>,
    manifest: Option<&'a [u8]>,
    file: Option<&'a [u8]>,
}

/// A layer of two ranks.
#[derive(Clone, Debug)]
pub struct Ranks {
    /// Index of the part.
    pub part: usize,
    /// An id, its coverage, and maybe another id with its coverage.
    pub channels: Vec<usize>,
}

/// All Cryptomattes of a file by their names. Parts may repeat one.
pub fn mattes(exr: &File) -> Vec<Matte<'_>> {
    let mut found: Vec<Matte<'_>> = Vec::new();
    for part in 0..exr.parts().len() {
        let first = found.len();
        for (name, value) in exr.texts(part) {
            let Some((key, field)) = name.strip_prefix(PREFIX).and_then(|rest| rest.split_once('/')) else {
                continue;
            };
            let own = found[first..].iter().position(|matte| matte.key == key).map(|at| first + at);
            let at = own.unwrap_or_else(|| {
                let nothing = None::<&[u8]>;
                let (hash, conversion, manifest, file) = (nothing, nothing, nothing, nothing);
                found.push(Matte { key, name: String::new(), hash, conversion, manifest, file });
                found.len() - 1
            });
            let matte = &mut found[at];
            match field {
                "name" => matte.name = String::from_utf8_lossy(value).trim_end_matches('\0').to_owned(),
                "hash" => matte.hash = Some(value),
                "conversion" => matte.conversion = Some(value),
                "manifest" => matte.manifest = Some(value),
                "manif_file" => matte.file = Some(value),
                _ => {}
            }
        }
        let repeated = |found: &[Matte<'_>], at: usize| found[..at].iter().any(|m| m.name == found[at].name);
        for at in (first..found.len()).rev() {
            if found[at].name.is_empty() || repeated(&found, at) {
                found.remove(at);
            }
        }
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    found
}

/// The Cryptomatte of this name, or the one of objects without.
///
/// # Errors
/// [`Fault::Choice`] naming those that there are.
pub fn pick<'m, 'a>(mattes: &'m [Matte<'a>], wanted: Option<&str>) -> Result<&'m Matte<'a>, Fault> {
    let word = |matte: &Matte<'_>| matte.name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
    let all = || mattes.iter().map(|m| format!("cryptomatte[{}]", m.name)).collect::<Vec<_>>().join(" or ");
    if mattes.is_empty() {
        return Err(Fault::Choice {
            problem: "has no Cryptomatte: no attribute of its headers names one".into(),
            fix: "render Cryptomatte into the same file, or name a mask file".into(),
        });
    }
    let chosen: Vec<&Matte<'a>> = match wanted {
        Some(wanted) => match mattes.iter().find(|m| m.name == wanted) {
            Some(exact) => vec![exact],
            None => mattes.iter().filter(|m| word(m) == wanted.to_ascii_lowercase()).collect(),
        },
        None if mattes.len() == 1 => mattes.iter().collect(),
        None => mattes.iter().filter(|m| word(m).contains("object")).collect(),
    };
    match (chosen.as_slice(), wanted) {
        ([one], _) => Ok(one),
        ([], Some(wanted)) => Err(Fault::Choice {
            problem: format!("has no Cryptomatte '{wanted}'"),
            fix: format!("write {}", all()),
        }),
        _ => {
            Err(Fault::Choice { problem: "has several Cryptomattes".into(), fix: format!("write {}", all()) })
        }
    }
}

impl Matte<'_> {
    /// The number of a layer of ranks; nothing for other layers.
    fn number(&self, layer: &str) -> Option<u32> {
        let digits = layer.strip_prefix(self.name.as_str())?;
        digits.bytes().all(|b| b.is_ascii_digit()).then(|| digits.parse().ok())?
    }

    /// True where a layer is one of its, the preview included.
    pub fn has(&self, layer: &str) -> bool {
        layer == self.name || self.number(layer).is_some()
    }

    /// True where the id of a name that is nowhere listed can be told.
    pub fn is_hashed(&self) -> bool {
        self.hash.is_none_or(|hash| hash == HASH.as_bytes())
    }

    /// Its layers in order, in the view of `picture` and near it.
    ///
    /// # Errors
    /// [`Fault::Choice`] for ids that are no floats, or not whole; when there are no layers.
    pub fn ranks(&self, exr: &File, groups: &[Group], picture: &Group) -> Result<Vec<Ranks>, Fault> {
        let fail = |problem: String, fix: &str| Err(Fault::Choice { problem, fix: fix.into() });
        let name = &self.name;
        if self.conversion.is_some_and(|conversion| conversion != CONVERSION.as_bytes()) {
            return fail(
                format!("holds the ids of Cryptomatte '{name}' in a way that is not read"),
                "render it anew",
            );
        }
        let near = groups.iter().filter(|g| g.view == picture.view || g.view.is_none());
        let mut layers: Vec<(u32, &Group)> = near.filter_map(|g| Some((self.number(&g.layer)?, g))).collect();
        layers.sort_by_key(|(number, g)| (*number, g.view != picture.view, g.part != picture.part));
        layers.dedup_by_key(|(number, _)| *number);
        let mut ranks = Vec::new();
        for (_, group) in layers {
            let component = |long: &str| group.member(&long[..1]).or_else(|| group.member(long));
            let [red, green, blue, alpha] = ["Red", "Green", "Blue", "Alpha"].map(component);
            let pairs = [red.zip(green), blue.zip(alpha)].into_iter().flatten();
            let channels: Vec<usize> = pairs.flat_map(|(id, coverage)| [id, coverage]).collect();
            let part = &exr.parts()[group.part];
            if channels.iter().any(|c| part.channels[*c].sampling != (1, 1)) {
                return fail(
                    format!("has fewer samples than pixels in layer '{}'", group.layer),
                    "render it anew",
                );
            }
            let is_whole =
                |id: &usize| part.channels[*id].sample == Sample::Float && part.compression != PXR24;
            if !channels.iter().step_by(2).all(is_whole) {
                return fail(
                    format!("holds ids in layer '{}' that are not 32 bits long", group.layer),
                    "render Cryptomatte as 32-bit floats, under ZIP compression",
                );
            }
            ranks.push(Ranks { part: group.part, channels });
        }
        ranks.retain(|layer| !layer.channels.is_empty());
        if ranks.is_empty() {
            return fail(
                format!("names a Cryptomatte '{name}', but has no layer '{name}00' of it"),
                "render it anew",
            );
        }
        Ok(ranks)
    }

    /// Its names, of a picture in `folder`.
    ///
    /// # Errors
    /// The problem with the manifest.
    pub fn manifest(&self, folder: &Path) -> Result<Manifest, String> {
        let too_large = || format!("has more than {MOST_BYTES} bytes");
        if let Some(name) = self.file {
            let path = sidecar(folder, String::from_utf8_lossy(name).trim_end_matches('\0'))?;
            let wrong = |problem: String| format!("'{}' {problem}", path.display());
            let json = input::text(&path, MOST_BYTES as u64)
                .map_err(|problem| wrong(format!("cannot be read: {problem}")))?;
            return Manifest::parse(&json).map_err(wrong);
        }
        match self.manifest {
            None => Ok(Manifest::default()),
            Some(json) if json.len() > MOST_BYTES => Err(too_large()),
            Some(json) => Manifest::parse(String::from_utf8_lossy(json).trim_end_matches('\0')),
        }
    }
}
