//! Presets and looks as data. The library reads and writes their texts.

use std::ffi::{CStr, CString};

use serde::{Deserialize, Serialize};

use super::error::{Error, Fault, Result, check};
use super::library::{Library, status_name};
use super::printable::printable;
use super::text;
use isophote_abi::{
    ISOPHOTE_ERROR_INTERNAL, ISOPHOTE_REFERENCE_HEIGHT, IsophoteFault, IsophoteLook, IsophotePresetsApi,
    IsophoteStatus, IsophoteText,
};

/// Name of the extension.
const EXTENSION: &CStr = c"isophote.presets/1";

/// Beginning of the names of looks where a style is named; no node has such an id.
pub const LOOK: &str = "look:";

/// A preset, not yet compared with the nodes that there are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Preset {
    /// Its name, description and tags.
    pub title: Title,
    /// The id of a node, the path of a graph file, or the JSON of a graph.
    pub style: String,
    /// Meaning of lengths, where the file says so.
    pub lengths: Option<Lengths>,
    /// Parameters in the file's order, named `id` or `node.id`.
    pub params: Vec<(String, Track)>,
    /// Rules for things in the picture; where several hold, the last one counts.
    pub objects: Vec<ObjectRule>,
}

/// A rule for things in a picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObjectRule {
    /// The rule as the file has it.
    pub rule: serde_json::Map<String, serde_json::Value>,
    /// The things, in the words of the host that finds them. The library tells them and the next with the preset that it reads.
    #[serde(skip_serializing)]
    pub things: String,
    /// What a control map has where the things are: detail, width of lines, their amount and strength of the medium.
    #[serde(skip_serializing)]
    pub control: [Option<f32>; 4],
}

/// The name of a preset, a description of its look, and words by which it is found. All may be left out.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Title {
    /// The name, one line.
    pub name: Option<String>,
    /// Description of the look, one line.
    pub about: Option<String>,
    /// Words by which it is found.
    pub tags: Vec<String>,
}

/// Values of one parameter of a preset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Track {
    /// The same value for all frames, as text.
    Still(String),
    /// Values by frame.
    Keys {
        /// Values as text, by ascending frame; at least one.
        keys: Vec<(i64, String)>,
        /// True where values hold until the next key, false where they change evenly.
        step: Option<bool>,
    },
}

/// Meaning of the lengths of parameters, which are given in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Lengths {
    /// Pixels of a picture as high as [`ISOPHOTE_REFERENCE_HEIGHT`]: pictures of all sizes get the same look.
    #[default]
    Relative,
    /// Pixels of the picture itself.
    Pixels,
}

/// A look that ships with the library.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Stable name.
    pub id: &'static str,
    /// The text of its preset.
    pub json: &'static str,
}

impl Lengths {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Relative, Self::Pixels];

    /// The word for it in presets.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Relative => "relative",
            Self::Pixels => "pixels",
        }
    }

    /// The reference height of a request; 0: lengths are pixels of the picture.
    pub const fn reference_height(self) -> u32 {
        match self {
            Self::Relative => ISOPHOTE_REFERENCE_HEIGHT,
            Self::Pixels => 0,
        }
    }
}

impl Title {
    /// Itself, with what it leaves out taken from another.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            name: self.name.or(other.name),
            about: self.about.or(other.about),
            tags: if self.tags.is_empty() { other.tags } else { self.tags },
        }
    }
}

impl Track {
    /// Frames of the keys.
    pub fn frames(&self) -> impl Iterator<Item = i64> {
        let keys = match self {
            Self::Still(_) => &[],
            Self::Keys { keys, .. } => keys.as_slice(),
        };
        keys.iter().map(|(frame, _)| *frame)
    }
}

impl Look {
    /// Its name where a style is named.
    pub fn name(&self) -> String {
        format!("{LOOK}{}", self.id)
    }
}

/// Report of the library on the text of a preset.
#[derive(Deserialize)]
struct Report {
    preset: Option<Preset>,
    faults: Vec<Fault>,
}

/// Text of a file that names a style.
#[derive(Clone, Debug, PartialEq)]
pub enum StyleText {
    /// A graph.
    Graph,
    /// A preset with all its faults. Its style is empty where none can be read.
    Preset(Preset, Vec<Fault>),
}

