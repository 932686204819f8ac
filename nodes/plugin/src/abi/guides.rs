//! The extension for guides: the library's list of the pictures that may enter a graph.

use super::catalogue::{kind, lasting};
use super::{args, guard};
use isophote::graph::GraphInput;
use isophote_abi::*;
use std::ffi::CStr;
use std::sync::OnceLock;

/// Name of the extension.
pub const EXTENSION: &CStr = c"isophote.guides/1";

/// The functions of the extension.
pub static API: IsophoteGuidesApi =
    IsophoteGuidesApi { struct_size: size_of::<IsophoteGuidesApi>() as u32, guides };

/// The list, which is never written once made.
struct List(Vec<IsophoteGuide>);

// SAFETY: all that the list points to is leaked and constant.
unsafe impl Send for List {}
// SAFETY: as above.
unsafe impl Sync for List {}

fn all() -> &'static [IsophoteGuide] {
    static LIST: OnceLock<List> = OnceLock::new();
    let list = LIST.get_or_init(|| {
        let guide = |input: GraphInput| IsophoteGuide {
            id: lasting(input.id()),
            label: lasting(input.label()),
            doc: lasting(input.doc()),
            kind: kind(input.kind()),
            channels: input.kind().channels(),
            bit: input.bit(),
        };
        List(GraphInput::GUIDES.into_iter().map(guide).collect())
    });
    &list.0
}

unsafe extern "C" fn guides(guides: *mut *const IsophoteGuide, count: *mut u32) -> IsophoteStatus {
    let body = || {
        let all = all();
        // SAFETY: the host promised that both places may be written.
        unsafe {
            args::put(guides, all.as_ptr(), "the place for the guides")?;
            args::put(count, all.len() as u32, "the place for their number")
        }
    };
    guard::call(body, |_| {})
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_guide_has_a_bit_of_its_own() {
        let bits = all().iter().map(|guide| guide.bit);
        assert!(bits.clone().all(|bit| bit.count_ones() == 1));
        assert_eq!(bits.fold(0, |all, bit| all | bit).count_ones() as usize, all().len());
    }
}
