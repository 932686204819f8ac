//! Memory of the stages that frames read of those before and after them.

use crate::stylize::style::Style;
use isophote_loader::Library;
use isophote_loader::abi::IsophoteRequest;
use isophote_loader::history::{is_stage, split};
use isophote_loader::plan::{Role, Texture};

/// Bytes of the stages that a frame reads of those before and after it, which are at most so many, and of its own.
pub fn stages(
    library: &Library,
    style: &Style,
    request: &IsophoteRequest,
    frames: [u32; 2],
) -> isophote_loader::Result<u64> {
    let [past, future] = frames;
    if past + future == 0 {
        return Ok(0);
    }
    let plan = library.plan_frame(&style.graph, request, past)?;
    let textures = plan.textures()?;
    let kept = textures.iter().filter(|t| t.role == Role::Output && is_stage(t.name));
    // Of farther frames only inputs are read.
    let read = textures.iter().filter_map(|t| split(t.name)).filter(|(name, _)| is_stage(name));
    let past = read.map(|(_, before)| before as u64).max().unwrap_or(0);
    Ok(kept.map(Texture::bytes).sum::<u64>() * (past + u64::from(future) + 1))
}