impl Library {
    pub(super) fn presets(&self) -> Result<&'static IsophotePresetsApi> {
        self.extension(EXTENSION, "this library reads no presets")
    }

    /// All looks that ship, in the order of lists.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the library has no presets.
    pub fn looks(&self) -> Result<Vec<Look>> {
        let table = self.presets()?;
        let (mut looks, mut count) = (std::ptr::null(), 0);
        // SAFETY: both places may be written during the call.
        let status = unsafe { (table.looks)(&raw mut looks, &raw mut count) };
        check(status, || format!("the looks: {}", status_name(self.api, status)))?;
        // SAFETY: the library's list and its texts live as long as it is loaded, which is until the process ends.
        let looks = unsafe { text::slice(looks, count) };
        let look = |look: &IsophoteLook| {
            // SAFETY: as above.
            let [id, json] = [look.id, look.preset].map(|text| unsafe { text::constant(text) });
            Look { id, json }
        };
        Ok(looks.iter().map(look).collect())
    }

    /// The colour that a person wrote: gamma-encoded RGBA, 0 to 1.
    ///
    /// # Errors
    /// [`Error`](crate::Error) for text that is none.
    pub fn color(&self, text: &str) -> Result<[f32; 4]> {
        let (table, text) = (self.presets()?, text::argument(text)?);
        let mut color = [0.0; 4];
        faulty(|fault| {
            // SAFETY: the text ends with a zero; there is room for four numbers, and the fault may be written.
            unsafe { (table.color)(text.as_ptr(), color.as_mut_ptr(), fault) }
        })?;
        Ok(color)
    }

    /// Reads the text of a preset, as far as it can be read, or tells that it is a graph. `place` names it in messages.
    ///
    /// # Errors
    /// [`Error`](crate::Error) for text that is no JSON object.
    pub fn read_style(&self, place: &str, json: &str) -> Result<StyleText> {
        let (table, json, place) = (self.presets()?, text::argument(json)?, text::argument(place)?);
        let report = written(|out, fault| {
            // SAFETY: the texts end with a zero; the others may be written.
            unsafe { (table.read)(json.as_ptr(), place.as_ptr(), out, fault) }
        })?;
        let Report { preset, faults } = decoded(&report)?;
        let faults = faults.into_iter().map(shown).collect();
        Ok(preset.map_or(StyleText::Graph, |preset| StyleText::Preset(preset, faults)))
    }

    /// The text of a file that holds a preset.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the library fails.
    pub fn write_preset(&self, preset: &Preset) -> Result<String> {
        let table = self.presets()?;
        let preset = serde_json::to_string(preset).map_err(|error| mistake(&error))?;
        let preset = text::argument(&preset)?;
        written(|out, fault| {
            // SAFETY: the text ends with a zero; the others may be written.
            unsafe { (table.write)(preset.as_ptr(), out, fault) }
        })
    }

    /// All faults of a preset, also those that the nodes find in its values. `graph` is the text of the graph file that it
    /// names, if it names one.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the library fails.
    pub fn check_preset(&self, place: &str, json: &str, graph: Option<&str>) -> Result<Vec<Fault>> {
        let (table, json, place) = (self.presets()?, text::argument(json)?, text::argument(place)?);
        let graph = graph.map(text::argument).transpose()?;
        let report = written(|out, fault| {
            // SAFETY: the texts end with a zero, and null is allowed for the last; the others may be written.
            unsafe { (table.check)(json.as_ptr(), place.as_ptr(), pointer(graph.as_ref()), out, fault) }
        })?;
        listed(&report)
    }
}

/// The faults of a list in JSON.
pub(super) fn listed(faults: &str) -> Result<Vec<Fault>> {
    let faults: Vec<Fault> = decoded(faults)?;
    Ok(faults.into_iter().map(shown).collect())
}

/// The pointer to a text that may be missing.
pub(super) fn pointer(text: Option<&CString>) -> *const std::ffi::c_char {
    text.map_or(std::ptr::null(), |text| text.as_ptr())
}

/// Calls a function that fills the parts of a fault when it fails.
pub(super) fn faulty(call: impl FnOnce(*mut IsophoteFault) -> IsophoteStatus) -> Result<()> {
    // Names in presets may be long, and stand in the place and the problem alike.
    let mut bytes = [[0u8; 2048]; 4];
    let mut texts = bytes.each_mut().map(|bytes| IsophoteText {
        data: bytes.as_mut_ptr().cast(),
        capacity: bytes.len(),
        length: 0,
    });
    let [place, problem, fix, node] = texts;
    let mut fault = IsophoteFault { place, problem, fix, node };
    let status = call(&raw mut fault);
    texts = [fault.place, fault.problem, fault.fix, fault.node];
    let part = |at: usize| {
        let length = texts[at].length.min(bytes[at].len() - 1);
        String::from_utf8_lossy(&bytes[at][..length]).into_owned()
    };
    check(status, String::new).map_err(|_| {
        let [place, problem, fix, node] = [0, 1, 2, 3].map(part);
        Error::Fault { status, fault: shown(Fault { place, problem, fix, node }) }
    })
}

/// The whole text that a function writes which may fail with a fault.
pub(super) fn written(
    mut call: impl FnMut(*mut IsophoteText, *mut IsophoteFault) -> IsophoteStatus,
) -> Result<String> {
    let mut written = Ok(());
    let (_, text) = text::whole(|out| {
        let mut status = 0;
        written = faulty(|fault| {
            status = call(out, fault);
            status
        });
        status
    });
    written.map(|()| text)
}

fn decoded<'j, T: Deserialize<'j>>(json: &'j str) -> Result<T> {
    serde_json::from_str(json).map_err(|error| mistake(&error))
}

fn mistake(error: &serde_json::Error) -> Error {
    Error::Call {
        status: ISOPHOTE_ERROR_INTERNAL,
        message: format!("the library's form of presets: {error}"),
    }
}

/// The fault as terminals may show it: names in it come from files.
fn shown(fault: Fault) -> Fault {
    let Fault { place, problem, fix, node } = fault;
    let [place, problem, fix] = [place, problem, fix].map(|part| printable(&part).into_owned());
    Fault { place, problem, fix, node }
}
