//! Graphics devices of the library's own, for hosts that have none.

use super::args;
use super::guard;
use super::handles::Object;
use super::objects::{self, DeviceObject};
use isophote::engine::gpu::{Device, Options};
use isophote_abi::*;
use std::ffi::c_char;

pub(super) unsafe extern "C" fn create(
    adapter: *const c_char,
    error: *mut IsophoteText,
    device: *mut IsophoteDevice,
) -> IsophoteStatus {
    let open = || {
        let adapter = if adapter.is_null() {
            None
        } else {
            // SAFETY: the host promised text with a closing zero.
            Some(unsafe { args::text(adapter, "the adapter's name")? }.to_owned())
        };
        let device = Device::open(&Options { adapter, ..Options::default() })?;
        Ok(DeviceObject::new(device))
    };
    // SAFETY: the host promised that both places may be written.
    unsafe { guard::create(device, error, open) }
}

pub(super) unsafe extern "C" fn destroy(device: IsophoteDevice) -> IsophoteStatus {
    guard::call(
        || {
            let device = DeviceObject::slots().remove(device.id)?;
            objects::forget_device(&device);
            Ok(())
        },
        |_| {},
    )
}

pub(super) unsafe extern "C" fn error(device: IsophoteDevice, text: *mut IsophoteText) -> IsophoteStatus {
    // SAFETY: the host promised that the text may be written.
    unsafe { guard::last_message::<DeviceObject>(device, text) }
}

pub(super) unsafe extern "C" fn name(
    device: IsophoteDevice,
    name: *mut IsophoteText,
    software: *mut u32,
) -> IsophoteStatus {
    guard::on::<DeviceObject>(device, |object| {
        // SAFETY: the host promised that both places may be written, or are null.
        unsafe {
            args::put_if_wanted(software, u32::from(object.device.is_software()));
            if name.is_null() { Ok(()) } else { args::fill(name, object.device.name()) }
        }
    })
}
