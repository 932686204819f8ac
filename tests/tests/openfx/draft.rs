//! Drafts: half of the size for looking at while values change.

use super::reference::*;
use super::scale::{SIDE, photo};
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::{Described, Instance, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;

/// Least agreement of a draft with the frame, in decibels; of marks as crisp as pixels.
const LEAST: f64 = 25.0;
const LEAST_OF_MARKS: f64 = 13.0;

fn render(instance: &Instance<'_>, window: [i32; 4], draft: bool) -> Picture {
    let wanted = Wanted { draft, ..Wanted::new(window) };
    let (status, picture) = instance.try_render(Layout::default(), [SIDE; 2], &wanted);
    assert_eq!(status, kOfxStatOK);
    picture
}

pub fn drafts_look_like_the_frame_and_their_tiles_are_parts_of_them(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextFilter);
    plain(&instance);
    let source = Picture::packed_in(layout, SIDE, SIDE, &packed(&photo(), &layout));
    instance.connect("Source", source.clone());
    let all = [0, 0, SIDE, SIDE];
    let (full, draft) = (render(&instance, all, false), render(&instance, all, true));
    let id = effect.plugin(binary).identifier();
    let [full, half] = [&full, &draft].map(|picture| values(&picture.packed(), &layout));
    let square: f64 = full.iter().zip(&half).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    let psnr = -10.0 * (square / full.len() as f64).log10();
    println!("{id}: {psnr:.1} dB");
    // There is no edge in it that is as hard as some effects want one.
    let is_plain = full.iter().all(|value| *value == full[0]);
    assert!(is_plain || full != half, "{id} is no draft");
    let has_marks = ["halftone", "ink", "tensor_view"].contains(&effect.node.id);
    assert!(psnr >= if has_marks { LEAST_OF_MARKS } else { LEAST }, "{id}: {psnr:.1} dB");
    // From what the regions of interest ask for alone.
    let tile = [60, 30, 126, 97];
    if let Some(regions) = instance.regions(tile.map(f64::from), 1.0) {
        let region = regions.numbers(c"OfxImageClipPropRoI_Source");
        let bounds = [0, 1, 2, 3].map(|i| region[i] as i32);
        let bounds = [0, 1, 2, 3].map(|i| if i < 2 { bounds[i].max(0) } else { bounds[i].min(SIDE) });
        instance.connect("Source", source.crop(bounds));
    }
    assert!(render(&instance, tile, true).crop(tile).packed() == draft.crop(tile).packed(), "{id}: a tile");
    host.no_faults();
}
