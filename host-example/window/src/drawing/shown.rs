//! Choice of the texture of the device that is seen where something is to be shown.

use super::canvas::Numbers;
use super::pictures::numbers;
use super::source::LookInput;
use crate::state::session::Which;
use crate::state::viewport::Overlay;
use isophote_loader::abi::IsophoteSpace;
use isophote_loader::catalogue::Kind;

/// Picture in a look: its texture, its kind, and what its colours are.
pub type Output = (wgpu::TextureView, Kind, IsophoteSpace);

/// One of the pictures that can be shown; the original where there is nothing else yet. `outputs` are those of the look, of
/// what it is compared with, and of what is shown instead, where there are any of this original.
pub fn picture<'s>(
    source: &'s LookInput,
    outputs: &'s [Option<Output>; 3],
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
    let [look, compared, instead] = outputs;
    let output = match which {
        Which::Original => None,
        Which::Look => look.as_ref(),
        Which::Compared => compared.as_ref(),
        Which::Overlay => instead.as_ref(),
    };
    match output {
        Some((view, Kind::Scalar, _)) => (view, Numbers::Grey),
        Some((view, _, space)) => (view, numbers(*space)),
        None => source.original(),
    }
}
