//! The extension "isophote.presets/1": presets, looks and colours, as every host reads them.
//!
//! A preset is a JSON text: a style, which is the id of a node, a graph file or a graph written out, with its parameters, some
//! of which may change from frame to frame. The library reads no files: a host hands in their texts.

use super::constants::IsophoteStatus;
use super::types::*;
use core::ffi::c_char;

/// Lines of the picture that lengths are meant for, unless a preset says that they are pixels of the picture itself. See
/// `IsophoteRequest::reference_height`.
pub const ISOPHOTE_REFERENCE_HEIGHT: u32 = 1080;

/// The parameters of a graph as a preset sets them. Its number is never 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IsophoteStyle {
    /// The handle.
    pub id: u64,
}

/// A look that ships with the library.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteLook {
    /// Stable name. `look:` and this is the name of the look where a style is named.
    pub id: *const c_char,
    /// The text of its preset.
    pub preset: *const c_char,
}

/// Fault of a preset, in parts that together make one line: `place: problem; fix`.
///
/// The buffers are the caller's; what does not fit is cut. All are filled when a function of this extension fails, and
/// none when it succeeds.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteFault {
    /// File and parameter at fault; empty where the caller knows them alone.
    pub place: IsophoteText,
    /// Problem with it.
    pub problem: IsophoteText,
    /// Way to put it right; empty where the problem says that.
    pub fix: IsophoteText,
    /// Id of the node whose declaration says what is possible; empty for none.
    pub node: IsophoteText,
}

