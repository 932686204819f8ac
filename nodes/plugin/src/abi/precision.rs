//! The extension for precision: 16-bit floats and samplers, for graphics devices.

use super::failure::Failure;
use super::guard;
use super::objects::GraphObject;
use isophote::engine::program::Precision;
use isophote_abi::*;
use std::ffi::CStr;

/// Name of the extension.
pub const EXTENSION: &CStr = c"isophote.precision/1";

/// The functions of the extension.
pub static API: IsophotePrecisionApi =
    IsophotePrecisionApi { struct_size: size_of::<IsophotePrecisionApi>() as u32, graph_set_precision: set };

unsafe extern "C" fn set(graph: IsophoteGraph, precision: IsophotePrecision) -> IsophoteStatus {
    guard::on::<GraphObject>(graph, |object| {
        let precision = match precision {
            ISOPHOTE_PRECISION_EXACT => Precision::Exact,
            ISOPHOTE_PRECISION_HALF => Precision::Half,
            ISOPHOTE_PRECISION_FAST => Precision::Fast,
            other => return Err(Failure::argument(format!("{other} is no precision"))),
        };
        object.lock().set_precision(precision);
        Ok(())
    })
}
