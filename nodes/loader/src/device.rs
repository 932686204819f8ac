//! Graphics devices of the library's own, for verbs that have none themselves.

use super::error::{Result, check};
use super::library::Library;
use super::text;
use isophote_abi::{IsophoteApi, IsophoteDevice, IsophoteStatus};

/// A graphics device of the library's own. Graphs on several threads may share it.
#[derive(Debug)]
pub struct Device {
    api: &'static IsophoteApi,
    pub(super) handle: IsophoteDevice,
}

impl Library {
    /// Opens a device: `gpu` for hardware only, `software` for a driver on the CPU, or a part of an adapter's
    /// name; the best there is without.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when there is none.
    pub fn device(&self, adapter: Option<&str>) -> Result<Device> {
        let adapter = adapter.map(text::argument).transpose()?;
        let mut handle = Default::default();
        let (status, message) = text::message(|error| {
            let adapter = adapter.as_ref().map_or(std::ptr::null(), |a| a.as_ptr());
            // SAFETY: the name is null or ends with a zero; the other two may be written during the call.
            unsafe { (self.api.device_create)(adapter, error, &raw mut handle) }
        });
        check(status, || message)?;
        Ok(Device { api: self.api, handle })
    }
}

impl Device {
    /// Name of the adapter.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the device is gone.
    pub fn name(&self) -> Result<String> {
        let null = std::ptr::null_mut();
        // SAFETY: the handle is this object's; the text is a buffer of the length that it says.
        let (status, name) = text::whole(|out| unsafe { (self.api.device_name)(self.handle, out, null) });
        self.check(status)?;
        Ok(name)
    }

    pub(super) fn check(&self, status: IsophoteStatus) -> Result<()> {
        check(status, || {
            // SAFETY: the handle is this object's; the text is a buffer of the length that it says.
            text::message(|out| unsafe { (self.api.device_error)(self.handle, out) }).1
        })
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // Nobody is left who could do anything about a failure.
        // SAFETY: the handle is this object's and not used again.
        let _ = unsafe { (self.api.device_destroy)(self.handle) };
    }
}
