//! Choice of the texture of the device that is seen where something is to be shown.

use super::canvas::Numbers;
use super::live_look::LiveLook;
use super::pictures::numbers;
use super::source::LookInput;
use crate::state::session::Which;
use crate::state::viewport::Overlay;
use isophote_loader::catalogue::Kind;

/// One of the pictures that can be shown; the original where there is nothing else yet.
pub fn picture<'s>(
    source: &'s LookInput,
    looks: &'s [LiveLook; 3],
    overlay: Overlay,
    which: Which,
) -> (&'s wgpu::TextureView, Numbers) {
    let guide = match overlay {
        Overlay::Normal => Some(Numbers::Normal),
        Overlay::Depth => Some(Numbers::Depth),
        Overlay::ObjectId => Some(Numbers::ObjectId),
        Overlay::Motion => Some(Numbers::Motion),
        _ => None,
    };
    let guide = guide.filter(|_| which == Which::Overlay);
    if let Some((numbers, view)) = guide.and_then(|numbers| Some((numbers, source.guide(numbers)?))) {
        return (view, numbers);
    }
    let live = match which {
        Which::Original => None,
        Which::Look => looks[0].output(),
        Which::Compared => looks[1].output(),
        Which::Overlay => looks[2].output(),
    };
    match live {
        Some((view, Kind::Scalar, _)) => (view, Numbers::Grey),
        Some((view, _, space)) => (view, numbers(space)),
        None => source.original(),
    }
}
