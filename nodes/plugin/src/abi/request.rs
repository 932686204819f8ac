//! Request of a host: the picture, its spaces, and the region of it.

use super::args;
use super::failure::{Failure, Outcome};
use super::guard;
use isophote::engine::Rect;
use isophote::graph::GraphInput;
use isophote::request::Guides;
use isophote::{ColourSpace, Request};
use isophote_abi::*;

/// The library's request from the host's.
///
/// # Errors
/// Invalid argument for numbers that are not listed.
pub fn request(host: &IsophoteRequest) -> Outcome<Request> {
    let space = match host.space {
        ISOPHOTE_SPACE_SRGB => ColourSpace::Srgb,
        ISOPHOTE_SPACE_LINEAR => ColourSpace::Linear,
        ISOPHOTE_SPACE_ACESCG => ColourSpace::AcesCg,
        other => return Err(Failure::argument(format!("{other} is no colour space"))),
    };
    let (premultiplied, emission) = match host.alpha {
        ISOPHOTE_ALPHA_PREMULTIPLIED => (true, false),
        ISOPHOTE_ALPHA_EMISSIVE => (true, true),
        ISOPHOTE_ALPHA_STRAIGHT => (false, false),
        other => return Err(Failure::argument(format!("{other} is no relation of colour to alpha"))),
    };
    let known = GraphInput::ALL.iter().fold(0, |all, input| all | input.bit());
    if host.guides & !known != 0 {
        return Err(Failure::argument(format!("{:#x} are no guides", host.guides)));
    }
    let guides = Guides::of(|input| host.guides & input.bit() != 0);
    Ok(Request {
        space,
        premultiplied,
        emission,
        guides,
        scale: host.scale,
        origin: [host.origin_x, host.origin_y],
        frame: host.frame,
        reference_height: host.reference_height,
        canonical_height: host.canonical_height,
        ..Request::new(host.width, host.height)
    })
}

/// The host's region, or the whole picture.
///
/// # Errors
/// Geometry when it is empty or not inside the picture.
///
/// # Safety
/// `region` is null or points to a rectangle.
pub unsafe fn region(region: *const IsophoteRect, request: &Request) -> Outcome<Rect> {
    isophote::engine::image::check_size(request.width, request.height)?;
    let whole = Rect::of_size(request.width, request.height);
    if region.is_null() {
        return Ok(whole);
    }
    // SAFETY: as the caller promised.
    let host = unsafe { args::get(region, "the region")? };
    // Compared before anything is subtracted, so that no width overflows.
    let is_inside = 0 <= host.x0 && host.x0 < host.x1 && host.x1 <= whole.x1;
    if !(is_inside && 0 <= host.y0 && host.y0 < host.y1 && host.y1 <= whole.y1) {
        return Err(Failure::geometry(format!(
            "the region x {}..{}, y {}..{} is not inside the picture of {}x{}",
            host.x0, host.x1, host.y0, host.y1, whole.x1, whole.y1
        )));
    }
    Ok(Rect { x0: host.x0, y0: host.y0, x1: host.x1, y1: host.y1 })
}

pub(super) unsafe extern "C" fn init(
    width: u32,
    height: u32,
    request: *mut IsophoteRequest,
) -> IsophoteStatus {
    let value = IsophoteRequest {
        width,
        height,
        scale: 1.0,
        space: ISOPHOTE_SPACE_SRGB,
        alpha: ISOPHOTE_ALPHA_PREMULTIPLIED,
        ..Default::default()
    };
    // SAFETY: the host promised that the place may be written.
    guard::call(|| unsafe { args::put(request, value, "the place for the request") }, |_| {})
}
