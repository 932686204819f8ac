//! Presets: a style with its parameters as a JSON file, which may change from frame to frame; and the looks that ship.
//!
//! ```json
//! {
//!   "name": "Dusk",
//!   "about": "Indigo lines that grow softer",
//!   "tags": ["comic", "soft"],
//!   "style": "cartoon",
//!   "parameters": {
//!     "posterize": 6,
//!     "line_color": "#101820",
//!     "sigma_d": {"1001": 2, "1050": 6},
//!     "abstraction": {"1001": "flow", "1020": "full", "between": "step"}
//!   }
//! }
//! ```
//!
//! Name, description and tags are for people and may be left out, like all but the style.
//! `style` is the id of a node, the path of a graph file relative to the preset, or a graph written out; `node.id` then
//! names the parameter of one node, and `id` that of the only node that has it. `"lengths": "pixels"` makes lengths pixels of
//! the picture instead of those of one 1080 lines high. Keyframes are values by frame: before the first and after the last
//! their values hold, between two of them numbers and colours change evenly (`linear`) or not at all (`step`), the rest
//! never does. Whole numbers are rounded.
//!
//! `objects` are rules for things in the picture, such as `[{"match": "cryptomatte:hero/*", "detail": 2, "lines": false}]`:
//! factors from 1/4 to 4 on `detail`, `line_width`, `line_amount` and `medium`, no `lines`, or a `line_color`. Where several match,
//! the last one counts. Rules by number (`id:3`) and by whole names (`cryptomatte:hero`) are the graph's that is opened, and so is the
//! `look` that things have: they count where a host gives numbers of objects or a Cryptomatte. A host that knows all names, or what
//! things cover of pixels, makes maps of all rules, and opens the preset without.
//!
//! This is the only reader of the format. It reads no files: whoever has them hands in their texts.

mod fault;
mod feed;
mod file;
mod keyframes;
mod lengths;
mod looks;
mod names;
mod objects;
mod style;
mod title;

pub use fault::Fault;
pub use feed::fed;
pub use file::{Preset, Track, is_graph, is_written_out};
pub use lengths::Lengths;
pub use looks::{LOOKS, Look, PREFIX, id_of_look, look};
pub use objects::ObjectRule;
pub use style::{Settings, check, open, open_json};
pub use title::{Title, is_line};
