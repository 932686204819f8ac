//! Panics and failures on demand, so that tests can see what becomes of one. Not in the library that is
//! shipped.

use super::effects::Effect;
use isophote::Error;
use isophote::engine::Error as EngineError;
use isophote::engine::gpu::Device;
use std::ffi::CStr;

/// `<effect's identifier>:<action>` in this variable is where to panic.
#[cfg(debug_assertions)]
const VARIABLE: &str = "ISOPHOTE_OFX_PANIC";

pub fn at(effect: &Effect, action: &CStr) {
    #[cfg(debug_assertions)]
    if let Ok(wanted) = std::env::var(VARIABLE) {
        let here = format!("{}:{}", effect.identifier.to_string_lossy(), action.to_string_lossy());
        assert!(wanted != here, "asked for by {VARIABLE}");
    }
    #[cfg(not(debug_assertions))]
    let _ = (effect, action);
}

/// Error that a render of the effect whose identifier is in `ISOPHOTE_OFX_FAILURE` fails with.
pub fn failure(effect: &Effect) -> Option<Error> {
    #[cfg(debug_assertions)]
    if std::env::var("ISOPHOTE_OFX_FAILURE").is_ok_and(|id| id.as_bytes() == effect.identifier.to_bytes()) {
        return Some(isophote::engine::Error::Memory("asked for".to_owned()).into());
    }
    let _ = effect;
    None
}

/// Fault of the graphics device that `ISOPHOTE_OFX_DEVICE` asks for: `lost` loses it, `full` says that its memory is full.
pub fn of_device(device: &Device) -> Option<EngineError> {
    #[cfg(debug_assertions)]
    match std::env::var("ISOPHOTE_OFX_DEVICE").as_deref() {
        Ok("lost") => device.raw().destroy(),
        Ok("full") => return Some(EngineError::Memory("asked for".to_owned())),
        _ => {}
    }
    let _ = device;
    None
}

/// Tells of images that frames have in common and that were computed: a line with their number in the file that
/// `ISOPHOTE_OFX_COMPUTED` names.
pub fn computed(count: usize) {
    #[cfg(debug_assertions)]
    if let Ok(path) = std::env::var("ISOPHOTE_OFX_COMPUTED")
        && let Ok(mut file) = std::fs::OpenOptions::new().append(true).create(true).open(path)
    {
        // A test misses the line if it cannot be written.
        let _ = std::io::Write::write_all(&mut file, format!("{count}\n").as_bytes());
    }
    let _ = count;
}