/// The functions of the extension "isophote.presets/1". Tags and ownership are those of `IsophoteApi`.
///
/// Arguments named `fault` may be null. `place` names a text in messages, as the path of its file would.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophotePresetsApi {
    /// Size of this table in bytes.
    pub struct_size: u32,

    /// [any-thread] All looks that ship, in the order of lists.
    pub looks: unsafe extern "C" fn(looks: *mut *const IsophoteLook, count: *mut u32) -> IsophoteStatus,
    /// [any-thread] The colour that a person wrote, `#rrggbb`, `#rrggbbaa`, or three or four numbers with commas between:
    /// four numbers R, G, B, A, gamma-encoded sRGB, 0 to 1.
    pub color: unsafe extern "C" fn(
        text: *const c_char,
        rgba: *mut f32,
        fault: *mut IsophoteFault,
    ) -> IsophoteStatus,

    /// [any-thread] Reads a preset, and writes what it holds as JSON of one form into the caller's buffer:
    /// `{"preset": {"title": {"name", "about", "tags"}, "style", "lengths", "params", "objects"}, "faults": [...]}`. A parameter is
    /// its name and `{"still": text}` or `{"keys": {"keys": [[frame, text], ...], "step"}}`, a fault its four parts. An object is
    /// `{"rule", "things", "control"}`: the rule as the file has it, the things that it matches, and what a control map has where
    /// they are, four numbers or nulls. The preset is null where the text is a graph. Fails for text that is no JSON object.
    pub read: unsafe extern "C" fn(
        json: *const c_char,
        place: *const c_char,
        report: *mut IsophoteText,
        fault: *mut IsophoteFault,
    ) -> IsophoteStatus,
    /// [any-thread] Writes the text of a file from a preset in the form of `read`, where objects have their rule alone.
    pub write: unsafe extern "C" fn(
        preset: *const c_char,
        json: *mut IsophoteText,
        fault: *mut IsophoteFault,
    ) -> IsophoteStatus,
    /// [any-thread] All faults of a preset, also those that the nodes find in its values, as a JSON array like that of `read`.
    /// `graph` is the text of the graph file that the preset names, or null where it names none.
    pub check: unsafe extern "C" fn(
        json: *const c_char,
        place: *const c_char,
        graph: *const c_char,
        faults: *mut IsophoteText,
        fault: *mut IsophoteFault,
    ) -> IsophoteStatus,

    /// [any-thread] Opens the node of an id, fed with what it needs and no picture gives, or the look that is named
    /// `look:ID`. The caller owns the style and destroys it.
    pub style_create: unsafe extern "C" fn(
        name: *const c_char,
        style: *mut IsophoteStyle,
        fault: *mut IsophoteFault,
    ) -> IsophoteStatus,
    /// [any-thread] Opens a preset, or a graph as `graph_create_from_json` takes it. `graph` is the text of the graph file
    /// that the preset names, or null where it names none. The caller owns the style and destroys it.
    ///
    /// Rules of a preset for things count in requests with what tells these: those by number, such as `id:3`, with numbers of
    /// objects, those by whole names, such as `cryptomatte:hero`, with a Cryptomatte. What they say is added to the control map and to
    /// the colours of lines, and looks of things are laid over the result. `style_left_out` tells which rules cannot be followed. A host
    /// that follows all of them by itself learns of them by `read`, and opens the preset without its objects.
    pub style_create_from_json: unsafe extern "C" fn(
        json: *const c_char,
        place: *const c_char,
        graph: *const c_char,
        style: *mut IsophoteStyle,
        fault: *mut IsophoteFault,
    ) -> IsophoteStatus,
    /// [any-thread] Destroys a style. Graphs made of it live on.
    pub style_destroy: unsafe extern "C" fn(style: IsophoteStyle) -> IsophoteStatus,
    /// [object-thread] Makes the graph of a style with the values of its parameters; those with keyframes have that of the
    /// first. The caller owns it and destroys it.
    pub style_graph: unsafe extern "C" fn(
        style: IsophoteStyle,
        graph: *mut IsophoteGraph,
        fault: *mut IsophoteFault,
    ) -> IsophoteStatus,
    /// [object-thread] The reference height of requests for a style: `ISOPHOTE_REFERENCE_HEIGHT`, or 0 where lengths are
    /// pixels of the picture.
    pub style_reference_height:
        unsafe extern "C" fn(style: IsophoteStyle, height: *mut u32) -> IsophoteStatus,
    /// [object-thread] Sets a parameter of the style's graph for all frames, from text as a person writes it. `name` is its
    /// id, or `node.id` for one node of a graph. `node`, which may be null, receives the index of its node.
    pub style_set: unsafe extern "C" fn(
        style: IsophoteStyle,
        graph: IsophoteGraph,
        name: *const c_char,
        text: *const c_char,
        node: *mut u32,
        fault: *mut IsophoteFault,
    ) -> IsophoteStatus,
    /// [object-thread] Gives parameters with keyframes their values at a frame in the style's graph. `changes`, which may be
    /// null, receives 1 where there are such, and 0 otherwise.
    pub style_at_frame: unsafe extern "C" fn(
        style: IsophoteStyle,
        graph: IsophoteGraph,
        frame: i64,
        changes: *mut u32,
        fault: *mut IsophoteFault,
    ) -> IsophoteStatus,
    /// [object-thread] The value at a frame, as text, of the parameter with keyframes that the preset names so.
    pub style_value: unsafe extern "C" fn(
        style: IsophoteStyle,
        name: *const c_char,
        frame: i64,
        text: *mut IsophoteText,
        fault: *mut IsophoteFault,
    ) -> IsophoteStatus,
    /// [object-thread] Frames of all keys in ascending order: as many as there are into `count`, and as many of them as
    /// `capacity` has room for into `frames`, which may be null when that is 0.
    pub style_frames: unsafe extern "C" fn(
        style: IsophoteStyle,
        frames: *mut i64,
        capacity: u32,
        count: *mut u32,
    ) -> IsophoteStatus,
    /// [object-thread] What the style's graph does not follow of its preset's rules for things, and why: a list of faults, as
    /// `check` has them, whose places are in the words of the rules. Names with `*` or `?` are followed by hosts alone, which know
    /// all names.
    pub style_left_out: unsafe extern "C" fn(
        style: IsophoteStyle,
        faults: *mut IsophoteText,
        fault: *mut IsophoteFault,
    ) -> IsophoteStatus,
}
