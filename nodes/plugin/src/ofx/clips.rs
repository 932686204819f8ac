//! Names of the clips.

use super::host::Host;
use super::image::Clip;
use isophote::graph::GraphInput;
use isophote_abi::openfx::Handle;
use std::ffi::{CStr, CString};
use std::sync::LazyLock;

/// The picture.
pub const SOURCE: &CStr = c"Source";
/// The result.
pub const OUTPUT: &CStr = c"Output";
/// Name of the clip that says where the effect shows.
pub const MASK: &CStr = c"Mask";
/// Vectors to the frame before.
pub const MOTION: &CStr = c"Motion";
/// Vectors to the frame after.
pub const MOTION_FORWARD: &CStr = c"MotionForward";

/// A guide that may be a clip.
struct Named {
    guide: GraphInput,
    name: CString,
    label: CString,
}

/// The guides that may be clips, in the order of inputs.
static CLIPS: LazyLock<Vec<Named>> = LazyLock::new(|| {
    let mut guides: Vec<GraphInput> =
        GraphInput::GUIDES.into_iter().filter(|guide| guide.clip().is_some()).collect();
    guides.sort_by_key(|guide| guide.clip());
    let named =
        |guide: GraphInput| Named { guide, name: text(&in_one_word(guide.id())), label: text(guide.label()) };
    guides.into_iter().map(named).collect()
});

/// The guides that may be clips, in the order of inputs.
pub fn guides() -> impl Iterator<Item = GraphInput> {
    CLIPS.iter().map(|clip| clip.guide)
}

/// Guides that effects of nodes came to take when projects of users existed, in the order in which they came.
const LATER: [(&str, GraphInput); 9] = [
    ("cartoon", GraphInput::RestPosition),
    ("blueprint", GraphInput::RestPosition),
    ("blueprint", GraphInput::Paper),
    ("cartoon", GraphInput::Albedo),
    ("cartoon", GraphInput::Diffuse),
    ("cartoon", GraphInput::Specular),
    ("cartoon", GraphInput::LinePaint),
    ("blueprint", GraphInput::LinePaint),
    ("halftone", GraphInput::LinePaint),
];

/// The guides among these of the effect of a node, in the order of its inputs: those that came later are the last, since
/// projects store the numbers of inputs.
pub fn guides_of(node: &str, takes: impl Fn(GraphInput) -> bool) -> Vec<GraphInput> {
    let mut taken: Vec<GraphInput> = guides().filter(|guide| takes(*guide)).collect();
    taken.sort_by_key(|guide| LATER.iter().position(|later| *later == (node, *guide)));
    taken
}

/// Name of the clip that gives a guide.
pub fn guide_clip(guide: GraphInput) -> Option<&'static CStr> {
    CLIPS.iter().find(|clip| clip.guide == guide).map(|clip| clip.name.as_c_str())
}

/// The label of the clip that gives a guide.
pub fn guide_label(guide: GraphInput) -> Option<&'static CStr> {
    CLIPS.iter().find(|clip| clip.guide == guide).map(|clip| clip.label.as_c_str())
}

/// True where the instance has a clip of this name, and the host does not say that it is open.
pub fn is_connected(host: &Host, instance: Handle, name: &CStr) -> bool {
    Clip::of(host, instance, name).is_some_and(|clip| !clip.is_open())
}

/// An id as the names of clips are written: `rest_position` is `RestPosition`.
fn in_one_word(id: &str) -> String {
    let capital = |word: &str| word[..1].to_ascii_uppercase() + &word[1..];
    id.split('_').map(capital).collect()
}

/// Text without what C strings cannot hold.
fn text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clips_of_guides_have_names_of_their_own() {
        let names: Vec<&CStr> = CLIPS.iter().map(|clip| clip.name.as_c_str()).collect();
        let known = [c"Normal", c"Depth", MOTION, MOTION_FORWARD, c"RestPosition", c"ObjectId", c"Flow"];
        assert_eq!(names[..known.len()], known);
        let places: Vec<Option<u32>> = guides().map(GraphInput::clip).collect();
        assert_eq!(places, (0..names.len() as u32).map(Some).collect::<Vec<_>>());
        assert_eq!(guide_label(GraphInput::ObjectId), Some(c"Object id"));
    }
}
