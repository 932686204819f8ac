//! Values of before a look, for hosts whose steps to undo hold only a part of what effects set.

use isophote::Value;
use std::ffi::CStr;

/// Name and value of a control.
pub type Named = (&'static CStr, Value);

/// Values that the controls of an instance had before its look.
#[derive(Clone, Debug)]
pub struct Before {
    /// Option of the look that was chosen last.
    pub option: usize,
    /// Values of all controls that the look sets.
    pub values: Vec<Named>,
    /// True after an edit that made the look custom.
    pub edited: bool,
}
